"""Square cells of the ground: points at which voxels are evaluated, and regions of cells.

A cell is many columns wide, and the beams of a LiDAR meet the ground in rings: one voxel in the
middle of each cell would show moire patterns. So each cell has a power of two of points, a run of
the scrambled Sobol' sequence: spread evenly over the cell (and over height, if needed), differently
in each cell, and reproducibly.

Regions of a grid are grown, smoothed, and outlined by marching squares.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...base.errors import InputError
from ...base.values import Number
from ...geometry.bins import count_up
from ...geometry.grids import PerceptionSpace
from ..sampling import CENTERED, scrambled_sobol

Bounds = tuple[float, float]
Rectangle = tuple[Bounds, Bounds]
"""A rectangle of the ground: bounds along x and along y [m]."""
VOXELS_PER_M2 = 8
MIN_VOXELS = 4
MAX_VOXELS = 64
"""Voxels of a cell, if it is wider than a column."""
MAX_CELLS = 2**21
STEP = Number(0.0, above=True, cap=1e6, unit="m", noun="length")
WITHIN = Number(0.0, above=True, cap=1e6, unit="m", noun="length")
ROUNDING = 1e-6
"""Tolerance of divisions, in voxels: 0.3 / 0.1 is not a whole number."""
BOTTOM, RIGHT, TOP, LEFT = range(4)
SEGMENTS = {
    1: ((BOTTOM, LEFT),),
    2: ((RIGHT, BOTTOM),),
    3: ((RIGHT, LEFT),),
    4: ((TOP, RIGHT),),
    6: ((TOP, BOTTOM),),
    7: ((TOP, LEFT),),
    8: ((LEFT, TOP),),
    9: ((BOTTOM, TOP),),
    11: ((RIGHT, TOP),),
    12: ((LEFT, RIGHT),),
    13: ((BOTTOM, RIGHT),),
    14: ((LEFT, BOTTOM),),
}
"""Sides that the outline enters and leaves a square by, inside on its left, by which of the corners
are inside: 1 lower left, 2 lower right, 4 upper right, 8 upper left. Two opposite ones are apart
(`APART`), or joined where the middle of the square is inside (`JOINED`)."""
APART = {5: ((BOTTOM, LEFT), (TOP, RIGHT)), 10: ((RIGHT, BOTTOM), (LEFT, TOP))}
JOINED = {5: ((BOTTOM, RIGHT), (TOP, LEFT)), 10: ((LEFT, BOTTOM), (RIGHT, TOP))}
"""As seen with x to the right and y up."""
EDGE = 1e-9
"""Difference below the level outside of a field: outlines follow its border there."""


@dataclass(frozen=True, slots=True)
class GroundCells:
    """Squares side by side: their lower ends `x0` (NX,) and `y0` (NY,), and the `step` [m]. The
    last ones end where the space does, at `x1` and `y1`."""

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    step: float

    @classmethod
    def of(
        cls, space: PerceptionSpace, step: float, part: Rectangle | None = None
    ) -> "GroundCells":
        """Cut the ground of a space, or all columns that a part of it touches, into cells.

         `InputError` when the step is not positive, the cells are too many, or the part is beside
        the space.
        """
        step = STEP.checked("sight", "step", step)
        bounds = [_touched_columns(space, axis, part) for axis in (0, 1)]
        counts = [math.ceil((high - low) / step - ROUNDING) for low, high in bounds]
        if math.prod(counts) > MAX_CELLS:
            found = f"{step:g} m: {math.prod(counts):,}"
            raise InputError("sight", "step", f"a step with at most {MAX_CELLS:,} cells", found)
        low = [at + np.arange(n) * step for (at, _), n in zip(bounds, counts, strict=True)]
        high = [np.minimum(w + step, end) for w, (_, end) in zip(low, bounds, strict=True)]
        return cls(low[0], low[1], high[0], high[1], step=step)

    @property
    def key(self) -> tuple[float, ...]:
        """A key that identifies the cells among those of the same space."""
        return self.step, self.x0[0], self.x1[-1], self.y0[0], self.y1[-1]

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y."""
        return len(self.x0), len(self.y0)

    @property
    def x(self) -> Floats:
        """Middles along x (NX,) [m]."""
        return self.x0 + self.step / 2.0

    @property
    def y(self) -> Floats:
        """Middles along y (NY,) [m]."""
        return self.y0 + self.step / 2.0

    def points(self, interval: float, *, over_height: bool) -> tuple[Floats, Floats, Floats]:
        """Points of every cell: x, y [m] and a share of the height, each (cells, K). Cells on the
        right of the vehicle have the mirrored points of the cells on its left."""
        count = self._voxels(interval, over_height)
        _, row = np.unique(np.round(np.abs(self.y0 + self.y1), 6), return_inverse=True)
        number = np.add.outer(np.arange(len(self.x0)) * (row.max() + 1), row)
        u = scrambled_sobol((int(number.max()) + 1) * count, CENTERED).reshape(-1, count, 3)
        u = u[number]  # (NX, NY, K, 3)
        if count == 1:
            u[..., :2] = 0.5
        right = (self.y0 + self.y1 < 0.0)[:, None]
        across = np.where(right, 1.0 - u[..., 1], u[..., 1])
        x = self.x0[:, None, None] + u[..., 0] * (self.x1 - self.x0)[:, None, None]
        y = self.y0[:, None] + across * (self.y1 - self.y0)[:, None]
        return x.reshape(-1, count), y.reshape(-1, count), u[..., 2].reshape(-1, count)

    def _voxels(self, interval: float, over_height: bool) -> int:
        """Return how many voxels a cell has: a power of two."""
        if self.step < 1.5 * interval and not over_height:
            return 1
        wanted = math.log2(VOXELS_PER_M2 * self.step**2)
        return int(np.clip(2 ** round(np.clip(wanted, 0.0, 16.0)), MIN_VOXELS, MAX_VOXELS))


def widened(rectangle: Rectangle, within: float) -> Rectangle:
    """Widen a rectangle by a distance to each side; `InputError` for one that is not positive."""
    within = WITHIN.checked("sight", "within", within)
    (x0, x1), (y0, y1) = rectangle
    return (x0 - within, x1 + within), (y0 - within, y1 + within)


def _touched_columns(space: PerceptionSpace, axis: int, part: Rectangle | None) -> Bounds:
    """Bounds along an axis of the space's columns that a part of it touches."""
    low, high = (space.x, space.y)[axis]
    if part is None:
        return low, high
    first = max(0, math.floor((part[axis][0] - low) / space.interval + ROUNDING))
    last = min(space.shape[axis], math.ceil((part[axis][1] - low) / space.interval - ROUNDING))
    if first >= last:
        expected = f"a part of the space, {'xy'[axis]} = [{low:g}, {high:g}]"
        found = "[{:g}, {:g}]".format(*part[axis])
        raise InputError("sight", "within", expected, found)
    return low + first * space.interval, low + last * space.interval


def opened(flags: Flags, radius: float) -> Flags:
    """Union of the discs of that radius, in cells, that fit into a region (NX, NY). Beyond the
    edge, the region continues with the values at the edge."""
    reach = int(radius)
    steps = np.indices((2 * reach + 1, 2 * reach + 1)).reshape(2, -1).T - reach
    disc = steps[(steps**2).sum(axis=1) <= radius**2]  # (N, 2) to cells with their middle within it
    padded = np.pad(flags, 2 * reach, mode="edge")
    union = _moved(~_moved(~padded, disc), disc)
    inner = tuple(slice(2 * reach, n - 2 * reach) for n in union.shape)
    return union[inner]


def closed(flags: Flags, radius: float) -> Flags:
    """Fill gaps that are too narrow for a disc of that radius, in cells."""
    return ~opened(~flags, radius)


def dilated(flags: Flags, widths: list[int]) -> Flags:
    """Dilate a region (NX, NY) by a symmetric shape. The shape is given by rows: k rows from its
    middle it extends `widths[k]` cells to either side. Cells beyond the edge are not set."""
    near = np.zeros_like(flags)
    by_width = {width: _along(flags, width) for width in set(widths)}
    for k, width in enumerate(widths[: len(flags)]):
        wide = by_width[width]
        near[k:] |= wide[: len(wide) - k]
        near[: len(wide) - k] |= wide[k:]
    return near


def _along(flags: Flags, reach: int) -> Flags:
    """Dilate by `reach` cells within each row; each step doubles the distance."""
    near = flags
    done = 0
    reach = min(reach, flags.shape[1] - 1)
    while done < reach:
        k = min(max(done, 1), reach - done)
        wider = near.copy()
        wider[:, k:] |= near[:, :-k]
        wider[:, :-k] |= near[:, k:]
        near = wider
        done = done + k
    return near


def squares_within(radius: float) -> list[int]:
    """Shape for `dilated`: squares with all points within a radius of all points of one square. The
    radius is in squares. The shape is empty if it is less than the diagonal of a square."""
    rows = int(math.sqrt(max(radius**2 - 1.0, 0.0)))
    return [int(math.sqrt(radius**2 - (k + 1) ** 2)) - 1 for k in range(rows)]


def squares_touching(radius: float) -> list[int]:
    """Shape for `dilated`: squares with a point within a radius of a point of one square."""
    away = [max(k - 1, 0) for k in range(int(radius) + 2)]
    return [int(math.sqrt(radius**2 - k**2)) + 1 for k in away]


def without_specks(flags: Flags, min_cells: float) -> Flags:
    """Drop connected pieces (by sides) of fewer cells than `min_cells`."""
    width = flags.shape[1] + 1  # one more cell, so that no run continues in the next row
    edges = np.diff(np.pad(flags, ((0, 0), (1, 1))).astype(np.int8), axis=1).reshape(-1)
    starts = np.flatnonzero(edges == 1)
    ends = np.flatnonzero(edges == -1)
    # pairs (a, b) of runs of cells in neighbouring rows that share a side
    first = np.searchsorted(ends, starts + width, side="right")
    n = np.maximum(np.searchsorted(starts, ends + width, side="left") - first, 0)
    a = np.repeat(np.arange(len(starts)), n)
    b = first[a] + count_up(n)
    piece = np.arange(len(starts))  # the smallest number in each run's component
    while (differ := piece[a] != piece[b]).any():
        one = piece[a[differ]]
        other = piece[b[differ]]
        np.minimum.at(piece, np.maximum(one, other), np.minimum(one, other))
        while ((further := piece[piece]) != piece).any():
            piece = further
    small = np.bincount(piece, ends - starts, len(starts))[piece] < min_cells
    edges[starts[small]] = edges[ends[small]] = 0
    return np.cumsum(edges.reshape(-1, width), axis=1, dtype=np.int8)[:, :-1] > 0


def gauss(values: Floats, sigma: float) -> Floats:
    """Sum values (NX, NY) with Gaussian weights; `sigma` in cells, cut off at 2 sigma."""
    steps = np.arange(-int(2.0 * sigma), int(2.0 * sigma) + 1)
    curve = [math.exp(-((k / sigma) ** 2) / 2.0) for k in steps.tolist()]
    for _ in range(2):
        padded = np.pad(values, ((len(steps) // 2,) * 2, (0, 0)))
        total = np.zeros_like(values)
        for k, w in enumerate(curve):
            total += w * padded[k : k + len(values)]
        values = np.ascontiguousarray(total.T)
    return values


def _moved(flags: Flags, steps: Ints) -> Flags:
    """Set every cell that one of the steps leads to from a set cell."""
    moved = np.zeros_like(flags)
    nx, ny = flags.shape
    for i, j in steps.tolist():
        to = slice(max(i, 0), nx + min(i, 0)), slice(max(j, 0), ny + min(j, 0))
        of = slice(max(-i, 0), nx + min(-i, 0)), slice(max(-j, 0), ny + min(-j, 0))
        moved[to] |= flags[of]
    return moved


def outlines(values: Floats, level: float, x: Floats, y: Floats) -> tuple[Floats, ...]:
    """Return closed outlines (N, 2) of the region where a field is above a level, longest first.
    The field (NX, NY) is that at the middles of evenly spaced cells (x, y); outside of them it is
    below the level. The region is on the left of each outline; the last point repeats the first."""
    field = np.pad(values - level, 1, constant_values=-EDGE)
    xs = _widened(x)
    ys = _widened(y)
    rings = [_points_on(ring, field, xs, ys) for ring in chained(*_segments(field))]
    return tuple(sorted(rings, key=len, reverse=True))


def _widened(w: Floats) -> Floats:
    """Middles of cells, and the ends of the first and the last."""
    edge = (w[1] - w[0]) / 2.0 if len(w) > 1 else 0.5
    return np.concatenate([[w[0] - edge], w, [w[-1] + edge]])


def _segments(field: Floats) -> tuple[Ints, Ints]:
    """Numbers of the edges where each piece of an outline begins and ends."""
    inside = field > 0.0
    case = inside[:-1, :-1] + 2 * inside[1:, :-1] + 4 * inside[1:, 1:] + 8 * inside[:-1, 1:]
    middle = field[:-1, :-1] + field[1:, :-1] + field[1:, 1:] + field[:-1, 1:] > 0.0
    starts = []
    ends = []
    for number, sides, where in (
        *((n, s, None) for n, s in SEGMENTS.items()),
        *((n, s, ~middle) for n, s in APART.items()),
        *((n, s, middle) for n, s in JOINED.items()),
    ):
        i, j = np.nonzero((case == number) if where is None else (case == number) & where)
        for enter, leave in sides:
            starts.append(_edge(i, j, enter, field.shape))
            ends.append(_edge(i, j, leave, field.shape))
    return np.concatenate(starts), np.concatenate(ends)


def _edge(i: Ints, j: Ints, side: int, shape: tuple[int, ...]) -> Ints:
    """Number of a side of squares (i, j): even along x, odd along y, by its lower end."""
    i = i + (side == RIGHT)
    j = j + (side == TOP)
    return 2 * (i * shape[1] + j) + (side in (LEFT, RIGHT))


def chained(starts: Ints, ends: Ints) -> list[list[int]]:
    """Chain pieces to rings of edges; every edge is entered once and left once."""
    following = dict(zip(starts.tolist(), ends.tolist(), strict=True))
    rings = []
    while following:
        first = at = next(iter(following))
        ring = [first]
        while (at := following.pop(at)) != first:
            ring.append(at)
        rings.append([*ring, first])
    return rings


def _points_on(edges: list[int], field: Floats, xs: Floats, ys: Floats) -> Floats:
    """Return the points (N, 2) where a field crosses the level along numbered edges of the grid."""
    number, along_y = np.divmod(np.asarray(edges), 2)
    i, j = np.divmod(number, field.shape[1])
    i1 = i + (1 - along_y)
    j1 = j + along_y
    a = field[i, j]
    b = field[i1, j1]
    t = a / (a - b)
    x = xs[i] + t * (xs[i1] - xs[i])
    y = ys[j] + t * (ys[j1] - ys[j])
    return np.stack([x, y], axis=1)

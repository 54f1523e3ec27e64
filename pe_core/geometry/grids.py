"""Grids: the voxels of the perception space, squares of the ground, and height maps."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from ..base.errors import InputError
from ..base.setting import Pair, Panel, check_settings, setting
from ..base.values import Number
from .bins import count_up

PAPER_INTERVAL_M = 0.1
MAX_VOXELS = 2**31
"""Maximum number of voxels, 32 times the paper's; more are probably a mistake."""
DIVIDES_TOLERANCE = 1e-6
"""Maximum difference of an extent from a whole number of voxels (0.1 is not exact in binary)."""
MAX_COLUMNS = 2**25
"""Maximum number of columns, 26 times the paper's: each class of the prior stores one in each."""
EDGE_M = 1e6  # Maximum magnitude of a bound of the space
INTERVAL = Number(1e-3, EDGE_M, unit="m", noun="length")
BOUND = Number(cap=EDGE_M, unit="m")


def _bounds(axis: str, default: tuple[float, float]) -> tuple[float, float]:
    text = "From and to: the box whose voxels are scored"
    panel = Panel(f"space_{axis}", axis.upper(), precision=2)
    return setting(default, Pair(BOUND), text, panel, scored=True)


@dataclass(frozen=True, slots=True)
class PerceptionSpace:
    """A box in the ground frame, divided into cubic voxels with side `interval`.

    `InputError` when a bound is not finite, an extent is not positive or not a multiple of the
    interval, or there are too many voxels.

    Parameters
    ----------
    x, y, z : (low, high) float
        Bounds [m]; by default those of the paper.
    interval : float
        Side of a voxel [m]; every extent has to be a multiple of it.
    """

    x: tuple[float, float] = _bounds("x", (-80.0, 80.0))
    y: tuple[float, float] = _bounds("y", (-40.0, 40.0))
    z: tuple[float, float] = _bounds("z", (0.0, 5.0))
    interval: float = setting(
        PAPER_INTERVAL_M,
        INTERVAL,
        "Side of a voxel; it has to divide the space",
        Panel("space_interval", "Voxel", soft_max=1.0),
        scored=True,
    )

    def __post_init__(self) -> None:
        check_settings(self, "space", names=("interval", "x", "y", "z"))
        for name in "xyz":
            bounds = getattr(self, name)
            voxels = (bounds[1] - bounds[0]) / self.interval
            whole = round(voxels)
            if whole < 1 or abs(voxels - whole) > DIVIDES_TOLERANCE * max(1.0, voxels):
                expected = f"a length that divides {name} = {list(bounds)}"
                raise InputError("space", "interval", expected, self.interval)
        if self.size > MAX_VOXELS:
            raise InputError("space", "interval", f"at most {MAX_VOXELS} voxels", self.size)
        if (columns := self.shape[0] * self.shape[1]) > MAX_COLUMNS:
            raise InputError("space", "interval", f"at most {MAX_COLUMNS} columns", columns)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of voxels along x, y, z."""
        nx, ny, nz = (round((hi - lo) / self.interval) for lo, hi in (self.x, self.y, self.z))
        return nx, ny, nz

    @property
    def size(self) -> int:
        """Number of voxels."""
        return math.prod(self.shape)

    @property
    def origin(self) -> tuple[float, float, float]:
        """Corner with the lowest coordinates (3,) [m]."""
        return self.x[0], self.y[0], self.z[0]

    def centers(self, axis: int) -> NDArray[np.float64]:
        """Return the voxel centres (N,) along one axis (0, 1, 2 for x, y, z) [m]."""
        steps = np.arange(self.shape[axis], dtype=float)
        return self.origin[axis] + (steps + 0.5) * self.interval

    def center_of(self, index: NDArray[np.integer]) -> NDArray[np.float64]:
        """Return the centres (V, 3) [m] of voxels with indices (V, 3)."""
        return np.asarray(self.origin) + (np.asarray(index) + 0.5) * self.interval


@dataclass(frozen=True)
class GroundGrid:
    """Regular grid of squares on the ground, z = 0. `origin` (2,) is the corner with the lowest
    coordinates, ground frame [m], `shape` the number of squares along x and y, `step` the side of a
    square [m]."""

    origin: tuple[float, float]
    shape: tuple[int, int]
    step: float

    @cached_property
    def x(self) -> Floats:
        """Centres of the squares along x (NX,) [m]."""
        return self.origin[0] + (np.arange(self.shape[0]) + 0.5) * self.step

    @cached_property
    def y(self) -> Floats:
        """Centres of the squares along y (NY,) [m]."""
        return self.origin[1] + (np.arange(self.shape[1]) + 0.5) * self.step

    @property
    def end(self) -> tuple[float, float]:
        """Corner of the grid with the highest coordinates (2,) [m]."""
        x, y = (w + n * self.step for w, n in zip(self.origin, self.shape, strict=True))
        return x, y

    def middles(self, squares: Ints) -> Floats:
        """Return the centres (N, 2) [m] of squares (N,), which are numbered with y fastest."""
        i, j = np.divmod(squares, self.shape[1])
        return np.stack([self.x[i], self.y[j]], axis=1)

    def widened(self, squares: int) -> "GroundGrid":
        """Return the grid with `squares` more squares on each side."""
        x, y = (w - squares * self.step for w in self.origin)
        nx, ny = (n + 2 * squares for n in self.shape)
        return GroundGrid((x, y), (nx, ny), self.step)


def top_heights(triangles: Floats, space: PerceptionSpace) -> Floats:
    """Return the maximum z of triangles (F, 3, 3) at columns' centres (nx, ny) [m]; -inf: none."""
    nx, ny, _ = space.shape
    heights = np.full(nx * ny, -np.inf)
    face, column = _candidates(triangles, space)
    x = space.centers(0)[column // ny]
    y = space.centers(1)[column % ny]
    corners = triangles[face]
    dx = corners[..., 0] - x[:, None]
    dy = corners[..., 1] - y[:, None]
    areas = np.stack(
        [dx[:, i] * dy[:, j] - dx[:, j] * dy[:, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1
    )
    total = areas.sum(axis=1)
    inside = ((areas >= 0).all(axis=1) | (areas <= 0).all(axis=1)) & (total != 0)
    z = (areas * corners[..., 2]).sum(axis=1) / np.where(total == 0, 1.0, total)
    np.maximum.at(heights, column[inside], z[inside])
    return heights.reshape(nx, ny)


def in_chunks(triangles: Floats, space: PerceptionSpace, columns: int) -> list[Floats]:
    """Return triangles (F, 3, 3) in parts, of which each but for its last triangle has at most so
    many columns in bounding rectangles: `top_heights` of a part takes little memory."""
    _, (wide, high) = _rectangles(triangles, space)
    before = np.cumsum(wide * high) // columns
    return np.split(triangles, np.flatnonzero(np.diff(before)) + 1)


def _candidates(triangles: Floats, space: PerceptionSpace) -> tuple[NDArray, NDArray]:
    """(triangle, column) pairs whose column centre lies in the triangle's bounding rectangle."""
    first, (wide, high) = _rectangles(triangles, space)
    n = wide * high
    step = count_up(n)
    rows = np.repeat(np.maximum(high, 1), n)
    i = np.repeat(first[0], n) + step // rows
    j = np.repeat(first[1], n) + step % rows
    return np.repeat(np.arange(len(triangles)), n), i * space.shape[1] + j


def _rectangles(triangles: Floats, space: PerceptionSpace) -> tuple[list[NDArray], list[NDArray]]:
    """Return the first column of each triangle's bounding rectangle, and its number of columns,
    (F,) along x and y each."""
    first = []
    count = []
    for axis in (0, 1):
        w = (triangles[:, :, axis] - space.origin[axis]) / space.interval - 0.5
        limit = space.shape[axis] - 1
        low = np.clip(np.ceil(w.min(axis=1)), 0, limit + 1).astype(int)
        high = np.clip(np.floor(w.max(axis=1)), -1, limit).astype(int)
        first.append(low)
        count.append(np.maximum(high - low + 1, 0))
    return first, count

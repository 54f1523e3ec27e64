"""Blind ground: squares of the ground that no sensor sees, their outlines, and distances.

A square is blind if a test body can stand on it and be visible to no sensor.

The body is an upright cylinder of diameter `BODY_M` and a given height; at height 0 it is a disc
that lies flat. It is invisible if no beam of a LiDAR passes through it before the vehicle occludes
the beam, and no line of sight of a camera ends on it. So a gap between beams that is narrower than
the body is not blind. No voxels are involved, so blind ground varies evenly with its height.

Kinds of sensors mark squares in which something is certainly visible (`sensors.GroundKernel`).
From these, all invisible bodies are found, and some that are just visible: no blind square is
missing except pieces of less than 0.25 m2 and strips along the vehicle narrower than a square's
diagonal. A blind square is at most `TOO_FAR_M` from a hole, as wide as the body, without marks.

Distances are from the body's rectangle. They are rounded to the worse side, so no figure looks
better than the truth.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ...base.arrays import Flags, Floats, Ints, ReadOnlyDict, mapped, read_only
from ...base.notebook import ShortRepr
from ...base.values import rounded
from ...geometry.grids import GroundGrid, PerceptionSpace, top_heights
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import GroundView, VisibleGroundCache
from .ground_cells import (
    ROUNDING,
    GroundCells,
    Rectangle,
    dilated,
    opened,
    outlines,
    squares_touching,
    squares_within,
    without_specks,
)

WITHIN_M = 10.0
"""How far from the body blind ground is looked for, unless one says otherwise [m]."""
BLIND_TO_M = 0.5
"""Height of the object for which blind ground is computed [m]: a post at the kerb or a small child.
Flat ground would not do: far from the vehicle beams meet it only in rings."""
NARROW_M = 0.1
"""A narrower strip of blind ground along the body does not count, on a side: edges may be this much
too far out."""
NO_BODY_M = 1.0  # Half the side of the square that replaces the body without a vehicle
DECIMALS = 6  # Distances are rounded to the micrometre
SIDES = {"front": (0, 1), "rear": (0, -1), "left": (1, 1), "right": (1, -1)}
"""By side: the axis towards it, and the sign of the direction."""
BODY_M = 0.3
"""Diameter of the test body: that of the cylinders of FMVSS 111 and UN regulation 158, less than a
small child is wide."""
STANDING_M = 1.7
"""Height of an adult: somebody can stand below an open tailgate that is higher."""
STEP_M = 0.05
"""Side of the squares: with those of more than 0.1 m no body would be certainly visible."""
TOO_FAR_M = 3 * STEP_M
"""Edges of blind ground are at most so far outside of it, with squares of `STEP_M`."""
MIN_AREA_M2 = 0.18
"""Smaller pieces of unmarked squares are dropped: every blind piece of 0.25 m2 has more of them."""
PARTLY_VISIBLE = math.sqrt(2.0)
"""A blind point in a marked square is no farther than this from an unmarked square, in squares: a
body at that point has an unmarked square under it."""
SECTOR_RADIUS_M = 20.0  # Distance from the origin at which blind sectors are measured
SECTOR_HEIGHTS_M = (0.5, 1.0, 1.5)
"""A post or a small child, an older child, an adult who bends."""
SECTOR_RING_M = MIN_AREA_M2 / STEP_M + 1.0
"""How far from that circle a sector depends on what is marked: a piece of squares that reaches
farther is large enough, and a body is narrower than the rest."""
ARC_STEP_M = 0.01  # Distance of the points of the circle at which squares are looked up
SQUARES_PER_VOXEL = 16
"""Memory in the cache: a voxel takes some 100 bytes, a square a few."""


@dataclass(frozen=True, slots=True)
class BlindSpot:
    """A location on blind ground: `point` (2,) and its distance from the vehicle's body [m]."""

    point: tuple[float, float]
    distance: float


@dataclass(frozen=True, slots=True, eq=False)
class BlindGround(ShortRepr):
    """Ground round the vehicle where an object is invisible to all sensors.

    Attributes
    ----------
    outlines : tuple of (N, 2) float
        Closed lines with the blind ground on their left; the last point repeats the first [m].
    area : float
        [m2]
    height : float
        Height of the object [m].
    within : float
        Distance from the body's rectangle up to which the ground was evaluated [m].
    nearest : dict of BlindSpot or None
        By side (front, rear, left, right): the nearest blind location in the strip beside the
        body, as wide as the body; None where there is none.
    zone : dict of float or None
        By side: length of the blind ground that begins at the body, up to the first row of the
        strip that is visible over the whole width [m]; 0 where that row is at the body, None where
        there is no such row.
    seen_from : dict of float or None
        By side: the distance from the body beyond which the strip has no blind location [m]; None
        where there is one at the edge of the evaluated ground.
    """

    outlines: tuple[Floats, ...]
    area: float
    height: float
    within: float
    nearest: Mapping[str, BlindSpot | None]
    zone: Mapping[str, float | None]
    seen_from: Mapping[str, float | None]


@dataclass(frozen=True, slots=True)
class BlindSector:
    """The widest sector in which a body is invisible, `SECTOR_RADIUS_M` from the origin.

    `height`: Height of the body [m].
    `width`: 0 where the body is visible all round, 360 where it is nowhere [deg]. It is never too
        small. It counts the ground under the body, and edges are up to `TOO_FAR_M` too far out: its
        ends are at most 0.3 m from where the middle of an invisible body can stand. An edge that
        runs away from the origin is less than 1 deg too far; one that crosses the circle at a
        slant s is 1 deg / sin(s) too far.
    `bearing`: Bearing of its middle, counter-clockwise from ahead, above -180 to 180 [deg].
    """

    height: float
    width: float
    bearing: float


@cache
def sector_cells() -> GroundCells:
    """Return the squares round the circle on which blind sectors are measured."""
    count = math.ceil(SECTOR_RADIUS_M / STEP_M) + math.ceil(1.0 / STEP_M)
    low = np.arange(-count, count) * STEP_M
    return GroundCells(low, low, low + STEP_M, low + STEP_M, step=STEP_M)


@cache
def _circle() -> tuple[Ints, Ints]:
    """Return the squares (N,), (N,) of `sector_cells` that points of the circle lie in."""
    cells = sector_cells()
    count = math.ceil(2.0 * math.pi * SECTOR_RADIUS_M / ARC_STEP_M)
    angles = 2.0 * math.pi * np.arange(count) / count
    i, j = (
        np.floor((SECTOR_RADIUS_M * mapped(turn, angles) - low[0]) / cells.step)
        for turn, low in ((math.cos, cells.x0), (math.sin, cells.y0))
    )
    return i.astype(np.int64), j.astype(np.int64)


def widest_sector(blind: Flags, height: float) -> BlindSector:
    """Return the widest sector of blind `sector_cells` (NX, NY) on the circle."""
    i, j = _circle()
    count = len(i)
    clear = np.flatnonzero(~blind[i, j])
    if not len(clear):
        return BlindSector(height, 360.0, 0.0)
    steps = np.diff(clear, append=clear[0] + count)
    k = int(np.argmax(steps))
    if steps[k] == 1:
        return BlindSector(height, 0.0, 0.0)
    middle = 360.0 * (clear[k] + steps[k] / 2.0) / count
    bearing = 180.0 - (180.0 - middle) % 360.0
    return BlindSector(height, rounded(360.0 * float(steps[k]) / count), rounded(bearing))


def body_rectangle(vehicle: Vehicle | None) -> Rectangle:
    """((x, x), (y, y)) of the vehicle as drawn, seen from above [m]."""
    if vehicle is None:
        return (-NO_BODY_M, NO_BODY_M), (-NO_BODY_M, NO_BODY_M)
    (x0, y0, _), (x1, y1, _) = (corner.tolist() for corner in vehicle.as_drawn.bounds)
    return (x0, x1), (y0, y1)


def shown_end(distance: float) -> float:
    """Round where blind ground ends [m], or how much is blind [m2, deg], up to a tenth."""
    return math.ceil(distance * 10.0 - ROUNDING) / 10.0


def shown_start(distance: float) -> float:
    """Round where blind ground begins, or how far is seen [m], down to a tenth."""
    return math.floor(distance * 10.0 + ROUNDING) / 10.0


def shown_reach(distance: float) -> int:
    """Round how far is seen [m] down to a metre."""
    return math.floor(distance + ROUNDING)


def reach_text(distance: float, is_cut: bool) -> str:
    """Return how far is seen as text: "37 m", "≥ 37 m" where what is evaluated ends, or "none"."""
    return f"{'≥ ' * is_cut}{shown_reach(distance)} m" if shown_reach(distance) else "none"


def blind_ground(
    cells: GroundCells, blind: Flags, body: Rectangle, height: float, within: float
) -> BlindGround:
    """Return the figures of blind cells (NX, NY) round a body's rectangle."""
    strips = {side: _Strip.of(cells, blind, body, side) for side in SIDES}
    return BlindGround(
        tuple(map(read_only, outlines(blind.astype(float), 0.5, cells.x, cells.y))),
        area_of(cells, blind),
        height,
        within,
        nearest=ReadOnlyDict({side: strip.nearest() for side, strip in strips.items()}),
        zone=ReadOnlyDict({side: strip.zone() for side, strip in strips.items()}),
        seen_from=ReadOnlyDict({side: strip.seen_from() for side, strip in strips.items()}),
    )


def area_of(cells: GroundCells, blind: Flags) -> float:
    """Return the area of blind cells (NX, NY) [m2]."""
    return float(np.count_nonzero(blind)) * cells.step**2


@dataclass(frozen=True, slots=True)
class _Strip:
    """The strip beside a side of the body's rectangle, as wide as the body. `blind` (N, W) are the
    strip's blind cells, row by row from the body outwards. `distance` (N,) is where each row
    begins, `across` (W,) where its cells are [m]. The body ends at `edge` [m] along the `axis`."""

    blind: Flags
    distance: Floats
    across: Floats
    edge: float
    axis: int
    sign: int

    @classmethod
    def of(cls, cells: GroundCells, blind: Flags, body: Rectangle, side: str) -> "_Strip":
        """Cut out the strip of a side, as wide as the body or one cell."""
        axis, sign = SIDES[side]
        along = (cells.x, cells.y)[axis]
        across = (cells.x, cells.y)[1 - axis]
        edge = body[axis][1] if sign > 0 else body[axis][0]
        low, high = body[1 - axis]
        rows = np.flatnonzero(sign * (along - edge) > 0.0)[::sign]
        middle = np.abs(across - (low + high) / 2.0)
        columns = np.flatnonzero(middle <= max((high - low) / 2.0, float(middle.min())))
        turned = blind if axis == 0 else blind.T
        distance = np.maximum(sign * (along[rows] - edge) - cells.step / 2.0, 0.0)
        distance = np.round(distance, DECIMALS)
        distance[:1] = 0.0  # the body may end within a row: then the next one begins at the body
        strip = turned[np.ix_(rows, columns)]
        first_clear = int(np.argmin(strip.any(axis=1))) if len(strip) else 0
        if len(strip) and distance[first_clear] < NARROW_M:
            strip[:first_clear] = False
        return cls(strip, distance, across[columns], edge, axis=axis, sign=sign)

    def nearest(self) -> BlindSpot | None:
        """The nearest blind location; of several, the one nearest to the middle of the strip."""
        rows = np.flatnonzero(self.blind.any(axis=1))
        if not len(rows):
            return None
        there = self.across[self.blind[rows[0]]]
        middle = (self.across[0] + self.across[-1]) / 2.0
        beside = float(there[np.argmin(np.abs(there - middle))])
        distance = float(self.distance[rows[0]])
        along = self.edge + self.sign * distance
        return BlindSpot((along, beside) if self.axis == 0 else (beside, along), distance)

    def zone(self) -> float | None:
        """Distance from the body to the first row without a blind location [m]."""
        rows = np.flatnonzero(~self.blind.any(axis=1))
        return float(self.distance[rows[0]]) if len(rows) else None

    def seen_from(self) -> float | None:
        """Distance from the body to the end of the last blind location [m]; None at the edge."""
        rows = np.flatnonzero(self.blind.any(axis=1))
        if not len(self.blind) or (len(rows) and rows[-1] == len(self.blind) - 1):
            return None
        return float(self.distance[rows[-1] + 1]) if len(rows) else 0.0


@dataclass(frozen=True, eq=False)
class BlindSearch:
    """Ground that is searched for blind squares: squares with a margin, and the sensors on them.
    `cells` are those of the result, `squares` the same and `margin` more on each side, `own` (NX,
    NY) those of the squares with the vehicle over their centres."""

    cells: GroundCells
    squares: VisibleGroundCache
    margin: int
    own: Flags

    @classmethod
    def of(
        cls,
        cells: GroundCells,
        height: float,
        vehicle: Vehicle | None,
        kernel_cache: dict[str, Any],
        ring: tuple[float, float] | None = None,
    ) -> "BlindSearch":
        """Prepare the search of cells for bodies of a height [m]; with a ring, inner and outer
        radius [m], the result is that of a search of all cells on its middle circle alone."""
        margin = math.ceil(BODY_M / cells.step) + 2
        inner = GroundGrid((float(cells.x0[0]), float(cells.y0[0])), cells.shape, cells.step)
        view = GroundView(inner.widened(margin), height, vehicle, ring)
        own = _under(vehicle, view.grid, max(height, STANDING_M))
        return cls(cells, VisibleGroundCache(view, kernel_cache), margin, own)

    @property
    def size(self) -> int:
        """Its size in the cache, in voxels."""
        return self.own.size // SQUARES_PER_VOXEL

    def blind(self, rig: Rig) -> Flags:
        """Return the blind cells (NX, NY) of a rig."""
        return self._blind(self.squares.marked(rig))

    def by_sensor(self) -> dict[str, Flags]:
        """Return the blind cells (NX, NY) of each sensor of the last rig, as if it were alone."""
        return {name: self._blind(marked) for name, marked in self.squares.by_sensor.items()}

    @property
    def covered(self) -> Flags:
        """Cells (NX, NY) with the vehicle over their centres."""
        return self._inner(self.own)

    def _blind(self, marked: Flags) -> Flags:
        return self._inner(blind_squares(marked & ~self.own, self.own, self.cells.step))

    def _inner(self, squares: Flags) -> Flags:
        inner = tuple(slice(self.margin, n - self.margin) for n in squares.shape)
        return np.ascontiguousarray(squares[inner])


def blind_squares(marked: Flags, covered: Flags, step: float) -> Flags:
    """Return the squares (NX, NY) on which invisible bodies can stand, conservatively.

    A body that is certainly over a marked point, wherever in their squares both are, is visible.
    All squares that other bodies touch may be blind. Of these, the unmarked squares in large enough
    pieces are blind, and the squares beside them: a marked square may be visible only in part.

    `marked` (NX, NY) squares have a point at which something is visible. Those `covered` by the
    vehicle are never blind, but a body may be partly under the vehicle.
    """
    radius = BODY_M / 2.0 / step
    invisible = ~dilated(marked, squares_within(radius))
    may_be_blind = dilated(invisible, squares_touching(radius)) & ~covered
    blind = without_specks(may_be_blind & ~marked, MIN_AREA_M2 / step**2)
    return dilated(blind, squares_touching(PARTLY_VISIBLE)) & may_be_blind


def _under(vehicle: Vehicle | None, grid: GroundGrid, room: float) -> Flags:
    """Return the squares (NX, NY) with the vehicle over their centres. A part beyond the rectangle
    of what is lower than `room` [m] does not count, unless it is narrower than a body."""
    covered = np.zeros(grid.shape, bool)
    if vehicle is None:
        return covered
    first = []
    last = []
    for w, low, high, n in zip(grid.origin, *vehicle.bounds, grid.shape, strict=False):
        first.append(int(np.clip(np.floor((low - w) / grid.step), 0, n - 1)))
        last.append(int(np.clip(np.ceil((high - w) / grid.step), 1, n)))
    i, j = first
    i1, j1 = last
    ends = [
        (w + a * grid.step, w + b * grid.step)
        for w, a, b in zip(grid.origin, first, last, strict=True)
    ]
    space = PerceptionSpace(ends[0], ends[1], (0.0, grid.step), grid.step)
    lowest = -top_heights(vehicle.triangles * (1.0, 1.0, -1.0), space)
    corners = vehicle.triangles.reshape(-1, 3)
    low = corners[corners[:, 2] < room, :2]
    x0, y0 = low.min(axis=0, initial=np.inf)
    x1, y1 = low.max(axis=0, initial=-np.inf)
    x = space.centers(0)[:, None]
    y = space.centers(1)
    over_body = (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)
    beyond = np.isfinite(lowest) & (lowest >= room) & ~over_body
    covered[i:i1, j:j1] = np.isfinite(lowest) & ~opened(beyond, BODY_M / 2.0 / grid.step)
    return covered

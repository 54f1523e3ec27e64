"""Blind ground: where round the vehicle nothing is seen, as outlines and as distances by side.

It is asked of a test body: an upright cylinder of the diameter `BODY_M` that stands on the ground
and is so tall; 0 is a disc that lies flat. A body is unseen where no beam of a LiDAR passes through
it and no line of sight of a camera ends on it. Blind ground is what unseen bodies can stand on: a
gap between beams that is narrower than a body is none.

Squares of the ground say where something is seen for sure (`kinds.ground_kernel`). From these, all
unseen bodies are found, and perhaps a few that are seen by a hair's breadth: figures err to the
safe side. Blind ground, area and distances are never too small, but for specks (`LEAST_M2`) and
strips along the body narrower than `STRIP_SQUARES`; and edges lie at most `ERR_SQUARES` too far out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import GroundView, VisibleGroundCache
from ..scene.frozen import frozen
from ..scene.ground_grid import GroundGrid
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .cells import ROUNDING, STEP, GroundCells, Rectangle
from .outline import outlines
from .regions import dilated, squares_touching, squares_within, without_specks

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

BODY_M = 0.3
"""Diameter of the test body: that of the cylinders of FMVSS 111 and UN regulation 158, about as wide
as a small child."""
STEP_M, MOST_STEP_M = 0.05, 0.1
"""Side of the squares; with larger ones no body would be known to be seen."""
LEAST_M2 = 0.18
"""Pieces of whole unseen squares smaller than this are none: every piece of 0.25 m2 has more."""
STRIP_SQUARES = math.sqrt(2.0)
"""Between what is seen and an unseen square lies no more than this, in squares."""
NARROW_M = 0.1
"""A strip of blind ground along the body that is narrower than this is none, to a side: less than
what edges may be too far out."""
NO_BODY_M = 1.0
"""Half the side of the square that stands for the body where there is no vehicle."""
SQUARES_A_VOXEL = 16
"""Of what is kept of voxels and squares: some bytes to some 100."""
DECIMALS = 6
"""Distances are rounded to the micrometre."""
SIDES = {"front": (0, 1), "rear": (0, -1), "left": (1, 1), "right": (1, -1)}
"""By side: the axis that leads there, and which way."""


@dataclass(frozen=True, slots=True)
class BlindSpot:
    """A place that is not seen: `point` (2,) and its distance from the vehicle's body, in m."""

    point: tuple[float, float]
    distance: float


@dataclass(frozen=True, slots=True, eq=False)
class BlindGround:
    """Ground round the vehicle where no sensor sees anything of what stands there.

    Attributes
    ----------
    outlines : tuple of (N, 2) float
        Closed lines round it, the blind ground on their left; the last point is the first [m].
    area : float
        [m2]
    height : float
        How tall it is [m].
    within : float
        How far from the body's rectangle it was looked [m].
    nearest : dict of BlindSpot or None
        By side (front, rear, left, right): the nearest blind place in the strip that the body's
        rectangle sweeps to that side; None where there is none.
    zone : dict of float or None
        By side: how far the blind ground that begins at the body reaches in that strip, to where
        the whole width is seen for the first time [m]; 0 where it is at the body, None where it
        never is.
    seen_from : dict of float or None
        By side: the distance from the body from which on that strip has no blind place any more, as
        far as was looked [m]; None where there is one at the edge.
    draft : bool
        Some LiDAR's beams were stopped by a map of the vehicle's top, not by the vehicle itself.
    """

    outlines: tuple[Floats, ...]
    area: float
    height: float
    within: float
    nearest: Mapping[str, BlindSpot | None]
    zone: Mapping[str, float | None]
    seen_from: Mapping[str, float | None]
    draft: bool = False


def body_rectangle(vehicle: Vehicle | None) -> Rectangle:
    """((x, x), (y, y)) of the vehicle seen from above [m]."""
    if vehicle is None:
        return (-NO_BODY_M, NO_BODY_M), (-NO_BODY_M, NO_BODY_M)
    (x0, y0, _), (x1, y1, _) = (corner.tolist() for corner in vehicle.bounds)
    return (x0, x1), (y0, y1)


def fine_enough(step: float) -> float:
    """Cut a square's side [m] in equal parts that bodies can be told by."""
    step = STEP.checked("sight", "step", step)
    return step / math.ceil(step / MOST_STEP_M - ROUNDING)


def blind_ground(
    cells: GroundCells, blind: Flags, body: Rectangle, height: float, within: float, draft: bool
) -> BlindGround:
    """Put together what is told of blind cells (NX, NY) round a body's rectangle."""
    strips = {side: _Strip.of(cells, blind, body, side) for side in SIDES}
    return BlindGround(
        tuple(map(frozen, outlines(blind.astype(float), 0.5, cells.x, cells.y))),
        float(np.count_nonzero(blind)) * cells.step**2,
        height,
        within,
        MappingProxyType({side: strip.nearest() for side, strip in strips.items()}),
        MappingProxyType({side: strip.zone() for side, strip in strips.items()}),
        MappingProxyType({side: strip.seen_from() for side, strip in strips.items()}),
        draft,
    )


@dataclass(frozen=True, slots=True)
class _Strip:
    """The strip that a body's rectangle sweeps to a side: its blind cells from the body outwards.

    `blind` (N, W) rows away from the body, the `distance` (N,) [m] at which each begins, and where
    its cells lie `across` (W,) [m]; the body ends at `edge` [m] along the `axis`.
    """

    blind: Flags
    distance: Floats
    across: Floats
    edge: float
    axis: int
    sign: int

    @classmethod
    def of(cls, cells: GroundCells, blind: Flags, body: Rectangle, side: str) -> _Strip:
        """Cut out the strip of a side, as wide as the body or one cell."""
        axis, sign = SIDES[side]
        along, across = (cells.x, cells.y)[axis], (cells.x, cells.y)[1 - axis]
        edge = body[axis][1] if sign > 0 else body[axis][0]
        low, high = body[1 - axis]
        rows = np.flatnonzero(sign * (along - edge) > 0.0)[::sign]
        middle = np.abs(across - (low + high) / 2.0)
        columns = np.flatnonzero(middle <= max((high - low) / 2.0, float(middle.min())))
        turned = blind if axis == 0 else blind.T
        distance = np.maximum(sign * (along[rows] - edge) - cells.step / 2.0, 0.0)
        distance = np.round(distance, DECIMALS)
        strip = turned[np.ix_(rows, columns)]
        first_clear = int(np.argmin(strip.any(axis=1))) if len(strip) else 0
        if len(strip) and distance[first_clear] < NARROW_M:
            strip[:first_clear] = False
        return cls(strip, distance, across[columns], edge, axis, sign)

    def nearest(self) -> BlindSpot | None:
        """The nearest blind place, in the middle of the strip if there are several."""
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
        """How far from the body the first row without a blind place is; 0 where that is the first.

        The body may end within a row: what is left of that row is nothing to tell.
        """
        rows = np.flatnonzero(~self.blind.any(axis=1))
        if not len(rows):
            return None
        return float(self.distance[rows[0]]) if rows[0] else 0.0

    def seen_from(self) -> float | None:
        """How far from the body the last blind place ends; None at the edge."""
        rows = np.flatnonzero(self.blind.any(axis=1))
        if not len(self.blind) or (len(rows) and rows[-1] == len(self.blind) - 1):
            return None
        return float(self.distance[rows[-1] + 1]) if len(rows) else 0.0


@dataclass(frozen=True, eq=False)
class BlindLook:
    """Ground that is looked at for blind places: squares with a margin, and the sensors on them.

    Attributes
    ----------
    cells : GroundCells
        What is told of.
    squares : VisibleGroundCache
        The same squares, and `margin` more on each side.
    own : (NX, NY) bool
        Squares with the vehicle over their middles.
    """

    cells: GroundCells
    squares: VisibleGroundCache
    margin: int
    own: Flags

    @classmethod
    def of(
        cls, cells: GroundCells, height: float, vehicle: Vehicle | None, known: dict[str, Any]
    ) -> BlindLook:
        """Look at cells, at bodies of a height [m]; `known` as `VisibleGroundCache` has it."""
        margin = math.ceil(BODY_M / cells.step) + 2
        inner = GroundGrid((float(cells.x0[0]), float(cells.y0[0])), cells.shape, cells.step)
        view = GroundView(inner.widened(margin), height, vehicle)
        own = _under(vehicle, view.grid)
        return cls(cells, VisibleGroundCache(view, known), margin, own)

    @property
    def size(self) -> int:
        """How much is kept, in voxels' room."""
        return self.own.size // SQUARES_A_VOXEL

    def blind(self, rig: Rig, draft: bool) -> tuple[Flags, bool]:
        """Blind cells (NX, NY) of a rig, and whether that is a draft."""
        marked, drafted = self.squares.marked(rig, draft)
        blind = blind_squares(marked & ~self.own, self.own, self.cells.step)
        inner = tuple(slice(self.margin, n - self.margin) for n in blind.shape)
        return np.ascontiguousarray(blind[inner]), drafted


def blind_squares(marked: Flags, own: Flags, step: float) -> Flags:
    """Squares (NX, NY) that unseen bodies can stand on, none too few.

    Where a body surely is over a marked place, wherever in its squares both are, it is seen. All
    squares that other bodies touch may be blind. Of these the unmarked ones are, in pieces that
    are large enough, and those beside them: a marked square need not be seen in all of it.

    Parameters
    ----------
    marked : (NX, NY) bool
        Squares with a place at which something is seen.
    own : (NX, NY) bool
        The vehicle's: never blind, but a body may be partly under it.
    step : float
        Side of a square [m].
    """
    radius = BODY_M / 2.0 / step
    unseen = ~dilated(marked, squares_within(radius))
    maybe = dilated(unseen, squares_touching(radius)) & ~own
    blind = without_specks(maybe & ~marked, LEAST_M2 / step**2)
    return dilated(blind, squares_touching(STRIP_SQUARES)) & maybe


def _under(vehicle: Vehicle | None, grid: GroundGrid) -> Flags:
    """Squares (NX, NY) with the vehicle over their middles."""
    own = np.zeros(grid.shape, bool)
    if vehicle is None:
        return own
    first, last = [], []
    for w, low, high, n in zip(grid.origin, *vehicle.bounds, grid.shape, strict=False):
        first.append(int(np.clip(np.floor((low - w) / grid.step), 0, n - 1)))
        last.append(int(np.clip(np.ceil((high - w) / grid.step), 1, n)))
    (i, j), (i1, j1) = first, last
    ends = [(w + a * grid.step, w + b * grid.step) for w, a, b in zip(grid.origin, first, last)]
    space = PerceptionSpace(ends[0], ends[1], (0.0, grid.step), grid.step)
    own[i:i1, j:j1] = np.isfinite(vehicle.top(space))
    return own

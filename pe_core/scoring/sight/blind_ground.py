"""Blind ground: where round the vehicle nothing is seen, as outlines and as distances by side.

Which squares of the ground are blind, `blind_squares` says. Distances are from the body's
rectangle; they are rounded away from what is seen, so that no figure is better than it is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...base.read_only import read_only
from ...scene.vehicle import Vehicle
from .grid_regions import outlines
from .ground_cells import ROUNDING, GroundCells, Rectangle

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

NARROW_M = 0.1
"""A strip of blind ground along the body that is narrower than this is none, to a side: less than
what edges may be too far out."""
NO_BODY_M = 1.0
"""Half the side of the square that stands for the body where there is no vehicle."""
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


def shown_end(distance: float) -> float:
    """Round where blind ground ends [m] to a decimetre, outwards."""
    return math.ceil(distance * 10.0 - ROUNDING) / 10.0


def shown_start(distance: float) -> float:
    """Round where blind ground begins [m] to a decimetre, towards the body."""
    return math.floor(distance * 10.0 + ROUNDING) / 10.0


def blind_ground(
    cells: GroundCells, blind: Flags, body: Rectangle, height: float, within: float, draft: bool
) -> BlindGround:
    """Put together what is told of blind cells (NX, NY) round a body's rectangle."""
    strips = {side: _Strip.of(cells, blind, body, side) for side in SIDES}
    return BlindGround(
        tuple(map(read_only, outlines(blind.astype(float), 0.5, cells.x, cells.y))),
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
        distance[:1] = 0.0  # the body may end within a row: then the next one begins at the body
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
        """How far from the body the first row without a blind place is."""
        rows = np.flatnonzero(~self.blind.any(axis=1))
        return float(self.distance[rows[0]]) if len(rows) else None

    def seen_from(self) -> float | None:
        """How far from the body the last blind place ends; None at the edge."""
        rows = np.flatnonzero(self.blind.any(axis=1))
        if not len(self.blind) or (len(rows) and rows[-1] == len(self.blind) - 1):
            return None
        return float(self.distance[rows[-1] + 1]) if len(rows) else 0.0

"""Blind ground: outlines of the ground round the vehicle that no sensor sees, and distances.

`blind_squares` finds the blind squares of the ground. Distances are from the body's rectangle. They
are rounded to the worse side, so no figure looks better than the truth.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ...base.arrays import Flags, Floats, read_only
from ...scene.vehicle import Vehicle
from .grid_regions import outlines
from .ground_cells import ROUNDING, GroundCells, Rectangle

BLIND_TO_M = 0.5
"""Height of the object for which blind ground is computed [m]: a post at the kerb or a small child.
Flat ground would not do: far from the vehicle beams meet it only in rings."""
NARROW_M = 0.1
"""A narrower strip of blind ground along the body does not count, on a side: edges may be this much
too far out."""
NO_BODY_M = 1.0
"""Half the side of the square that replaces the body without a vehicle."""
DECIMALS = 6
"""Distances are rounded to the micrometre."""
SIDES = {"front": (0, 1), "rear": (0, -1), "left": (1, 1), "right": (1, -1)}
"""By side: the axis towards it, and the sign of the direction."""


@dataclass(frozen=True, slots=True)
class BlindSpot:
    """A location on blind ground: `point` (2,) and its distance from the vehicle's body [m]."""

    point: tuple[float, float]
    distance: float


@dataclass(frozen=True, slots=True, eq=False)
class BlindGround:
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
    preview : bool
        Approximate preview: occlusion of a LiDAR was read from a map of the vehicle's top surface.
    """

    outlines: tuple[Floats, ...]
    area: float
    height: float
    within: float
    nearest: Mapping[str, BlindSpot | None]
    zone: Mapping[str, float | None]
    seen_from: Mapping[str, float | None]
    preview: bool = False


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
    cells: GroundCells, blind: Flags, body: Rectangle, height: float, within: float, preview: bool
) -> BlindGround:
    """Return the figures of blind cells (NX, NY) round a body's rectangle."""
    strips = {side: _Strip.of(cells, blind, body, side) for side in SIDES}
    return BlindGround(
        tuple(map(read_only, outlines(blind.astype(float), 0.5, cells.x, cells.y))),
        area_of(cells, blind),
        height,
        within,
        MappingProxyType({side: strip.nearest() for side, strip in strips.items()}),
        MappingProxyType({side: strip.zone() for side, strip in strips.items()}),
        MappingProxyType({side: strip.seen_from() for side, strip in strips.items()}),
        preview,
    )


def area_of(cells: GroundCells, blind: Flags) -> float:
    """Return the area of blind cells (NX, NY) [m2]."""
    return float(np.count_nonzero(blind)) * cells.step**2


@dataclass(frozen=True, slots=True)
class _Strip:
    """The strip beside a side of the body's rectangle, as wide as the body.

    `blind` (N, W) are the strip's blind cells, row by row from the body outwards. `distance` (N,)
    is where each row begins, `across` (W,) where its cells are [m]. The body ends at `edge` [m]
    along the `axis`.
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

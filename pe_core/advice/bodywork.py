"""The vehicle's body as advice looks at it: without a floor or a studio that came with it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..scene.vehicle import Vehicle

Floats = NDArray[np.float64]

ROOM_M = 4.0
"""A part is as large as a room when two of its sides are this long [m]..."""
FAR_LARGER = 1.5
"""...and so many times as long as those of all smaller parts together."""
BINS = 256


@dataclass(frozen=True)
class Bodywork:
    """A vehicle in figures.

    Attributes
    ----------
    vehicle : Vehicle
        As it is.
    rooms : tuple of str
        Parts as large as a room.
    """

    vehicle: Vehicle
    rooms: tuple[str, ...]

    @classmethod
    def of(cls, vehicle: Vehicle) -> Bodywork:
        """Look a vehicle over."""
        return cls(vehicle, _rooms(vehicle))

    @cached_property
    def itself(self) -> Vehicle:
        """The vehicle without its rooms."""
        if not self.rooms:
            return self.vehicle
        names = self.vehicle.part_names
        ours = ~np.isin(self.vehicle.parts, [names.index(name) for name in self.rooms])
        parts = np.asarray(self.vehicle.parts)[ours]
        glass = tuple(self.vehicle.glass)
        return Vehicle(self.vehicle.triangles[ours], parts, names, glass, self.vehicle.clearance)

    @property
    def low(self) -> Floats:
        """Lowest corner (3,) [m]."""
        return self.itself.bounds[0]

    @property
    def high(self) -> Floats:
        """Highest corner (3,) [m]."""
        return self.itself.bounds[1]

    @property
    def size(self) -> tuple[float, float, float]:
        """Extent along x, y, z [m]."""
        x, y, z = (self.high - self.low).tolist()
        return x, y, z

    @cached_property
    def lopsided(self) -> tuple[float, float, float]:
        """How unlike its mirror image it is along x, y, z: 0 alike, 2 as unlike as can be.

        The distance that its surface has to be carried along the axis to become its mirror image,
        in half sides.
        """
        triangles = self.itself.triangles
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        area = np.sqrt((normal * normal).sum(axis=1))
        x, y, z = (_lopsided(triangles[:, :, k].mean(axis=1), area) for k in range(3))
        return x, y, z

    def part_centers(self) -> dict[str, Floats]:
        """Middle of the bounds (3,) of every part [m], by name."""
        low, high, there = _part_bounds(self.itself)
        names = self.vehicle.part_names
        return {names[k]: (low[k] + high[k]) / 2.0 for k in np.flatnonzero(there)}


def _lopsided(at: Floats, area: Floats) -> float:
    low, high = float(at.min()), float(at.max())
    total = float(area.sum())
    if not (high > low and total > 0.0):
        return 0.0
    bins = np.minimum((at - low) * (BINS / (high - low)), BINS - 1).astype(np.int64)
    share = np.bincount(bins, area, BINS) / total
    return float(np.abs(np.cumsum(share) - np.cumsum(share[::-1])).sum()) * 2.0 / BINS


def _part_bounds(vehicle: Vehicle) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Lowest and highest corners (P, 3) of the parts, and which parts have any triangles."""
    count = len(vehicle.part_names)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, vehicle.parts, vehicle.triangles.min(axis=1))
    np.maximum.at(high, vehicle.parts, vehicle.triangles.max(axis=1))
    return low, high, np.isfinite(low[:, 0])


def _rooms(vehicle: Vehicle) -> tuple[str, ...]:
    """Name the parts that are far larger, two ways, than all parts that no room could be."""
    low, high, there = _part_bounds(vehicle)
    size = np.where(there[:, None], high - low, 0.0)
    longest = np.sort(size, axis=1)[:, ::-1]
    large = there & (longest[:, 1] >= ROOM_M)
    rest = there & ~large
    if not (large.any() and rest.any()):
        return ()
    others = np.sort(high[rest].max(axis=0) - low[rest].min(axis=0))[::-1]
    larger = (longest[:, :2] >= FAR_LARGER * others[:2]).all(axis=1)
    return tuple(vehicle.part_names[k] for k in np.flatnonzero(large & larger))

"""The vehicle's body as advice looks at it: without a floor or a studio that came with it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..scene.vehicle import Vehicle

Floats = NDArray[np.float64]
PartBounds = tuple[Floats, Floats, NDArray[np.bool_]]
"""Lowest and highest corners (P, 3) of the parts, and which parts have any triangles."""

ROOM_M = 4.0
"""A part is as large as a room when two of its sides are this long [m]..."""
FAR_LARGER = 1.5
"""...and so many times as long as those of all smaller parts together."""
BINS, ENOUGH = 256, 200_000
"""Bins of a mesh's surface along an axis, and how many of its triangles are sorted into them."""


@dataclass(frozen=True)
class Bodywork:
    """A vehicle in figures; `vehicle` is as it came."""

    vehicle: Vehicle

    @cached_property
    def rooms(self) -> tuple[str, ...]:
        """Parts as large as a room."""
        return tuple(self.vehicle.part_names[k] for k in _rooms(*self._part_bounds))

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

    @cached_property
    def _part_bounds(self) -> PartBounds:
        return _part_bounds(self.vehicle)

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
        every = -(-len(self.itself.triangles) // ENOUGH)
        triangles = self.itself.triangles[::every]
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        area = np.sqrt((normal * normal).sum(axis=1))
        x, y, z = (_lopsided(triangles[:, :, k].mean(axis=1), area) for k in range(3))
        return x, y, z

    def part_centers(self) -> dict[str, Floats]:
        """Middle of the bounds (3,) of every part that is no room [m], by name."""
        low, high, there = self._part_bounds
        named = ((self.vehicle.part_names[k], k) for k in np.flatnonzero(there).tolist())
        return {name: (low[k] + high[k]) / 2.0 for name, k in named if name not in self.rooms}


def _lopsided(at: Floats, area: Floats) -> float:
    low, high = float(at.min()), float(at.max())
    total = float(area.sum())
    if not (high > low and total > 0.0):
        return 0.0
    bins = np.minimum((at - low) * (BINS / (high - low)), BINS - 1).astype(np.int64)
    share = np.bincount(bins, area, BINS) / total
    return float(np.abs(np.cumsum(share) - np.cumsum(share[::-1])).sum()) * 2.0 / BINS


def _part_bounds(vehicle: Vehicle) -> PartBounds:
    count, parts = len(vehicle.part_names), np.asarray(vehicle.parts)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(parts)) + 1])  # runs of one part
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    a, b, c = (vehicle.triangles[:, k] for k in range(3))
    least, most = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    np.minimum.at(low, parts[starts], np.minimum.reduceat(least, starts, axis=0))
    np.maximum.at(high, parts[starts], np.maximum.reduceat(most, starts, axis=0))
    return low, high, np.isfinite(low[:, 0])


def _rooms(low: Floats, high: Floats, there: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Find the parts that are far larger, two ways, than all parts that no room could be."""
    size = np.where(there[:, None], high - low, 0.0)
    longest = np.sort(size, axis=1)[:, ::-1]
    large = there & (longest[:, 1] >= ROOM_M)
    rest = there & ~large
    if not (large.any() and rest.any()):
        return np.zeros(0, np.int64)
    others = np.sort(high[rest].max(axis=0) - low[rest].min(axis=0))[::-1]
    larger = (longest[:, :2] >= FAR_LARGER * others[:2]).all(axis=1)
    return np.flatnonzero(large & larger)

"""The vehicle's body as advice looks at it: without a floor or a studio that came with it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..scene.body_shape import BodyShape
from ..scene.vehicle import Vehicle

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Bodywork:
    """A vehicle in figures; `vehicle` is as it came."""

    vehicle: Vehicle

    @cached_property
    def shape(self) -> BodyShape:
        """Its shape, in the ground frame."""
        vehicle = self.vehicle
        return BodyShape(vehicle.triangles, vehicle.parts, tuple(vehicle.part_names))

    @property
    def rooms(self) -> tuple[str, ...]:
        """Parts as large as a room."""
        return self.shape.rooms

    @cached_property
    def itself(self) -> Vehicle:
        """The vehicle without its rooms."""
        ours = self.shape.is_ours
        if ours is None:
            return self.vehicle
        vehicle = self.vehicle
        parts, names = np.asarray(vehicle.parts)[ours], vehicle.part_names
        glass = tuple(vehicle.glass)
        return Vehicle(vehicle.triangles[ours], parts, names, glass, vehicle.clearance)

    @property
    def low(self) -> Floats:
        """Lowest corner (3,) [m]."""
        return self.shape.bounds[0]

    @property
    def high(self) -> Floats:
        """Highest corner (3,) [m]."""
        return self.shape.bounds[1]

    @property
    def size(self) -> tuple[float, float, float]:
        """Extent along x, y, z [m]."""
        return self.shape.size

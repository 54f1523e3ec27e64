"""What the kinds of sensors with a fan of rays have in common: kernels, rays, ego mask."""

from __future__ import annotations

from typing import ClassVar

from ..base.arrays import Floats
from ..geometry.grids import PerceptionSpace
from ..scene.rig import Sensor, SensorModel
from ..scene.vehicle import Vehicle
from .field_of_view import EgoMask, ViewPatch
from .ground_kernel import GroundView
from .kernels import Voxels
from .kind import Kind
from .object_kernel import ObjectView
from .ray_fan import window_of, without_parts
from .ray_fan_kernels import FanGrid, FanGround, FanObjects, FanRules, FanSample
from .ray_fan_view import fan_rays, free_fan, patch_of


class FanKind(Kind):
    """A kind whose sensors measure by a fan of rays, as `rules` has it."""

    rules: ClassVar[FanRules]

    def measure(
        self, sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None
    ) -> Floats:
        """Measure cubes with centres (V, 3)."""
        return self.rules.voxels(sensor, centers, side, self.rules.fan(sensor, vehicle))

    def rays(self, sensor: Sensor, most: int) -> Floats:
        """Return rays in the field of view."""
        fan = free_fan(window_of(sensor.model))
        return fan_rays(sensor, fan.window, self.rules.field(sensor, fan), most)

    def view(self, model: SensorModel, step: float) -> ViewPatch:
        """Return the azimuths and elevations round the field of view."""
        return patch_of(window_of(model), step)

    def opaque(self, vehicle: Vehicle) -> Vehicle | None:
        """Return the vehicle without the covers that let rays through; None if nothing is left."""
        return without_parts(vehicle, tuple(vehicle.covers if self.rules.through_covers else ()))

    def ego_mask(self, sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
        """Return the rays of its fan: those that a cover lets through are free."""
        return self.rules.fan(sensor, vehicle).mask()

    def on_grid(
        self, space: PerceptionSpace, vehicle: Vehicle | None, saturation_count: int
    ) -> FanGrid:
        """Return a kernel that measures the columns in the field of view."""
        return FanGrid(self.rules, space, vehicle)

    def on_sample(
        self, voxels: Voxels, vehicle: Vehicle | None, saturation_count: int
    ) -> FanSample:
        """Return a kernel that keeps the rays of sensors that have not moved."""
        return FanSample(self.rules, voxels, vehicle)

    def on_ground(self, view: GroundView) -> FanGround:
        """Return a kernel that detects posts."""
        return FanGround(self.rules, view)

    def on_objects(self, view: ObjectView) -> FanObjects:
        """Return a kernel that measures the objects near the field of view."""
        return FanObjects(self.rules, view)

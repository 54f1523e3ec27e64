"""Kernels of sensors with a fan of rays: what radars and ultrasonic sensors have in common.

A fan is cast once for each sensor and kept until the sensor moves. `FanRules` is what a kind adds:
its field of view, and its definition of m by a fan. The kernels apply the definition where the
field of view may reach.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import Flags, Floats
from ..geometry.grids import PerceptionSpace
from ..metric.fusion import VisibleRows
from ..scene.rig import Sensor, SensorModel
from ..scene.vehicle import Vehicle
from .field_of_view import ViewPatch
from .kernels import (
    GridKernel,
    GroundKernel,
    GroundView,
    Measured,
    ObjectKernel,
    ObjectView,
    Occlusion,
    SampleKernel,
    VisibleGround,
    Voxels,
    block_voxels,
    heights_of_post,
)
from .ray_fan import FanCache, RayFan, cast_fan, fan_rays, patch_of, window_of, without_parts

VOXEL_BYTES = 200  # Memory of a voxel of a block while it is measured (measured)
BALL_MARGIN_M = 1e-3
NEAR_FIELD_M = 10.0
FINE_M = 0.02
"""A sensor of a shorter range than this has squares of the ground tested every 2 cm [m]."""


@dataclass(frozen=True, slots=True)
class FanRules:
    """How a kind of sensor measures by a fan of rays."""

    through_covers: bool
    """Whether rays pass the covers of the vehicle."""
    field: Callable[[Sensor, RayFan], Flags]
    """Which rays (E, A) of a fan are in the field of view."""
    reached: Callable[[Sensor, Floats, Floats], Flags]
    """Whether balls, points (N, 3) and radii (N,) [m], may reach into field and range."""
    voxels: Callable[[Sensor, Floats, float, RayFan], Floats]
    """m (V,) of cubes with centres (V, 3) and a side [m]."""
    columns: Callable[[Sensor, Floats, Floats, float, RayFan], Floats]
    """m (C, Z) of upright columns of cubes: x and y (C, 2), heights (Z,); the same as `voxels`."""
    posts: Callable[[Sensor, Floats, RayFan], Flags]
    """Whether points (N, 3) of thin upright posts are detected."""
    objects: Callable[[Sensor, ObjectView, RayFan], Floats]
    """m (N,) of the objects of a view."""

    def fan(self, sensor: Sensor, vehicle: Vehicle | None) -> RayFan:
        """Cast the fan of a sensor."""
        return cast_fan(sensor, vehicle, self.through_covers)

    def cache(self, vehicle: Vehicle | None) -> FanCache:
        """Return an empty cache of fans."""
        return FanCache(vehicle, self.through_covers)

    def occlusion(self, sensor: Sensor, fan: RayFan) -> Occlusion:
        """Count the rays of the field of view, and those of them that end on the vehicle."""
        return fan.occlusion(self.field(sensor, fan))

    def measure(
        self, sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None
    ) -> Floats:
        """Return m (V,) of cubes by definition."""
        return self.voxels(sensor, centers, side, self.fan(sensor, vehicle))

    def rays(self, sensor: Sensor, most: int) -> Floats:
        """Return at most `most` rays (R, 3) in the field of view, ground frame."""
        fan = RayFan.free(window_of(sensor.model))
        return fan_rays(sensor, fan.window, self.field(sensor, fan), most)

    def view(self, model: SensorModel, step: float) -> ViewPatch:
        """Return the azimuths and elevations round the field of view."""
        return patch_of(window_of(model), step)

    def opaque(self, vehicle: Vehicle) -> Vehicle | None:
        """Return the vehicle without the covers that let rays through; None if nothing is left."""
        return without_parts(vehicle, tuple(vehicle.covers if self.through_covers else ()))

    @property
    def functions(self) -> dict[str, Any]:
        """What the row of a kind with a fan takes from its rules: kernels, rays, views."""
        own = ("measure", "rays", "view", "opaque")
        kernels = {
            "on_grid": FanGrid,
            "on_sample": FanSample,
            "on_ground": FanGround,
            "on_objects": FanObjects,
        }
        return {
            **{name: getattr(self, name) for name in own},
            **{name: partial(kernel, self) for name, kernel in kernels.items()},
        }


class FanSensor(NamedTuple):
    """A mounted sensor with its fan of rays."""

    sensor: Sensor
    fan: RayFan


class FanGrid(GridKernel):
    """Measures the rows of a space that the field of view reaches."""

    def __init__(
        self, rules: FanRules, space: PerceptionSpace, vehicle: Vehicle | None, _: int
    ) -> None:
        self._rules = rules
        self._space = space
        self._vehicle = vehicle

    def prepare(self, sensor: Sensor) -> FanSensor:
        """Cast the rays."""
        return FanSensor(sensor, self._rules.fan(sensor, self._vehicle))

    def occlusion(self, prepared: FanSensor) -> Occlusion:
        """Count rays of the field of view that end on the vehicle."""
        return self._rules.occlusion(*prepared)

    def memory_bytes(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Estimate the memory [bytes]."""
        return workers * min(block_voxels(space), space.shape[1] * space.shape[2]) * VOXEL_BYTES

    def rows(self, prepared: FanSensor, planes: slice) -> VisibleRows:
        """Measure plane by plane, only the columns that may be reached."""
        x, y, z = (self._space.centers(axis) for axis in range(3))
        columns = np.stack(np.meshgrid(x[planes], y, indexing="ij"), axis=-1)
        # of balls round columns
        middle = (z[0] + z[-1]) / 2.0
        half = (z[-1] - z[0]) / 2.0
        across = columns.reshape(-1, 2)
        centers = np.column_stack([across, np.full(len(across), middle)])
        balls = np.full(len(centers), half + BALL_MARGIN_M)
        reached = self._rules.reached(prepared.sensor, centers, balls).reshape(columns.shape[:2])
        rows = np.flatnonzero(reached.any(axis=0))
        n = planes.stop - planes.start
        if not len(rows):
            return VisibleRows(slice(0, 0), np.zeros((n, 0, len(z))))
        first = int(rows[0])
        last = int(rows[-1]) + 1
        m = np.zeros((n, last - first, len(z)))
        side = self._space.interval
        for number in range(n):
            some = np.flatnonzero(reached[number, first:last])
            flat = columns[number, first:last][some]
            m[number, some] = self._rules.columns(prepared.sensor, flat, z, side, prepared.fan)
        return VisibleRows(slice(first, last), m)


class FanSample(SampleKernel):
    """Measures sampled voxels."""

    def __init__(self, rules: FanRules, voxels: Voxels, vehicle: Vehicle | None, _: int) -> None:
        self._rules = rules
        self._voxels = voxels
        self.cache = rules.cache(vehicle)

    def measure(self, sensor: Sensor) -> Measured:
        """Measure a sensor."""
        voxels = self._voxels
        fan = self.cache.fan(sensor)
        m = self._rules.voxels(sensor, voxels.centers, voxels.space.interval, fan)
        return Measured(sensor, m)

    def occlusion(self, measured: Measured) -> Occlusion:
        """Count rays of the field of view that end on the vehicle."""
        return self._rules.occlusion(measured.sensor, self.cache.fan(measured.sensor))


class FanGround(GroundKernel):
    """Marks squares with a post in them, a point of which is detected."""

    def __init__(self, rules: FanRules, view: GroundView) -> None:
        self._rules = rules
        self._view = view
        self.cache = rules.cache(view.vehicle)

    def mark(self, sensor: Sensor) -> VisibleGround:
        """Test the points of the posts."""
        grid = self._view.grid
        height = self._view.height
        marked = np.zeros(grid.shape[0] * grid.shape[1], bool)
        middles = grid.middles(np.arange(len(marked)))
        centers = np.column_stack([middles, np.full(len(middles), height / 2.0)])
        balls = np.full(len(centers), height / 2.0 + BALL_MARGIN_M + grid.step)
        possible = self._rules.reached(sensor, centers, balls)
        fan = self.cache.fan(sensor)
        for z in heights_of_post(height).tolist():
            for beside in places_in_square(sensor, grid.step):
                left = np.flatnonzero(possible & ~marked)
                points = np.column_stack([middles[left] + beside, np.full(len(left), z)])
                marked[left] = self._rules.posts(sensor, points, fan)
        return VisibleGround(sensor, marked.reshape(grid.shape))


def places_in_square(sensor: Sensor, step: float) -> Floats:
    """Return places (P, 2) that are tested, from a square's middle [m]; the middle is one of them.
    A square of the side `step` [m] is marked if a post somewhere in it is detected: near the edges
    of a cone of 2 m, and close to the body, the middles of squares of 5 cm are too few."""
    if float(sensor.model.max_range) >= NEAR_FIELD_M:  # type: ignore[attr-defined]  # as window_of
        return np.zeros((1, 2))
    steps = math.ceil(step / FINE_M / 2.0 - 0.5)
    along = np.arange(-steps, steps + 1) * (step / (2 * steps + 1))
    places = np.stack(np.meshgrid(along, along, indexing="ij"), axis=-1).reshape(-1, 2)
    return places[np.argsort((places * places).sum(axis=1), kind="stable")]


class FanObjects(ObjectKernel):
    """Measures objects."""

    def __init__(self, rules: FanRules, view: ObjectView) -> None:
        self._rules = rules
        self._view = view
        self.cache = rules.cache(view.vehicle)

    def measure(self, sensor: Sensor) -> Floats:
        """Measure the objects; equal to the definition."""
        return self._rules.objects(sensor, self._view, self.cache.fan(sensor))

"""Caches of measurements by sensor: a sensor that has not moved is not measured again.

Each cache keeps the sensors of the last rig, by name. There is one for voxels, one for objects and
one for squares of the ground.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Flags, Floats
from ..metric.entropy import ApCurve
from ..metric.fusion import CurveOf
from ..scene.objects import Objects
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from .body_parts import BodyParts
from .ground_kernel import GroundKernel, GroundView, VisibleGround
from .kernels import Measured, Occlusion, SampleKernel, Voxels
from .kind import Kind, kind_of
from .object_kernel import ObjectKernel, ObjectView
from .weather_rig import clear_air, within_range


class MeasurementCache:
    """Measures rigs on a fixed set of voxels.

    Parameters
    ----------
    voxels : Voxels
    vehicle : Vehicle or None
    saturation_count : callable
        The integer m from which AP is at its maximum, by kind or AP curve.
    kernel_caches : dict, optional
        Caches of kernels by kind, shared by several of these on one vehicle.
    """

    def __init__(
        self,
        voxels: Voxels,
        vehicle: Vehicle | None,
        saturation_count: Callable[[CurveOf], int],
        kernel_caches: dict[str, Any] | None = None,
    ) -> None:
        self._voxels, self._vehicle = voxels, vehicle
        self._saturation_count = saturation_count
        self._kernel_caches = {} if kernel_caches is None else kernel_caches
        self._kernels: dict[tuple[str, ApCurve | None], SampleKernel] = {}
        self._measured: dict[str, Measured] = {}
        self._clear: dict[Hashable, Measured] = {}  # in clear air, of the last rig and of `_stayed`
        self._occlusions: dict[Hashable, Occlusion] = {}
        self._stayed: dict[str, Hashable] = {}  # where each sensor last was for two rigs in a row

    @property
    def last(self) -> Mapping[str, Measured]:
        """Measurements of the last rig, by sensor."""
        return MappingProxyType(self._measured)

    @property
    def m(self) -> dict[str, NDArray]:
        """m (V,) of the sensors of the last rig."""
        return {name: measured.m for name, measured in self._measured.items()}

    def measure(
        self, rig: Rig, approximate: bool = False, done: Callable[[], None] | None = None
    ) -> None:
        """Measure the sensors that are not cached; without `approximate` exactly.

        `done` is called after each sensor; if it raises, the cache stays as it was.
        """
        before, stayed = self._measured, self._stayed
        measured = {}
        for s in rig:
            measured[s.name] = self.cached(s, approximate) or self._one(s, approximate)
            if done is not None:
                done()
        self._measured = measured
        used = {s.name: _key(clear_air(s) or s) for s in rig}
        moved = {n for n, m in self._measured.items() if before.get(n) is not m}
        self._stayed = {n: stayed.get(n) if n in moved else key for n, key in used.items()}
        kept = {*used.values(), *self._stayed.values()}
        self._clear = {k: self._clear[k] for k in self._clear if k in kept}
        self._occlusions = {k: v for k, v in self._occlusions.items() if k in kept}
        for kernel in self._kernels.values():
            kernel.keep_only(rig.sensors)

    def measure_again(self, sensor: Sensor) -> NDArray:
        """Measure one sensor exactly, cache the result, and return m (V,)."""
        measured = self._measured[sensor.name] = self._one(sensor, False)
        return measured.m

    def _one(self, sensor: Sensor, approximate: bool) -> Measured:
        """Measure a sensor; of one in a weather only what differs from clear air."""
        clear = clear_air(sensor) or sensor
        measured = self._clear.get(_key(clear))
        if measured is None or (measured.approximate and not approximate):
            measured = self._kernel(clear).measure(clear, approximate)
            self._clear[_key(clear)] = measured
        if clear is sensor:
            return measured
        return within_range(sensor, measured, self._voxels, self._measure_some)

    def _measure_some(self, sensor: Sensor, voxels: Voxels) -> NDArray:
        """Return m (V,) of a sensor on other voxels."""
        few = MeasurementCache(voxels, self._vehicle, self._saturation_count)
        return few._kernel(sensor).measure(sensor, False).m

    def cached(self, sensor: Sensor, approximate: bool) -> Measured | None:
        """Return the valid cached measurement of a sensor; without `approximate` an exact one."""
        for cached in (self._measured.get(sensor.name), self._clear.get(_key(sensor))):
            if cached is None or (cached.approximate and not approximate):
                continue
            one = cached.sensor
            if one.model is sensor.model and (one.curve, one.pose) == (sensor.curve, sensor.pose):
                return cached
        return None

    def unoccluded(self, sensor: Sensor) -> NDArray:
        """Return m (V,) of a sensor without the vehicle; it is not cached."""
        return self._kernel(sensor).unoccluded(sensor)

    def occlusion(self, sensor: Sensor) -> Occlusion:
        """Return how much of a sensor of the last rig the vehicle occludes.

        Weather that shortens a range to no less than the far end of the vehicle changes nothing.
        """
        clear = clear_air(sensor)
        key = _key(sensor if clear is None or not self._is_whole(sensor) else clear)
        if key not in self._occlusions:
            measured = self._measured[sensor.name]
            self._occlusions[key] = self._kernel(sensor).occlusion(measured)
        return self._occlusions[key]

    def _is_whole(self, sensor: Sensor) -> bool:
        """Whether the whole vehicle is in the range of a sensor of a kind with a range."""
        if self._vehicle is None:
            return True
        offsets = np.abs(np.asarray(self._vehicle.bounds) - np.asarray(sensor.pose.position))
        limit: float = sensor.model.max_range  # type: ignore[attr-defined]  # as in `within_range`
        return math.hypot(*offsets.max(axis=0)) <= limit

    def _kernel(self, sensor: Sensor) -> SampleKernel:
        kind, key = kind_of(sensor), (sensor.kind, sensor.curve)
        if key not in self._kernels:
            count = self._saturation_count(sensor.curve or kind.name)
            kernel = kind.on_sample(self._voxels, self._vehicle, count)
            kernel.share_cache(self._kernel_caches.setdefault(kind.name, kernel.cache))
            self._kernels[key] = kernel
        return self._kernels[key]


def _key(sensor: Sensor) -> Hashable:
    """Return what a measurement depends on."""
    return sensor.model, sensor.pose, sensor.curve


class ObjectMeasurementCache:
    """Measures rigs on a fixed set of objects.

    Parameters
    ----------
    objects : Objects
    vehicle : Vehicle, optional
    traffic : bool
        Whether the objects of a scene occlude each other.
    kernel_caches : dict, optional
        Caches of kernels by kind, shared by several of these on one vehicle.
    """

    def __init__(
        self,
        objects: Objects,
        vehicle: Vehicle | None = None,
        traffic: bool = False,
        kernel_caches: dict[str, Any] | None = None,
    ) -> None:
        self._view = ObjectView(objects, vehicle, traffic)
        self._kernel_caches = {} if kernel_caches is None else kernel_caches
        self._kernels: dict[str, ObjectKernel] = {}
        self._measured: dict[str, tuple[Sensor, Floats]] = {}

    def measure(self, sensors: Iterable[Sensor]) -> Mapping[str, Floats]:
        """Return m (N,) of the sensors of a rig, or of some of them, by name; read-only."""
        self._measured = {s.name: (s, self._one(s)) for s in sensors}
        for kernel in self._kernels.values():
            kernel.keep_only([s for s, _ in self._measured.values()])
        return MappingProxyType({name: m for name, (_, m) in self._measured.items()})

    def cached(self, sensor: Sensor) -> Floats | None:
        """Return the valid cached m (N,) of a sensor."""
        cached = self._measured.get(sensor.name)
        if cached and cached[0].model is sensor.model and cached[0].pose == sensor.pose:
            return cached[1]
        return None

    def measure_again(self, sensor: Sensor) -> Floats:
        """Measure one sensor, cache the result, and return m (N,)."""
        m = self._one(sensor)
        self._measured[sensor.name] = sensor, m
        return m

    def unoccluded(self, sensor: Sensor) -> Floats | None:
        """Return m (N,) of a sensor without occlusion, not cached; None where that saves no time.

        Nothing is saved by sensors whose objects are not occluded at all.
        """
        if self._view.vehicle is None and not self._view.traffic:
            return None
        return self._kernel(sensor).unoccluded(sensor)

    def _one(self, sensor: Sensor) -> Floats:
        cached = self.cached(sensor)
        if cached is not None:
            return cached
        m = self._measure(self._kernel(sensor), sensor)
        m.flags.writeable = False
        return m

    def _measure(self, kernel: ObjectKernel, sensor: Sensor) -> Floats:
        return kernel.measure(sensor)

    def _view_for(self, kind: Kind) -> ObjectView:
        return self._view

    def _kernel(self, sensor: Sensor) -> ObjectKernel:
        kind = kind_of(sensor)
        if kind.name not in self._kernels:
            kernel = self._kernels[kind.name] = kind.on_objects(self._view_for(kind))
            if kernel.cache is not None:
                kernel.share_cache(self._kernel_caches.setdefault(kind.name, kernel.cache))
        return self._kernels[kind.name]


class PartMeasurementCache(ObjectMeasurementCache):
    """Measures sensors that show parts of bodies on the cells of bodies.

    Parameters
    ----------
    parts : BodyParts
    vehicle : Vehicle, optional
    kernel_caches : dict, optional
        As of `ObjectMeasurementCache`.
    """

    def __init__(
        self,
        parts: BodyParts,
        vehicle: Vehicle | None = None,
        kernel_caches: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(parts.cells, vehicle, kernel_caches=kernel_caches)
        self._parts, self._whole = parts, ObjectView(parts.objects, vehicle)

    def _measure(self, kernel: ObjectKernel, sensor: Sensor) -> Floats:
        return kernel.measure_parts(sensor, self._parts)

    def _view_for(self, kind: Kind) -> ObjectView:
        return self._whole if kind.counts_points else self._view


class VisibleGroundCache:
    """Marks squares of the ground for rigs.

    Parameters
    ----------
    view : GroundView
    kernel_caches : dict
        Caches of kernels by kind, shared by several of these on one vehicle.
    """

    def __init__(self, view: GroundView, kernel_caches: dict[str, Any]) -> None:
        self.view, self._kernel_caches = view, kernel_caches
        self._kernels: dict[str, GroundKernel] = {}
        self._visible: dict[str, VisibleGround] = {}

    @property
    def by_sensor(self) -> dict[str, Flags]:
        """Squares (NX, NY) that each sensor of the last rig marks, by name."""
        return {name: visible.marked for name, visible in self._visible.items()}

    def marked(self, rig: Rig, approximate: bool = False) -> tuple[Flags, bool]:
        """Return squares (NX, NY) that any sensor marks, and whether any of it is approximate."""
        self._visible = {s.name: self._one(s, approximate) for s in rig}
        for kernel in self._kernels.values():
            kernel.keep_only(rig.sensors)
        marked = np.zeros(self.view.grid.shape, bool)
        for visible in self._visible.values():
            marked |= visible.marked
        return marked, any(visible.approximate for visible in self._visible.values())

    def _one(self, sensor: Sensor, approximate: bool) -> VisibleGround:
        cached = self._visible.get(sensor.name)
        if cached is not None and (approximate or not cached.approximate):
            same = cached.sensor.model is sensor.model and cached.sensor.pose == sensor.pose
            if same:
                return cached
        kind = kind_of(sensor)
        if kind.name not in self._kernels:
            kernel = self._kernels[kind.name] = kind.on_ground(self.view)
            kernel.share_cache(self._kernel_caches.setdefault(kind.name, kernel.cache))
        return self._kernels[kind.name].mark(sensor, approximate)

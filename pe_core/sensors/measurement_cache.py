"""Caches of measurements by sensor: a sensor that has not moved is not measured again.

Each cache keeps the sensors of the last rig, by name. There is one for voxels, one for objects and
one for squares of the ground.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..metric.entropy import ApCurve
from ..metric.fusion import CurveOf
from ..scene.objects import Objects
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from .ground_kernel import Flags, GroundKernel, GroundView, VisibleGround
from .kernels import Measured, Occlusion, SampleKernel, Voxels
from .kind import kind_of
from .object_kernel import ObjectKernel, ObjectView

Floats = NDArray[np.float64]


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

    @property
    def last(self) -> Mapping[str, Measured]:
        """Measurements of the last rig, by sensor."""
        return MappingProxyType(self._measured)

    @property
    def m(self) -> dict[str, NDArray]:
        """m (V,) of the sensors of the last rig."""
        return {name: measured.m for name, measured in self._measured.items()}

    def measure(self, rig: Rig, approximate: bool = False) -> None:
        """Measure the sensors that are not cached; without `approximate` exactly."""
        self._measured = {
            s.name: self.cached(s, approximate) or self._kernel(s).measure(s, approximate)
            for s in rig
        }
        for kernel in self._kernels.values():
            kernel.keep_only(rig.sensors)

    def measure_again(self, sensor: Sensor) -> NDArray:
        """Measure one sensor exactly, cache the result, and return m (V,)."""
        measured = self._measured[sensor.name] = self._kernel(sensor).measure(sensor, False)
        return measured.m

    def cached(self, sensor: Sensor, approximate: bool) -> Measured | None:
        """Return the valid cached measurement of a sensor; without `approximate` an exact one."""
        cached = self._measured.get(sensor.name)
        if cached is None or (cached.approximate and not approximate):
            return None
        before = cached.sensor
        same = before.model is sensor.model and before.curve == sensor.curve
        return cached if same and before.pose == sensor.pose else None

    def unoccluded(self, sensor: Sensor) -> NDArray:
        """Return m (V,) of a sensor without the vehicle; it is not cached."""
        return self._kernel(sensor).unoccluded(sensor)

    def occlusion(self, sensor: Sensor) -> Occlusion:
        """Return how much of a sensor of the last rig the vehicle occludes."""
        return self._kernel(sensor).occlusion(self._measured[sensor.name])

    def _kernel(self, sensor: Sensor) -> SampleKernel:
        kind, key = kind_of(sensor), (sensor.kind, sensor.curve)
        if key not in self._kernels:
            count = self._saturation_count(sensor.curve or kind.name)
            kernel = kind.on_sample(self._voxels, self._vehicle, count)
            kernel.share_cache(self._kernel_caches.setdefault(kind.name, kernel.cache))
            self._kernels[key] = kernel
        return self._kernels[key]


class ObjectMeasurementCache:
    """Measures rigs on a fixed set of objects.

    Parameters
    ----------
    objects : Objects
    vehicle : Vehicle, optional
    traffic : bool
        Whether the objects of a scene occlude each other.
    """

    def __init__(
        self, objects: Objects, vehicle: Vehicle | None = None, traffic: bool = False
    ) -> None:
        self._view = ObjectView(objects, vehicle, traffic)
        self._kernels: dict[str, ObjectKernel] = {}
        self._measured: dict[str, tuple[Sensor, Floats]] = {}

    def measure(self, rig: Rig) -> Mapping[str, Floats]:
        """Return m (N,) of the sensors of a rig, by name; read-only."""
        self._measured = {s.name: (s, self._one(s)) for s in rig}
        for kernel in self._kernels.values():
            kernel.keep_only(rig.sensors)
        return MappingProxyType({name: m for name, (_, m) in self._measured.items()})

    def _one(self, sensor: Sensor) -> Floats:
        cached = self._measured.get(sensor.name)
        if cached and cached[0].model is sensor.model and cached[0].pose == sensor.pose:
            return cached[1]
        kind = kind_of(sensor)
        if kind.name not in self._kernels:
            self._kernels[kind.name] = kind.on_objects(self._view)
        m = self._kernels[kind.name].measure(sensor)
        m.flags.writeable = False
        return m


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

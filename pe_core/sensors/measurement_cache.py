"""Caches of measurements by sensor: a sensor that has not moved is not measured again.

Each cache keeps the sensors of the last rig, by name. There is one for voxels, one for objects and
parts of bodies, and one for squares of the ground.

m of a sensor whose range was `limited` is its m at whole range for all voxels within the shorter
range, 0 beyond it, and counted again on the few voxels that the range cuts: a sensor is measured
once for all its ranges, and the numbers are those of measuring it anew.
"""

import math
from collections.abc import Callable, Hashable, Iterable, Mapping
from functools import reduce
from types import MappingProxyType
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Flags, Floats
from ..metric.entropy import CurveOf
from ..scene.objects import Objects
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from .boxes import BodyParts
from .field_of_view import at_whole_range
from .kernels import (
    CachingKernel,
    GroundKernel,
    GroundView,
    Measured,
    ObjectKernel,
    ObjectView,
    Occlusion,
    SampleKernel,
    Voxels,
)
from .kind import kind_of

K = TypeVar("K", bound=CachingKernel)

MARGIN = 1e-6  # Of half a voxel's diagonal, for rounding


class _Kernels(Generic[K]):
    """Kernels of the kinds of sensors, made by `make`. `caches` are those of kernels by kind,
    shared by all kernels on one vehicle."""

    def __init__(self, make: Callable[[Sensor], K], caches: dict[str, Any] | None) -> None:
        self._make = make
        self._caches = {} if caches is None else caches
        self._by_key: dict[Hashable, K] = {}

    def kernel_of(self, sensor: Sensor, key: Hashable = None) -> K:
        """Return the kernel of a sensor's kind, and of one more key."""
        found = self._by_key.get((sensor.kind, key))
        if found is None:
            found = self._by_key[sensor.kind, key] = self._make(sensor)
            if found.cache is not None:
                found.cache = self._caches.setdefault(sensor.kind, found.cache)
        return found

    def keep_only(self, sensors: Iterable[Sensor]) -> None:
        """Remove all other sensors from the kernels."""
        kept = tuple(sensors)
        for kernel in self._by_key.values():
            kernel.keep_only(kept)


class MeasurementCache:
    """Measures rigs on a fixed set of voxels.

    `saturation_count`: The integer m from which AP is at its maximum, by kind or AP curve.
    `kernel_caches`: Caches of kernels by kind, shared by several of these on one vehicle.
    """

    def __init__(
        self,
        voxels: Voxels,
        vehicle: Vehicle | None,
        saturation_count: Callable[[CurveOf], int],
        kernel_caches: dict[str, Any] | None = None,
    ) -> None:
        self._voxels = voxels
        self._vehicle = vehicle
        self._saturation_count = saturation_count
        self._kernels = _Kernels(self._new_kernel, kernel_caches)
        self._measured: dict[str, Measured] = {}
        self._whole: dict[Hashable, Measured] = {}  # at whole range: the last rig's, `_stayed`'s
        self._occlusions: dict[Hashable, Occlusion] = {}
        self._stayed: dict[str, Hashable] = {}  # where each sensor last was for two rigs in a row

    @property
    def m(self) -> dict[str, NDArray]:
        """m (V,) of the sensors of the last rig."""
        return {name: measured.m for name, measured in self._measured.items()}

    def measure(self, rig: Rig, done: Callable[[], None] | None = None) -> None:
        """Measure the sensors that are not cached.

        `done` is called after each sensor; if it raises, the cache stays as it was.
        """
        before = self._measured
        stayed = self._stayed
        measured = {}
        for s in rig:
            measured[s.name] = self.cached(s) or self._one(s)
            if done is not None:
                done()
        self._measured = measured
        used = {s.name: _key(at_whole_range(s)) for s in rig}
        moved = {n for n, m in self._measured.items() if before.get(n) is not m}
        self._stayed = {n: stayed.get(n) if n in moved else key for n, key in used.items()}
        kept = {*used.values(), *self._stayed.values()}
        self._whole = {k: self._whole[k] for k in self._whole if k in kept}
        self._occlusions = {k: v for k, v in self._occlusions.items() if k in kept}
        self._kernels.keep_only(rig)

    def _one(self, sensor: Sensor) -> Measured:
        """Measure a sensor; of one with a limited range only what differs from the whole one."""
        whole = at_whole_range(sensor)
        measured = self._whole.get(_key(whole))
        if measured is None:
            measured = self._kernel(whole).measure(whole)
            self._whole[_key(whole)] = measured
        return measured if whole is sensor else self._within_range(sensor, measured)

    def _within_range(self, sensor: Sensor, whole: Measured) -> Measured:
        """Return the measurement of a sensor with a limited range, of that at whole range."""
        limit: float = sensor.model.max_range  # type: ignore[attr-defined]  # of kinds with a range
        voxels = self._voxels
        offset = voxels.centers - np.asarray(sensor.pose.position)
        square = offset[:, 0] ** 2 + offset[:, 1] ** 2 + offset[:, 2] ** 2
        half = voxels.space.interval * math.sqrt(3.0) / 2.0 * (1.0 + MARGIN) + MARGIN
        m = np.where(square <= (limit + half) ** 2, whole.m, whole.m.dtype.type(0))
        low = max(limit - half, 0.0)
        cut = np.flatnonzero((square >= low * low) & (m > 0))
        if len(cut):
            some = Voxels(voxels.space, voxels.index[cut], voxels.centers[cut])
            few = MeasurementCache(some, self._vehicle, self._saturation_count)
            m[cut] = few._kernel(sensor).measure(sensor).m[: len(cut)]
            m[cut] = np.where(square[cut] <= (limit + half) ** 2, m[cut], 0)
        return Measured(sensor, m, whole.kernel_data)

    def cached(self, sensor: Sensor) -> Measured | None:
        """Return the valid cached measurement of a sensor."""
        for cached in (self._measured.get(sensor.name), self._whole.get(_key(sensor))):
            if cached is None:
                continue
            if cached.sensor.measures_as(sensor) and cached.sensor.curve == sensor.curve:
                return cached
        return None

    def occlusion(self, sensor: Sensor) -> Occlusion:
        """Return how much of a sensor of the last rig the vehicle occludes. A range that is limited
        to no less than the far end of the vehicle changes nothing."""
        whole = at_whole_range(sensor)
        if whole is not sensor and self._vehicle is not None:
            far = np.abs(np.asarray(self._vehicle.bounds) - np.asarray(sensor.pose.position))
            limit: float = sensor.model.max_range  # type: ignore[attr-defined]
            whole = whole if math.hypot(*far.max(axis=0)) <= limit else sensor
        key = _key(whole)
        if key not in self._occlusions:
            measured = self._measured[sensor.name]
            self._occlusions[key] = self._kernel(sensor).occlusion(measured)
        return self._occlusions[key]

    def _kernel(self, sensor: Sensor) -> SampleKernel:
        return self._kernels.kernel_of(sensor, sensor.curve)

    def _new_kernel(self, sensor: Sensor) -> SampleKernel:
        count = self._saturation_count(sensor.detector)
        return kind_of(sensor).on_sample(self._voxels, self._vehicle, count)


def _key(sensor: Sensor) -> Hashable:
    """Return what a measurement depends on."""
    return sensor.model, sensor.pose, sensor.curve


class ObjectMeasurementCache:
    """Measures rigs on a fixed set of objects, or on the cells of bodies.

    `objects`: Of parts of bodies the sensors have to show parts: `Kind.shows_parts`.
    `traffic`: Whether the objects of a scene occlude each other.
    `kernel_caches`: Caches of kernels by kind, shared by several of these on one vehicle.
    """

    def __init__(
        self,
        objects: Objects | BodyParts,
        vehicle: Vehicle | None = None,
        traffic: bool = False,
        kernel_caches: dict[str, Any] | None = None,
    ) -> None:
        self._parts = objects if isinstance(objects, BodyParts) else None
        measured = objects.cells if isinstance(objects, BodyParts) else objects
        self._view = ObjectView(measured, vehicle, traffic)
        self._kernels = _Kernels(self._new_kernel, kernel_caches)
        self._measured: dict[str, tuple[Sensor, Floats]] = {}

    def measure(self, sensors: Iterable[Sensor]) -> Mapping[str, Floats]:
        """Return m (N,) of the sensors of a rig, or of some of them, by name; read-only."""
        self._measured = {s.name: (s, self._one(s)) for s in sensors}
        self._kernels.keep_only([s for s, _ in self._measured.values()])
        return MappingProxyType({name: m for name, (_, m) in self._measured.items()})

    def cached(self, sensor: Sensor) -> Floats | None:
        """Return the valid cached m (N,) of a sensor."""
        cached = self._measured.get(sensor.name)
        return cached[1] if cached and sensor.measures_as(cached[0]) else None

    def measure_again(self, sensor: Sensor) -> Floats:
        """Measure one sensor, cache the result, and return m (N,)."""
        m = self._one(sensor)
        self._measured[sensor.name] = sensor, m
        return m

    def _one(self, sensor: Sensor) -> Floats:
        cached = self.cached(sensor)
        if cached is not None:
            return cached
        kernel = self._kernels.kernel_of(sensor)
        parts = self._parts
        m = kernel.measure(sensor) if parts is None else kernel.measure_parts(sensor, parts)
        m.flags.writeable = False
        return m

    def _new_kernel(self, sensor: Sensor) -> ObjectKernel:
        kind = kind_of(sensor)
        view = self._view
        if self._parts is not None and kind.counts_points:
            view = ObjectView(self._parts.objects, view.vehicle)
        return kind.on_objects(view)


class VisibleGroundCache:
    """Marks squares of the ground for rigs. `kernel_caches`: Caches of kernels by kind, shared by
    several of these on one vehicle."""

    def __init__(self, view: GroundView, kernel_caches: dict[str, Any]) -> None:
        self.view = view
        self._kernels: _Kernels[GroundKernel] = _Kernels(
            lambda sensor: kind_of(sensor).on_ground(view), kernel_caches
        )
        self._visible: dict[str, tuple[Sensor, NDArray[np.uint8]]] = {}
        """Sensors of the last rig and what they mark, by name: eight squares a byte."""

    @property
    def by_sensor(self) -> dict[str, Flags]:
        """Squares (NX, NY) that each sensor of the last rig marks, by name."""
        return {name: self._unpacked(bits) for name, (_, bits) in self._visible.items()}

    def marked(self, rig: Rig) -> Flags:
        """Return squares (NX, NY) that any sensor marks."""
        self._visible = {s.name: (s, self._one(s)) for s in rig}
        self._kernels.keep_only(rig)
        return self._unpacked(reduce(np.bitwise_or, (bits for _, bits in self._visible.values())))

    def _unpacked(self, bits: NDArray[np.uint8]) -> Flags:
        nx, ny = self.view.grid.shape
        return np.unpackbits(bits, count=nx * ny).reshape(nx, ny).view(bool)

    def _one(self, sensor: Sensor) -> NDArray[np.uint8]:
        cached = self._visible.get(sensor.name)
        if cached is not None and sensor.measures_as(cached[0]):
            return cached[1]
        return np.packbits(self._kernels.kernel_of(sensor).mark(sensor).marked)

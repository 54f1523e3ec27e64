"""Voxel kernels: measure the sensors of one kind on the whole grid, or on a sample of voxels.

`GridKernel` and `SampleKernel` are the interfaces for scoring. `DefinedGrid` and `DefinedSample`
implement them with the definition of m alone, for kinds without fast kernels.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial, reduce
from operator import add
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..geometry.grids import PerceptionSpace
from ..metric.fusion import VisibleRows
from ..scene.rig import Sensor
from ..scene.vehicle import Vehicle

Planes = Callable[[slice], NDArray | VisibleRows]
"""m of a fusion group on n consecutive x-planes: integers (n, ny, nz), or the visible rows."""

BLOCK_PLANES = 32
"""x-planes that a thread measures at a time."""


@dataclass(frozen=True, slots=True)
class Voxels:
    """Some voxels of a space: `index` (V, 3) and `centers` (V, 3) [m]."""

    space: PerceptionSpace
    index: NDArray[np.int64]
    centers: Floats


@dataclass(frozen=True, slots=True)
class Occlusion:
    """Rays of a sensor (beams, or places of a picture), and how many of them the vehicle occludes.

    `by_part` counts these by part of the vehicle, in descending order.
    """

    rays: int = 0
    occluded: int = 0
    by_part: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Measured:
    """The measurement of a sensor on a sample of voxels.

    Attributes
    ----------
    sensor : Sensor
    m : (V,) int or float
    approximate : bool
        Whether the occlusion by the vehicle is approximate.
    kernel_data : object
        Intermediate results that the kernel uses again.
    """

    sensor: Sensor
    m: NDArray
    approximate: bool = False
    kernel_data: Any = None


class GridKernel(ABC):
    """Measures sensors of one kind on all voxels of a space, in blocks of x-planes."""

    @abstractmethod
    def prepare(self, sensor: Sensor) -> Any:
        """Compute what does not depend on the voxels; called in threads."""

    @abstractmethod
    def planes(self, groups: Sequence[Sequence[Any]], pool: Executor) -> list[Planes]:
        """Return a function of a block of planes for each group: the sum over its sensors (eq. 6).

        `groups` holds results of `prepare`. The functions are valid until the next call.
        """

    def occlusion(self, prepared: Any) -> Occlusion:
        """Return how much of a prepared sensor the vehicle occludes."""
        return Occlusion()

    def memory_bytes(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Estimate the memory for measuring these groups with so many threads."""
        return len(groups) * workers * block_voxels(space) * np.dtype(float).itemsize


def block_voxels(space: PerceptionSpace) -> int:
    """Return how many voxels a thread measures at a time."""
    nx, ny, nz = space.shape
    return min(nx, BLOCK_PLANES) * ny * nz


class CachingKernel:
    """A kernel of one kind of sensors with a `cache` of what does not depend on its targets.

    Kernels of the same kind and vehicle may share it.
    """

    cache: Any = None

    def share_cache(self, cache: Any) -> None:
        """Use the cache of another kernel of this kind."""
        self.cache = cache

    def keep_only(self, sensors: Collection[Sensor]) -> None:
        """Remove all other sensors from the caches."""
        if self.cache is not None:
            self.cache.keep_only(sensors)


class SampleKernel(CachingKernel, ABC):
    """Measures sensors of one kind on a fixed sample of voxels."""

    @abstractmethod
    def measure(self, sensor: Sensor, approximate: bool) -> Measured:
        """Measure a sensor; with `approximate` occlusion may be approximate, if that is faster."""

    @abstractmethod
    def unoccluded(self, sensor: Sensor) -> NDArray:
        """Return m (V,) without the vehicle: an upper bound of m."""

    def occlusion(self, measured: Measured) -> Occlusion:
        """Return how much of a measured sensor the vehicle occludes."""
        return Occlusion()


Definition = Callable[[Sensor, Floats, float, Vehicle | None], Floats]


class DefinedGrid(GridKernel):
    """Measures blocks of x-planes by the definition of m."""

    def __init__(
        self, measure: Definition, space: PerceptionSpace, vehicle: Vehicle | None
    ) -> None:
        self._measure, self._space, self._vehicle = measure, space, vehicle

    def prepare(self, sensor: Sensor) -> Sensor:
        """Return the sensor: there is nothing to prepare."""
        return sensor

    def planes(self, groups: Sequence[Sequence[Sensor]], pool: Executor) -> list[Planes]:
        """Return functions that measure a block by the definition."""
        return [partial(self._sum, sensors) for sensors in groups]

    def _sum(self, sensors: Sequence[Sensor], planes: slice) -> VisibleRows:
        (n, ny, nz), centers = self._shape(planes), self._centers(planes)
        side = self._space.interval
        m = reduce(add, (self._measure(s, centers, side, self._vehicle) for s in sensors))
        return VisibleRows(slice(0, ny), np.asarray(m, dtype=float).reshape(n, ny, nz))

    def _shape(self, planes: slice) -> tuple[int, int, int]:
        _, ny, nz = self._space.shape
        return planes.stop - planes.start, ny, nz

    def _centers(self, planes: slice) -> Floats:
        axes = (self._space.centers(0)[planes], self._space.centers(1), self._space.centers(2))
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


class DefinedSample(SampleKernel):
    """Measures sampled voxels by the definition of m."""

    def __init__(self, measure: Definition, voxels: Voxels, vehicle: Vehicle | None) -> None:
        self._measure, self._voxels, self._vehicle = measure, voxels, vehicle

    def measure(self, sensor: Sensor, approximate: bool) -> Measured:
        """Measure a sensor, always exactly."""
        return Measured(sensor, self._by_definition(sensor, self._vehicle))

    def unoccluded(self, sensor: Sensor) -> NDArray:
        """Return m without the vehicle."""
        return self._by_definition(sensor, None)

    def _by_definition(self, sensor: Sensor, vehicle: Vehicle | None) -> NDArray:
        side = self._voxels.space.interval
        return np.asarray(self._measure(sensor, self._voxels.centers, side, vehicle), dtype=float)

"""Kernels for kinds that have none of their own: every voxel by the definition."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from functools import partial, reduce
from operator import add

import numpy as np
from numpy.typing import NDArray

from ..metric.planes import SeenRows
from ..scene.sensors import Sensor
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .kernels import Floats, GridKernel, Measured, Planes, SampleKernel, Voxels

Definition = Callable[[Sensor, Floats, float, Vehicle | None], Floats]


class DefinedGrid(GridKernel):
    """Measures x-planes by a definition of m."""

    def __init__(
        self, measure: Definition, space: PerceptionSpace, vehicle: Vehicle | None
    ) -> None:
        self._measure, self._space, self._vehicle = measure, space, vehicle

    def ready(self, sensor: Sensor) -> Sensor:
        """Nothing is worked out before."""
        return sensor

    def planes(self, groups: Sequence[Sequence[Sensor]], pool: Executor) -> list[Planes]:
        """Measure each group when its planes are asked for."""
        return [partial(self._sum, sensors) for sensors in groups]

    def _sum(self, sensors: Sequence[Sensor], planes: slice) -> SeenRows:
        (n, ny, nz), centers = self._shape(planes), self._centers(planes)
        side = self._space.interval
        m = reduce(add, (self._measure(s, centers, side, self._vehicle) for s in sensors))
        return SeenRows(slice(0, ny), np.asarray(m, dtype=float).reshape(n, ny, nz))

    def _shape(self, planes: slice) -> tuple[int, int, int]:
        _, ny, nz = self._space.shape
        return planes.stop - planes.start, ny, nz

    def _centers(self, planes: slice) -> Floats:
        axes = (self._space.centers(0)[planes], self._space.centers(1), self._space.centers(2))
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


class DefinedSample(SampleKernel):
    """Measures sampled voxels by a definition of m."""

    def __init__(self, measure: Definition, voxels: Voxels, vehicle: Vehicle | None) -> None:
        self._measure, self._voxels, self._vehicle = measure, voxels, vehicle

    def measure(self, sensor: Sensor, draft: bool) -> Measured:
        """Measure a sensor; there are no drafts."""
        return Measured(sensor, self._by_definition(sensor, self._vehicle))

    def unhidden(self, sensor: Sensor) -> NDArray:
        """Measure a sensor without the vehicle."""
        return self._by_definition(sensor, None)

    def _by_definition(self, sensor: Sensor, vehicle: Vehicle | None) -> NDArray:
        side = self._voxels.space.interval
        return np.asarray(self._measure(sensor, self._voxels.centers, side, vehicle), dtype=float)

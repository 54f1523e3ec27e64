"""Kernels: measure the sensors of one kind on voxels, on squares of the ground, and on objects.

`GridKernel`, `SampleKernel`, `GroundKernel` and `ObjectKernel` are the interfaces for scoring. The
kernels of `Defined...` implement them by the definition of m alone, for kinds without fast ones.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial, reduce
from operator import add
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Flags, Floats, Ints
from ..geometry.grids import GroundGrid, PerceptionSpace
from ..metric.fusion import VisibleRows
from ..scene.objects import Objects
from ..scene.rig import Sensor
from ..scene.vehicle import Vehicle
from .boxes import BodyParts

Planes = Callable[[slice], NDArray | VisibleRows]
"""m of a fusion group on n consecutive x-planes: integers (n, ny, nz), or the visible rows."""
Definition = Callable[[Sensor, Floats, float, Vehicle | None], Floats]
ObjectDefinition = Callable[[Sensor, Objects, Vehicle | None, bool], Floats]

BLOCK_PLANES = 32
"""x-planes that a thread measures at a time."""
HEIGHT_STEP_M = 0.1
"""Distance of the points of a post that are tested; its foot and its top are among them [m]."""
FLAT_M = 1e-3
"""Side of the cubes that stand for posts of height 0, for kinds with a definition only [m]."""


@dataclass(frozen=True, slots=True)
class Voxels:
    """Some voxels of a space: `index` (V, 3) and `centers` (V, 3) [m]."""

    space: PerceptionSpace
    index: Ints
    centers: Floats


@dataclass(frozen=True, slots=True)
class Occlusion:
    """Rays of a sensor (beams, or places of a picture), and how many of them the vehicle occludes.
    `by_part` counts these by part of the vehicle, in descending order."""

    rays: int = 0
    occluded: int = 0
    by_part: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Measured:
    """The measurement m (V,) of a sensor on a sample of voxels. The kernel uses `kernel_data`
    again."""

    sensor: Sensor
    m: NDArray
    kernel_data: Any = None


@dataclass(frozen=True, slots=True)
class GroundView:
    """Squares of the ground, the height of posts on them [m], and the vehicle. With a `ring`, inner
    and outer radius about the origin [m], squares that are elsewhere may be left unmarked."""

    grid: GroundGrid
    height: float
    vehicle: Vehicle | None = None
    ring: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class VisibleGround:
    """Squares `marked` (NX, NY) for a sensor."""

    sensor: Sensor
    marked: Flags


@dataclass(frozen=True, slots=True)
class ObjectView:
    """Objects, the vehicle, and whether the objects of a scene occlude each other."""

    objects: Objects
    vehicle: Vehicle | None = None
    traffic: bool = False


class GridKernel:
    """Measures sensors of one kind on all voxels of a space, in blocks of x-planes. A kind has
    `rows`, or `planes` if it measures all planes at once."""

    def prepare(self, sensor: Sensor) -> Any:
        """Compute what does not depend on the voxels; called in threads."""
        return sensor

    def planes(self, groups: Sequence[Sequence[Any]], pool: Executor) -> list[Planes]:
        """Return a function of a block of planes for each group: the sum over its sensors (eq. 6).
        `groups` holds results of `prepare`. The functions are valid until the next call."""

        def measured(group: Sequence[Any], planes: slice) -> VisibleRows:
            return reduce(add, (self.rows(one, planes) for one in group))

        return [partial(measured, group) for group in groups]

    def rows(self, prepared: Any, planes: slice) -> VisibleRows:
        """Measure one prepared sensor on a block of planes."""
        raise NotImplementedError

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
    Kernels of the same kind and vehicle may share it."""

    cache: Any = None

    def keep_only(self, sensors: Collection[Sensor]) -> None:
        """Remove all other sensors from the caches."""
        if self.cache is not None:
            self.cache.keep_only(sensors)


class SampleKernel(CachingKernel, ABC):
    """Measures sensors of one kind on a fixed sample of voxels."""

    @abstractmethod
    def measure(self, sensor: Sensor) -> Measured:
        """Measure a sensor."""

    def occlusion(self, measured: Measured) -> Occlusion:
        """Return how much of a measured sensor the vehicle occludes."""
        return Occlusion()


class GroundKernel(CachingKernel, ABC):
    """Marks squares of one grid in which sensors of one kind surely see an upright post.

    A post stands for any thin object; it reaches from the ground to a given height. A square is
    marked if a post somewhere in it is surely visible: a beam hits it, or a line of sight reaches a
    point of it. In a square that is not marked a post may be visible or not: kernels may mark too
    few squares, never too many.
    """

    @abstractmethod
    def mark(self, sensor: Sensor) -> VisibleGround:
        """Mark squares."""


class ObjectKernel(CachingKernel, ABC):
    """Measures sensors of one kind on a fixed set of objects."""

    @abstractmethod
    def measure(self, sensor: Sensor) -> Floats:
        """Return m (N,) of a sensor, equal to the definition of its kind."""

    def measure_parts(self, sensor: Sensor, parts: BodyParts) -> Floats:
        """Return m (N,) of the cells of bodies, equal to `Kind.measure_parts`; else `measure`."""
        return self.measure(sensor)


class DefinedGrid(GridKernel):
    """Measures blocks of x-planes by the definition of m."""

    def __init__(
        self, measure: Definition, space: PerceptionSpace, vehicle: Vehicle | None, _: int = 0
    ) -> None:
        self._measure = measure
        self._space = space
        self._vehicle = vehicle

    def rows(self, prepared: Sensor, planes: slice) -> VisibleRows:
        """Measure a block by the definition."""
        space = self._space
        x = space.centers(0)[planes]
        y = space.centers(1)
        z = space.centers(2)
        centers = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
        m = np.asarray(self._measure(prepared, centers, space.interval, self._vehicle), dtype=float)
        return VisibleRows(slice(0, len(y)), m.reshape(len(x), len(y), len(z)))


class DefinedSample(SampleKernel):
    """Measures sampled voxels by the definition of m, or by a faster function that equals it."""

    def __init__(
        self,
        measure: Definition,
        voxels: Voxels,
        vehicle: Vehicle | None,
        _: int = 0,
        occlusion: Callable[[Sensor, Vehicle | None], Occlusion] = lambda *_: Occlusion(),
    ) -> None:
        self._measure = measure
        self._vehicle = vehicle
        self._occlusion = occlusion
        self._side = voxels.space.interval
        self._centers = np.asfortranarray(voxels.centers)  # fast for arithmetic axis by axis

    def measure(self, sensor: Sensor) -> Measured:
        """Measure a sensor."""
        return Measured(sensor, self._measure(sensor, self._centers, self._side, self._vehicle))

    def occlusion(self, measured: Measured) -> Occlusion:
        """Return how much of a measured sensor the vehicle occludes, if the kind knows it."""
        return self._occlusion(measured.sensor, self._vehicle)


class DefinedGround(GroundKernel):
    """Marks squares by the definition of m, of small cubes in the middle of the squares."""

    def __init__(self, measure: Definition, view: GroundView) -> None:
        self._measure = measure
        self._view = view

    def mark(self, sensor: Sensor) -> VisibleGround:
        """Measure small cubes, at steps of `HEIGHT_STEP_M` over the height of the posts."""
        grid = self._view.grid
        height = self._view.height
        side = min(grid.step, height) or FLAT_M
        marked = np.zeros(grid.shape[0] * grid.shape[1], bool)
        middles = grid.middles(np.arange(len(marked)))
        for z in heights_of_post(max(height - side, 0.0)):
            left = np.flatnonzero(~marked)
            centers = np.column_stack([middles[left], np.full(len(left), z + side / 2.0)])
            marked[left] = self._measure(sensor, centers, side, self._view.vehicle) > 0
        return VisibleGround(sensor, marked.reshape(grid.shape))


def heights_of_post(height: float) -> Floats:
    """Return heights (Z,) at which a post is tested: its top, its foot, and between them [m]."""
    steps = int(np.ceil(height / HEIGHT_STEP_M - 1e-9))
    between = [height * k / steps for k in range(1, steps)]
    return np.array([height, *([0.0] if height else []), *between])


class DefinedObjects(ObjectKernel):
    """Measures objects by the definition of m."""

    def __init__(self, measure: ObjectDefinition, view: ObjectView) -> None:
        self._measure = measure
        self._view = view

    def measure(self, sensor: Sensor) -> Floats:
        """Return m (N,) by the definition."""
        view = self._view
        m = self._measure(sensor, view.objects, view.vehicle, view.traffic)
        return np.asarray(m, dtype=float)

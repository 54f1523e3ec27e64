"""What scoring asks of a kind's kernels: sensors measured on the grid, and on a sample."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..metric.planes import SeenRows
from ..scene.sensors import Sensor
from ..scene.space import PerceptionSpace

Floats = NDArray[np.float64]
Planes = Callable[[slice], NDArray | SeenRows]
"""m of a fusion group on a run of x-planes: whole numbers (n, ny, nz), or the rows it sees."""


BLOCK_PLANES = 32
"""x-planes a thread takes at a time; the exact areas of a camera are worked out together."""


@dataclass(frozen=True, slots=True)
class Voxels:
    """Some voxels of a space: `index` (V, 3) and `centers` (V, 3) [m]."""

    space: PerceptionSpace
    index: NDArray[np.int64]
    centers: Floats


@dataclass(frozen=True, slots=True)
class Stopped:
    """Of a sensor's beams, how many the vehicle stops, and by which part, most first."""

    beams: int = 0
    stopped: int = 0
    by_part: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Measured:
    """A sensor as it was measured on a sample.

    `m` (V,) whole numbers or not; `draft` whether the vehicle's part in it is one; `found` what the
    kernel has worked out besides, for itself.
    """

    sensor: Sensor
    m: NDArray
    draft: bool = False
    found: Any = None


class GridKernel(ABC):
    """Measures sensors of one kind on all voxels of a space, some x-planes at a time."""

    @abstractmethod
    def ready(self, sensor: Sensor) -> Any:
        """Work out what is needed of a sensor once; called in threads."""

    @abstractmethod
    def planes(self, groups: Sequence[Sequence[Any]], pool: Executor) -> list[Planes]:
        """Return what measures each group of sensors that are `ready`, summed; eq. 6.

        Good until the next call.
        """

    def stopped(self, ready: Any) -> Stopped:
        """Say what the vehicle stops of a sensor that is `ready`."""
        return Stopped()

    def needs(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Return about how many bytes measuring these groups takes, so many threads at work."""
        return len(groups) * workers * block_voxels(space) * np.dtype(float).itemsize


def block_voxels(space: PerceptionSpace) -> int:
    """Return how many voxels a thread has at a time."""
    nx, ny, nz = space.shape
    return min(nx, BLOCK_PLANES) * ny * nz


class SampleKernel(ABC):
    """Measures sensors of one kind on a fixed sample of voxels.

    `known` is what it has worked out of sensors and of the vehicle, whatever the voxels: kernels of
    its kind for other voxels of the space may `share` it.
    """

    known: Any = None

    @abstractmethod
    def measure(self, sensor: Sensor, draft: bool) -> Measured:
        """Measure a sensor; as a draft where that is asked for and there is a quicker way."""

    @abstractmethod
    def unhidden(self, sensor: Sensor) -> NDArray:
        """Measure a sensor as if there were no vehicle: m is nowhere below the true one."""

    def stopped(self, measured: Measured) -> Stopped:
        """Say what the vehicle stops of a sensor that was measured."""
        return Stopped()

    def share(self, known: Any) -> None:
        """Use what another kernel of this kind knows, from now on together."""
        return

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep nothing of other sensors than these."""
        return

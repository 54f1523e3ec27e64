"""LiDARs on the grid: their beams cast, and counted in every voxel."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.numbering import blocks
from ...scene.sensors import Sensor
from ...scene.space import PerceptionSpace
from ...scene.vehicle import Vehicle
from ..kernels import BLOCK_PLANES, GridKernel, Planes, Stopped
from .beams import BeamField, beam_field, stopped_beams
from .grid import BeamGrid
from .model import Lidar


@dataclass(frozen=True, slots=True)
class CastLidar:
    """A LiDAR with its beams cast."""

    sensor: Sensor
    field: BeamField


class LidarGrid(GridKernel):
    """Counts beams through all voxels of a space."""

    def __init__(self, space: PerceptionSpace, vehicle: Vehicle | None, enough: int) -> None:
        self._space, self._vehicle, self._enough = space, vehicle, enough

    @cached_property
    def _grid(self) -> BeamGrid:
        return BeamGrid(self._space)  # kept: a new one is slow to touch for the first time

    def ready(self, sensor: Sensor) -> CastLidar:
        """Cast the beams."""
        return CastLidar(sensor, beam_field(sensor, self._vehicle))

    def stopped(self, ready: CastLidar) -> Stopped:
        """Count the beams that the vehicle stops."""
        return stopped_beams(ready.field, self._vehicle)

    def planes(self, groups: Sequence[Sequence[CastLidar]], pool: Executor) -> list[Planes]:
        """Count each group's beams on the whole grid, now; several groups are kept small."""
        found: list[Planes] = []
        for sensors in groups:
            self._grid.clear()
            for own in sensors:
                nearest = cast(Lidar, own.sensor.model).min_range
                place, field = own.sensor.pose.position, own.field
                self._grid.add(place, field.directions, field.ends, nearest)
            counts = self._grid.counts
            kept = counts if len(groups) == 1 else compact(counts, self._enough, pool)
            found.append(kept.__getitem__)
        return found


def compact(counts: NDArray[np.uint16], enough: int, pool: Executor | None = None) -> NDArray:
    """Copy beam counts, into one byte where `enough` fits one: as good for any entropy."""
    small = enough <= np.iinfo(np.uint8).max
    kept = np.empty(counts.shape, np.uint8 if small else counts.dtype)

    def work(planes: slice) -> None:
        for i in range(planes.start, planes.stop):
            kept[i] = np.minimum(counts[i], enough) if small else counts[i]

    list((pool.map if pool else map)(work, blocks(len(counts), BLOCK_PLANES)))
    return kept

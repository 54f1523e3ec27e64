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
from ..kernels import BLOCK_PLANES, GridKernel, Planes, Stopped, block_voxels
from .beams import BeamField, beam_field, stopped_beams
from .grid import BeamGrid
from .model import Lidar

MANY, HALF_BYTE = 2, 15
"""More groups of LiDARs than this are kept in half bytes, where AP is saturated by that count."""


BEAM_BYTES = 100
"""Of a beam that is cast (measured): its direction, its end, what it meets."""


@dataclass(frozen=True, slots=True)
class CastLidar:
    """A LiDAR with its beams cast."""

    sensor: Sensor
    field: BeamField


@dataclass(frozen=True, slots=True)
class HalfBytes:
    """Counts (nx, ny, nz) of at most `HALF_BYTE`, two to a byte: of two rows half a side apart.

    Half the memory of `compact`, for which they are unpacked whenever they are looked at.
    """

    packed: NDArray[np.uint8]
    rows: int

    @classmethod
    def of(cls, counts: NDArray[np.uint16], enough: int, pool: Executor | None = None) -> HalfBytes:
        """Pack counts, those beyond `enough` as that."""
        nx, rows, nz = counts.shape
        half = (rows + 1) // 2
        packed = np.empty((nx, half, nz), np.uint8)

        def work(planes: slice) -> None:
            for i in range(planes.start, planes.stop):
                small = np.minimum(counts[i], enough).astype(np.uint8)
                packed[i] = small[:half]
                packed[i, : rows - half] |= small[half:] << 4

        list((pool.map if pool else map)(work, blocks(nx, BLOCK_PLANES)))
        return cls(packed, rows)

    def __getitem__(self, planes: slice) -> NDArray[np.uint8]:
        """Counts of some planes, one to a byte."""
        some = self.packed[planes]
        n, half, nz = some.shape
        counts = np.empty((n, self.rows, nz), np.uint8)
        np.bitwise_and(some, HALF_BYTE, out=counts[:, :half])
        np.right_shift(some[:, : self.rows - half], 4, out=counts[:, half:])
        return counts


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

    def _in_half_bytes(self, groups: int) -> bool:
        return groups > MANY and self._enough <= HALF_BYTE

    def needs(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Return about how many bytes it takes: the grid, what is kept of it, beams, threads."""
        beams = sum(len(cast(Lidar, s.model).directions) for group in groups for s in group)
        each = 0 if len(groups) == 1 else 1 if self._in_half_bytes(len(groups)) else 2
        kept = space.size * each * len(groups) // 2
        threads = workers * block_voxels(space) * len(groups)
        return 2 * space.size + kept + beams * BEAM_BYTES + threads

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
            if self._in_half_bytes(len(groups)):
                found.append(HalfBytes.of(counts, self._enough, pool).__getitem__)
            else:
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

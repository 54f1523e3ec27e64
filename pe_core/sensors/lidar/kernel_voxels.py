"""The LiDAR's kernels for voxels: all voxels of a space, and a sample of them.

`LidarGrid` casts all beams and sweeps them through the grid (`grid_sweep`). `LidarSample` looks
beams up by direction and casts only those whose end matters (`voxel_beams`, `beams`).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids import PerceptionSpace
from ...geometry.indexing import blocks
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import (
    BLOCK_PLANES,
    GridKernel,
    Measured,
    Occlusion,
    Planes,
    SampleKernel,
    Voxels,
    block_voxels,
)
from .beams import (
    BeamCache,
    BeamEnds,
    BeamField,
    LazyEnds,
    beam_field,
    occlusion_of,
    same_measurement,
)
from .definition import cube_crossing
from .grid_sweep import BeamGrid
from .lattice import lattice_of, windows_of
from .model import lidar_of
from .tie_rules import position_in_voxels
from .voxel_beams import (
    CUBE_RADIUS,
    PlacedLidar,
    Unoccluded,
    VoxelPoints,
    count_pairs,
    count_unoccluded,
    count_voxel_beams,
)

MAX_BYTE_GROUPS = 2
"""With more groups of LiDARs than this, counts are packed as nibbles if AP saturates that early."""
MAX_NIBBLE = 15
BEAM_BYTES = 100
"""Memory of a cast beam, measured: its direction, its end and its hit."""
MIN_RANGE_BLOCK = 64
"""Voxels tested together; all beams may pass a voxel next to the sensor."""


@dataclass(frozen=True, slots=True)
class CastLidar:
    """A LiDAR with its beams cast."""

    sensor: Sensor
    field: BeamField


@dataclass(frozen=True, slots=True)
class NibbleCounts:
    """Counts (nx, ny, nz) of at most `MAX_NIBBLE`, two in a byte.

    A byte holds row j in its low and row ``j + ny / 2`` in its high nibble. This takes half the
    memory of `compact`; counts are unpacked at every access.
    """

    packed: NDArray[np.uint8]
    rows: int

    @classmethod
    def of(
        cls, counts: NDArray[np.uint16], saturation_count: int, pool: Executor | None = None
    ) -> NibbleCounts:
        """Pack counts, clipped at `saturation_count`."""
        nx, rows, nz = counts.shape
        half = (rows + 1) // 2
        packed = np.empty((nx, half, nz), np.uint8)

        def pack(planes: slice) -> None:
            for i in range(planes.start, planes.stop):
                small = np.minimum(counts[i], saturation_count).astype(np.uint8)
                packed[i] = small[:half]
                packed[i, : rows - half] |= small[half:] << 4

        list((pool.map if pool else map)(pack, blocks(nx, BLOCK_PLANES)))
        return cls(packed, rows)

    def __getitem__(self, planes: slice) -> NDArray[np.uint8]:
        """Return the counts of some x-planes, one in a byte."""
        packed = self.packed[planes]
        n, half, nz = packed.shape
        counts = np.empty((n, self.rows, nz), np.uint8)
        np.bitwise_and(packed, MAX_NIBBLE, out=counts[:, :half])
        np.right_shift(packed[:, : self.rows - half], 4, out=counts[:, half:])
        return counts


def compact(
    counts: NDArray[np.uint16], saturation_count: int, pool: Executor | None = None
) -> NDArray:
    """Copy counts, clipped into one byte if `saturation_count` fits: entropies stay the same."""
    fits_byte = saturation_count <= np.iinfo(np.uint8).max
    copy = np.empty(counts.shape, np.uint8 if fits_byte else counts.dtype)

    def clip(planes: slice) -> None:
        for i in range(planes.start, planes.stop):
            copy[i] = np.minimum(counts[i], saturation_count) if fits_byte else counts[i]

    list((pool.map if pool else map)(clip, blocks(len(counts), BLOCK_PLANES)))
    return copy


class LidarGrid(GridKernel):
    """Counts beams through all voxels of a space; from `saturation_count` on not exactly."""

    def __init__(
        self, space: PerceptionSpace, vehicle: Vehicle | None, saturation_count: int
    ) -> None:
        self._space, self._vehicle, self._saturation_count = space, vehicle, saturation_count

    @cached_property
    def _grid(self) -> BeamGrid:
        return BeamGrid(self._space)  # reused: the first writes to new memory are slow

    def prepare(self, sensor: Sensor) -> CastLidar:
        """Cast the beams."""
        return CastLidar(sensor, beam_field(sensor, self._vehicle))

    def occlusion(self, prepared: CastLidar) -> Occlusion:
        """Count the beams that the vehicle occludes."""
        return occlusion_of(prepared.field, self._vehicle)

    def _uses_nibbles(self, groups: int) -> bool:
        return groups > MAX_BYTE_GROUPS and self._saturation_count <= MAX_NIBBLE

    def memory_bytes(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Return the memory needed, about: grid, kept counts, beams and threads [bytes]."""
        beams = sum(len(lidar_of(s).directions) for group in groups for s in group)
        nibbles = 0 if len(groups) == 1 else 1 if self._uses_nibbles(len(groups)) else 2
        kept = space.size * nibbles * len(groups) // 2
        threads = workers * block_voxels(space) * len(groups)
        return 2 * space.size + kept + beams * BEAM_BYTES + threads

    def planes(self, groups: Sequence[Sequence[CastLidar]], pool: Executor) -> list[Planes]:
        """Count each group's beams on the whole grid at once; keep several groups compact."""
        planes: list[Planes] = []
        for group in groups:
            self._grid.clear()
            for lidar in group:
                position, min_range = lidar.sensor.pose.position, lidar_of(lidar.sensor).min_range
                self._grid.add(position, lidar.field.directions, lidar.field.ends, min_range)
            counts = self._grid.counts
            if self._uses_nibbles(len(groups)):
                planes.append(NibbleCounts.of(counts, self._saturation_count, pool).__getitem__)
            else:
                one_group = len(groups) == 1
                kept = counts if one_group else compact(counts, self._saturation_count, pool)
                planes.append(kept.__getitem__)
        return planes


class LidarSample(SampleKernel):
    """Counts beams through sampled voxels; from `saturation_count` on not exactly."""

    def __init__(self, voxels: Voxels, vehicle: Vehicle | None, saturation_count: int) -> None:
        self._space, self._vehicle = voxels.space, vehicle
        self._saturation_count = saturation_count
        self._points = VoxelPoints(voxels.index)
        self.cache = BeamCache(vehicle)
        self._unoccluded: dict[str, tuple[Sensor, Unoccluded]] = {}  # by name, of the last rig

    def measure(self, sensor: Sensor, approximate: bool) -> Measured:
        """Count a LiDAR's beams; `approximate`: occlusion may be an approximation."""
        beams = self.cache.cast(sensor, approximate)
        lidar = self._placed(sensor, beams.ends)
        cached = self._unoccluded.get(sensor.name)
        unoccluded = cached[1] if cached and same_measurement(cached[0], sensor) else None
        counts = count_voxel_beams(self._points, lidar, self._saturation_count, unoccluded)
        counts = recount_min_range(self._points, lidar, counts, lidar_of(sensor).min_range)
        return Measured(sensor, counts, beams.approximate, beams.ends)

    def unoccluded(self, sensor: Sensor) -> NDArray:
        """Count a LiDAR's beams without the vehicle."""
        lidar = self._placed(sensor, self.cache.unoccluded(sensor))
        unoccluded = count_unoccluded(self._points, lidar, self._saturation_count)
        self._unoccluded[sensor.name] = sensor, unoccluded
        min_range = lidar_of(sensor).min_range
        return recount_min_range(
            self._points, lidar, unoccluded.counts, min_range, without_vehicle=True
        )

    def occlusion(self, measured: Measured) -> Occlusion:
        """Count the beams that the vehicle occludes; exactly, whatever `measured` is."""
        ends = measured.kernel_data
        is_lazy = isinstance(ends, LazyEnds)
        field = ends.beam_field() if is_lazy else beam_field(measured.sensor, self._vehicle)
        return occlusion_of(field, self._vehicle)

    def keep_only(self, sensors: Collection[Sensor]) -> None:
        """Drop the cached beams and counts of all other sensors."""
        self.cache.keep_only(sensors)
        names = {sensor.name for sensor in sensors}
        self._unoccluded = {n: counts for n, counts in self._unoccluded.items() if n in names}

    def _placed(self, sensor: Sensor, ends: BeamEnds) -> PlacedLidar:
        side = self._space.interval
        return PlacedLidar(
            lattice_of(lidar_of(sensor)),
            position_in_voxels(sensor.pose.position, self._space.origin, side),
            sensor.pose.ground_from_sensor,
            self.cache.rotated(sensor),
            ends,
            side,
        )


def recount_min_range(
    voxels: VoxelPoints,
    lidar: PlacedLidar,
    counts: NDArray[np.signedinteger],
    min_range: float,
    without_vehicle: bool = False,
) -> NDArray[np.signedinteger]:
    """Count again the voxels within the minimum range, beam by beam.

    They are few, so the fast kernels ignore the minimum range, and this corrects their `counts`
    (V,). Beams that leave a voxel, or end, nearer than `min_range` [m] do not count.
    """
    if min_range <= 0.0:
        return counts
    min_distance = min_range / lidar.side
    offsets = voxels.offsets(lidar.position)
    near = np.flatnonzero((offsets * offsets).sum(axis=1) < (min_distance + CUBE_RADIUS) ** 2)
    counts = counts.copy()
    for start in range(0, len(near), MIN_RANGE_BLOCK):
        block = near[start : start + MIN_RANGE_BLOCK]
        centers = offsets[block]
        windows = windows_of(centers, 0.5, lidar.ground_from_sensor)
        voxel, beam = lidar.lattice.candidates(windows)
        directions = np.stack(list(lidar.beams.components(beam)), axis=1)
        _, leave = cube_crossing(centers[voxel], directions)
        kept = np.flatnonzero(leave >= min_distance)
        if not without_vehicle:
            kept = kept[_end_beyond(lidar, beam[kept], min_distance)]
        counts[block] = count_pairs(centers, lidar, voxel[kept], beam[kept], without_vehicle)
    return counts


def _end_beyond(lidar: PlacedLidar, beams: NDArray[np.int64], distance: float) -> NDArray[np.bool_]:
    """Whether beams (N,) end no nearer than a distance, in sides."""
    beyond = np.ones(len(beams), bool)
    at = np.flatnonzero(lidar.ends.occludable[beams])
    beyond[at] = lidar.ends.take(beams[at]) / lidar.side >= distance
    return beyond

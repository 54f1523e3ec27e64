"""The LiDAR's kernels for voxels: all voxels of a space, and a sample of them.

`LidarGrid` casts all beams and sweeps them through the grid (`grid_sweep`). `LidarSample` looks
beams up by direction and casts only those whose end matters (`voxel_beams`, `beams`).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from concurrent.futures import Executor
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
from .beams import BeamCache, BeamEnds, BeamField, LazyEnds, beam_field
from .definition import cube_crossing
from .grid_sweep import BeamGrid
from .lattice import lattice_of
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

BEAM_BYTES = 100
"""Memory of a cast beam, measured: its direction, its end and its hit."""
MIN_RANGE_BLOCK = 64
"""Voxels tested together; all beams may pass a voxel next to the sensor."""


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

    def prepare(self, sensor: Sensor) -> tuple[Sensor, BeamField]:
        """Cast the beams."""
        return sensor, beam_field(sensor, self._vehicle)

    def occlusion(self, prepared: tuple[Sensor, BeamField]) -> Occlusion:
        """Count the beams that the vehicle occludes."""
        return prepared[1].occlusion()

    def memory_bytes(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Return the memory needed, about: grid, kept counts, beams and threads [bytes]."""
        beams = sum(len(lidar_of(s).directions) for group in groups for s in group)
        kept = space.size * len(groups) if len(groups) > 1 else 0
        threads = workers * block_voxels(space) * len(groups)
        return 2 * space.size + kept + beams * BEAM_BYTES + threads

    def planes(
        self, groups: Sequence[Sequence[tuple[Sensor, BeamField]]], pool: Executor
    ) -> list[Planes]:
        """Count each group's beams on the whole grid at once; keep several groups compact."""
        planes: list[Planes] = []
        for group in groups:
            self._grid.clear()
            for sensor, field in group:
                min_range = lidar_of(sensor).min_range
                self._grid.add(sensor.pose.position, field.directions, field.ends, min_range)
            counts: NDArray = self._grid.counts
            if len(groups) > 1:
                counts = compact(counts, self._saturation_count, pool)
            planes.append(counts.__getitem__)
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
        unoccluded = cached[1] if cached and sensor.measures_as(cached[0]) else None
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
        return field.occlusion()

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
        voxel, beam = lidar.candidates(centers)
        directions = np.stack(list(lidar.beams.components(beam)), axis=1)
        _, leave = cube_crossing(centers[voxel], directions)
        kept = np.flatnonzero(leave >= min_distance)
        if not without_vehicle:  # nor end nearer
            at = np.flatnonzero(lidar.ends.occludable[beam[kept]])
            beyond = np.ones(len(kept), bool)
            beyond[at] = lidar.ends.take(beam[kept[at]]) / lidar.side >= min_distance
            kept = kept[beyond]
        counts[block] = count_pairs(centers, lidar, voxel[kept], beam[kept], without_vehicle)
    return counts

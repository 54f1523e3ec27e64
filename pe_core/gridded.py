"""Scoring on every voxel of the grid."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from .fusion import Fusion, Measurement
from .kernels.camera_grid import pixels_in_planes
from .kernels.lidar_grid import MOST, BeamGrid
from .occlusion import beam_counts, beam_field
from .prior import ClassDensity
from .score import ClassScore, GroundMap, Score, SensorScore, rounded
from .sensors import Camera, Rig, Sensor
from .space import PerceptionSpace
from .vehicle import Vehicle
from .weights import outside_masses, outside_shares

Floats = NDArray[np.float64]
Counts = NDArray[np.uint16]
MeasuredGroup = Callable[[slice], Measurement]
"""A fusion group's measurement on a run of x-planes, (n, ny, nz)."""

BLOCK_PLANES = 4
"""x-planes looked at together: few enough for the cache, enough to keep NumPy busy."""


class Sums(NamedTuple):
    """Prior-weighted sums by class (C,), and by column (n, ny)."""

    entropy: Floats
    coverage: Floats
    map_entropy: NDArray[np.float32]
    map_coverage: NDArray[np.float32]


class GridScorer:
    """Scores rigs on all voxels, in blocks of x-planes; `workers` threads share the blocks."""

    def __init__(
        self,
        space: PerceptionSpace,
        densities: list[ClassDensity],
        vehicle: Vehicle | None,
        fusion: Fusion,
        workers: int | None,
    ) -> None:
        self._space, self._vehicle, self._fusion = space, vehicle, fusion
        self._workers = workers or os.cpu_count() or 1
        self._names = [d.name for d in densities]
        self._grounds = np.stack([d.ground for d in densities], axis=-1)  # (nx, ny, C)
        self._profiles = np.stack([d.profile for d in densities], axis=-1)  # (nz, C)
        self._tops = None if vehicle is None else vehicle.top(space)
        self._masses = np.array(outside_masses(densities, space, self._tops))
        outside_shares(densities, space, self._tops)  # complains when nothing is left to weigh

    def entropy(self, rig: Rig) -> float:
        """Perception entropy alone."""
        return self._total(self._sums(self._groups(rig, {})).entropy)

    def score(self, rig: Rig) -> Score:
        """Everything a grid score tells."""
        alone: dict[str, Sums] = {}
        groups = self._groups(rig, alone)
        sums = self._sums(groups)
        return Score(
            self._total(sums.entropy),
            self._total(sums.coverage),
            0.0,
            self._classes(sums),
            {s.name: self._alone(s, alone.get(s.name, sums)) for s in rig},
            self._space.size,
            GroundMap(sums.map_entropy, sums.map_coverage),
        )

    def _groups(self, rig: Rig, alone: dict[str, Sums] | None = None) -> list[MeasuredGroup]:
        """Measure every fusion group; note each sensor's own sums in `alone` if asked to."""
        wanted = None if len(rig) == 1 else alone
        return [
            self._lidars(members, wanted)
            if members[0].kind == "lidar"
            else self._cameras(members, wanted)
            for members in rig.groups.values()
        ]

    def _lidars(self, members: list[Sensor], alone: dict[str, Sums] | None) -> MeasuredGroup:
        """Count the beams of an early-fusion group, one sensor's grid at a time."""
        total = self._count(members[0], alone)
        for sensor in members[1:]:
            _add_held(total, self._count(sensor, alone))
        return lambda planes: ("lidar", total[planes])

    def _count(self, sensor: Sensor, alone: dict[str, Sums] | None) -> Counts:
        grid = BeamGrid(self._space)
        field = beam_field(sensor, self._vehicle)
        grid.add(sensor.pose.position, field.directions, field.ends)
        counts = grid.counts
        if alone is not None:
            alone[sensor.name] = self._sums([lambda planes: ("lidar", counts[planes])])
        return counts

    def _cameras(self, members: list[Sensor], alone: dict[str, Sums] | None) -> MeasuredGroup:
        images = [self._image(sensor) for sensor in members]
        if alone is not None:
            for sensor, image in zip(members, images, strict=True):
                alone[sensor.name] = self._sums([image])
        return lambda planes: ("camera", np.sum([image(planes)[1] for image in images], axis=0))

    def _image(self, sensor: Sensor) -> MeasuredGroup:
        camera, pose, space = cast(Camera, sensor.model), sensor.pose, self._space
        seen = None
        if self._vehicle is not None:
            seen = self._vehicle.seen_from(pose.position, "camera")
        return lambda planes: ("camera", pixels_in_planes(camera, pose, space, planes, seen))

    def _sums(self, groups: Sequence[MeasuredGroup]) -> Sums:
        """Weigh entropies and coverage by the prior, block by block, in a fixed order."""
        nx = self._space.shape[0]
        blocks = [slice(i, min(i + BLOCK_PLANES, nx)) for i in range(0, nx, BLOCK_PLANES)]
        with ThreadPoolExecutor(self._workers) as pool:
            parts = list(pool.map(lambda planes: self._block(groups, planes), blocks))
        return Sums(
            np.sum([p.entropy for p in parts], axis=0),
            np.sum([p.coverage for p in parts], axis=0),
            np.concatenate([p.map_entropy for p in parts]),
            np.concatenate([p.map_coverage for p in parts]),
        )

    def _block(self, groups: Sequence[MeasuredGroup], planes: slice) -> Sums:
        entropies, visible = self._fusion.entropies([group(planes) for group in groups])
        seen = visible.astype(float)
        outside = self._outside(planes)
        if outside is not None:
            entropies, seen = entropies * outside, seen * outside
        grounds = self._grounds[planes]
        mass = grounds if outside is None else grounds * self._by_column(outside)
        entropy, coverage = (grounds * self._by_column(values) for values in (entropies, seen))
        total = mass.sum(axis=-1)
        total = np.where(total > 0.0, total, np.nan)
        return Sums(
            entropy.sum(axis=(0, 1)),
            coverage.sum(axis=(0, 1)),
            (entropy.sum(axis=-1) / total).astype(np.float32),
            (coverage.sum(axis=-1) / total).astype(np.float32),
        )

    def _outside(self, planes: slice) -> Floats | None:
        """(n, ny, nz) 1 outside the vehicle's volume, 0 inside; None where it does not reach."""
        if self._tops is None or not np.isfinite(self._tops[planes]).any():
            return None
        return (self._space.centers(2) >= self._tops[planes][..., None]).astype(float)

    def _by_column(self, values: Floats) -> Floats:
        """Sum (n, ny, nz) values over height by each class's profile: (n, ny, C)."""
        n, ny, nz = values.shape
        return (values.reshape(n * ny, nz) @ self._profiles).reshape(n, ny, -1)

    def _total(self, by_class: Floats) -> float:
        return rounded(by_class.sum() / self._masses.sum())

    def _classes(self, sums: Sums) -> dict[str, ClassScore]:
        shares = self._masses / self._masses.sum()
        return {
            name: ClassScore(rounded(h / mass), rounded(c / mass), rounded(share))
            for name, h, c, mass, share in zip(
                self._names, sums.entropy, sums.coverage, self._masses, shares, strict=True
            )
            if mass > 0.0
        }

    def _alone(self, sensor: Sensor, sums: Sums) -> SensorScore:
        counts = beam_counts(sensor, self._vehicle)
        return SensorScore(self._total(sums.entropy), self._total(sums.coverage), *counts)


def _add_held(total: Counts, more: Counts) -> None:
    """Add in place, plane by plane, holding at 65535."""
    for plane, other in zip(total, more, strict=True):
        plane[:] = np.minimum(plane.astype(np.uint32) + other, MOST)

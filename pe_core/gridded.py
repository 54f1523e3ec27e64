"""Scoring on every voxel of the grid."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from .entropy import H_BLIND
from .fusion import Fusion
from .kernels.camera_grid import CameraPlanes
from .kernels.lidar_grid import BeamGrid
from .occlusion import beam_counts, beam_field
from .prior import ClassDensity
from .score import GroundMap, PartScore, Score, SensorScore, rounded
from .sensors import Camera, Rig, Sensor
from .space import PerceptionSpace
from .subsets import Names, fused_early, parts_of
from .vehicle import Vehicle
from .weights import outside_masses
from .zones import column_zones

Floats = NDArray[np.float64]
MeasuredPlanes = Callable[[slice], NDArray]
"""A sensor's measurement on a run of x-planes, (n, ny, nz)."""

BLOCK_PLANES = 4
"""x-planes looked at together: few enough for the cache, enough to keep NumPy busy."""


class Sums(NamedTuple):
    """Entropy and coverage weighed by the prior, summed over height: each (n, ny, C)."""

    entropy: Floats
    coverage: Floats


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

    def entropy(self, rig: Rig) -> float:
        """Perception entropy alone."""
        whole = tuple(s.name for s in rig)
        measured = self._measured(rig)
        blocks = self._each_block(
            lambda planes: self._sums(rig, measured, [whole], planes)[0].entropy.sum(axis=(0, 1))
        )
        return self._mean(np.sum(blocks, axis=0))

    def score(self, rig: Rig) -> Score:
        """Everything a grid score tells."""
        measured = self._measured(rig)
        parts = parts_of(rig)
        blocks = self._each_block(lambda planes: self._reduced(rig, measured, parts, planes))
        by_class = {
            members: Sums(*np.sum([block[0][n] for block in blocks], axis=0))
            for n, members in enumerate(parts)
        }
        columns = np.concatenate([block[1] for block in blocks], axis=1)
        whole = by_class[parts[0]]
        return Score(
            self._mean(whole.entropy),
            self._mean(whole.coverage),
            0.0,
            self._classes(whole),
            self._zones(columns),
            {s.name: self._sensor(s, rig, by_class) for s in rig},
            self._space.size,
            _ground_map(columns),
        )

    def _measured(self, rig: Rig) -> dict[str, MeasuredPlanes]:
        """Get every sensor's measurement ready, by name."""
        only = sum(s.kind == "lidar" for s in rig) == 1  # several are kept small
        return {s.name: self._measured_sensor(s, only) for s in rig}

    def _measured_sensor(self, sensor: Sensor, only: bool) -> MeasuredPlanes:
        """Measure a LiDAR on the whole grid; a camera is measured when its planes are asked for."""
        if sensor.kind == "lidar":
            grid = BeamGrid(self._space)
            field = beam_field(sensor, self._vehicle)
            grid.add(sensor.pose.position, field.directions, field.ends)
            counts = grid.counts if only else self._fusion.compact(grid.counts)
            return lambda planes: counts[planes]
        camera, pose, space = cast(Camera, sensor.model), sensor.pose, self._space
        seen = None
        if self._vehicle is not None:
            seen = self._vehicle.seen_from(pose.position, "camera")
        return CameraPlanes(camera, pose, space, seen).areas

    def _each_block(self, work: Callable[[slice], object]) -> list:
        """Work on runs of x-planes; the results are in the order of the planes."""
        nx = self._space.shape[0]
        blocks = [slice(i, min(i + BLOCK_PLANES, nx)) for i in range(0, nx, BLOCK_PLANES)]
        with ThreadPoolExecutor(self._workers) as pool:
            return list(pool.map(work, blocks))

    def _reduced(
        self, rig: Rig, measured: Mapping[str, MeasuredPlanes], parts: list[Names], planes: slice
    ) -> tuple[Floats, Floats]:
        """Sums by class of every part of the rig (P, 2, C); and of the whole rig by column.

        The columns (3, n, ny) are entropy and coverage weighed by the prior, and the prior itself.
        """
        sums = self._sums(rig, measured, parts, planes)
        by_class = [[values.sum(axis=(0, 1)) for values in part] for part in sums]
        mass = self._grounds[planes]
        outside = self._outside(planes)
        if outside is not None:
            mass = mass * self._over_height(outside)
        columns = [values.sum(axis=-1) for values in (*sums[0], mass)]
        return np.array(by_class), np.array(columns)

    def _sums(
        self, rig: Rig, measured: Mapping[str, MeasuredPlanes], parts: list[Names], planes: slice
    ) -> list[Sums]:
        """Weigh entropy and coverage by the prior on some planes, for parts of the rig."""
        values = {name: measure(planes) for name, measure in measured.items()}
        outside, grounds = self._outside(planes), self._grounds[planes]
        found = []
        for members in parts:
            entropies, visible = self._fusion.entropies(fused_early(rig, values, members))
            seen = visible.astype(float)
            if outside is not None:
                entropies, seen = entropies * outside, seen * outside
            found.append(Sums(*(grounds * self._over_height(v) for v in (entropies, seen))))
        return found

    def _outside(self, planes: slice) -> Floats | None:
        """(n, ny, nz) 1 outside the vehicle's volume, 0 inside; None where it does not reach."""
        if self._tops is None or not np.isfinite(self._tops[planes]).any():
            return None
        return (self._space.centers(2) >= self._tops[planes][..., None]).astype(float)

    def _over_height(self, values: Floats) -> Floats:
        """Sum (n, ny, nz) values over height by each class's profile: (n, ny, C)."""
        n, ny, nz = values.shape
        return (values.reshape(n * ny, nz) @ self._profiles).reshape(n, ny, -1)

    def _mean(self, by_class: Floats) -> float:
        return rounded(by_class.sum() / self._masses.sum())

    def _classes(self, whole: Sums) -> dict[str, PartScore]:
        shares = self._masses / self._masses.sum()
        rows = zip(self._names, whole.entropy, whole.coverage, self._masses, shares, strict=True)
        return {
            name: PartScore(rounded(h / mass), rounded(c / mass), rounded(share))
            for name, h, c, mass, share in rows
            if mass > 0.0
        }

    def _zones(self, columns: Floats) -> dict[str, PartScore]:
        total = columns[2].sum()
        found = {}
        for name, mask in column_zones(self._space).items():
            h, c, mass = (float(values[mask].sum()) for values in columns)
            if mass > 0.0:
                found[name] = PartScore(rounded(h / mass), rounded(c / mass), rounded(mass / total))
        return found

    def _sensor(self, sensor: Sensor, rig: Rig, by_class: Mapping[Names, Sums]) -> SensorScore:
        names = tuple(s.name for s in rig)
        whole, alone = by_class[names], by_class[(sensor.name,)]
        others = by_class.get(tuple(n for n in names if n != sensor.name))
        failed = H_BLIND if others is None else self._mean(others.entropy)
        lost = rounded(failed - self._mean(whole.entropy))
        counts = beam_counts(sensor, self._vehicle)
        return SensorScore(self._mean(alone.entropy), self._mean(alone.coverage), lost, *counts)


def _ground_map(columns: Floats) -> GroundMap:
    entropy, coverage, mass = columns
    safe = np.where(mass > 0.0, mass, np.nan)
    return GroundMap(entropy / safe, coverage / safe, mass)

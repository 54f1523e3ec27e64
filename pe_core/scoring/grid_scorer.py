"""Scores on every voxel of the grid."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import partial, reduce
from operator import add
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import Floats
from ..base.values import rounded
from ..geometry.grids import PerceptionSpace
from ..geometry.indexing import blocks
from ..metric.entropy import H_BLIND, ApCurve
from ..metric.fusion import CurveOf, Fusion, Group, PlaneFusion
from ..metric.leave_one_out import LeaveOneOut
from ..prior.prior import ClassDensity
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..sensors import GridKernel, kind_of
from ..sensors.kernels import BLOCK_PLANES, Planes
from .density_cache import outside_masses
from .memory_need import Grouped, grid_bytes, require_room_for
from .protocol import Evaluation
from .scenarios import (
    Members,
    Scenarios,
    fused_early,
    mean_or_worst,
    members_of,
    parts_by_sums,
    parts_of,
)
from .score import (
    PartScore,
    Score,
    ScoreProgress,
    SensorScore,
    SummaryScore,
    Watch,
    column_zones,
    ground_map,
    sensor_score,
)

KernelKey = tuple[str, ApCurve | None]
"""A kind, and the AP curve of its own that a sensor may have."""
MeasuredGroup = tuple[CurveOf, Planes]
"""The AP curve of some sensors, and what measures them on a run of x-planes."""

PRODUCT_AT_ONCE = 1 << 18
"""Multiplications in one call of BLAS: for more it starts threads, and ours are busy already."""


class Sums(NamedTuple):
    """Entropy and coverage, weighted by the prior, by class: (C,) each."""

    entropy: Floats
    coverage: Floats


class GridScorer:
    """Scores rigs on all voxels, in runs of x-planes; `workers` threads share them.

    No score is a preview: `preview` has no effect.
    """

    def __init__(
        self,
        space: PerceptionSpace,
        densities: list[ClassDensity],
        vehicle: Vehicle | None,
        fusion: Fusion,
        workers: int | None,
    ) -> None:
        self._space, self._vehicle, self._fusion = space, vehicle, fusion
        self._planes = PlaneFusion(fusion, space.shape[1:])
        self._workers = workers or os.cpu_count() or 1
        self._blocks = list(blocks(space.shape[0], BLOCK_PLANES))
        self._names = [d.name for d in densities]
        self._grounds = np.stack([d.ground for d in densities], axis=-1)  # (nx, ny, C)
        self._profiles = np.stack([d.profile for d in densities], axis=-1)  # (nz, C)
        self._tops = None if vehicle is None else vehicle.top(space)
        self._reached = np.isfinite(-np.inf if self._tops is None else self._tops.max(axis=1))
        self._masses = np.array(outside_masses(densities, space, self._tops))
        self._kernels: dict[KernelKey, GridKernel] = {}  # as many as there are
        self._lock = Lock()

    def entropy(self, rig: Rig, preview: bool = False) -> float:
        """Return the perception entropy alone."""
        require_room_for(self._space, partial(self.needs, list(rig.groups.values())))
        with self._lock, ThreadPoolExecutor(self._workers) as pool:
            ready = self._ready(rig, pool)
            groups = self._measured(list(rig.groups.values()), ready, pool)

            def work(planes: slice) -> Floats:
                fused = [[(kind, measure(planes)) for kind, measure in groups]]
                weighed = self._weighed(fused, planes, coverage=False)
                return np.sum([plane[0, 0].sum(axis=0) for plane, _ in weighed], axis=0)

            return self._mean(np.sum(list(pool.map(work, self._blocks)), axis=0))

    def summary(self, rig: Rig, preview: bool = False) -> SummaryScore:
        """Return the score without the part by sensor."""
        whole = self.score(rig)
        figures = whole.entropy, whole.coverage, whole.stderr, whole.per_class, whole.per_zone
        return SummaryScore(*figures, whole.voxels)

    def evaluate(self, rig: Rig, cutoff: float) -> Evaluation:
        """Return the entropy, whatever the cutoff."""
        return Evaluation(self.entropy(rig), False)

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the entropy of each of several rigs [nats]."""
        return [self.entropy(part) for part in Scenarios(rigs).parts]

    def evaluate_together(self, rigs: Sequence[Rig], cutoff: float, worst: bool) -> Evaluation:
        """Return the mean of several rigs' entropies, or the highest, whatever the cutoff."""
        return Evaluation(mean_or_worst(self.entropies(rigs), worst), False)

    def score(self, rig: Rig, preview: bool = False, watch: Watch | None = None) -> Score:
        """Return the full score."""
        require_room_for(self._space, partial(self.needs, [[s] for s in rig]))
        progress = ScoreProgress(watch, len(self._blocks))
        # By the literal formula (eq. 7) a sensor changes the fusion also where it sees nothing.
        is_sparse = self._fusion.model.blind == "floor" and len(rig.sensors) > 1
        parts = parts_of(rig)[: 1 if is_sparse else None]
        with self._lock, ThreadPoolExecutor(self._workers) as pool:
            ready = self._ready(rig, pool)
            measured = self._measured([[s] for s in rig], ready, pool)

            def work(planes: slice) -> tuple[Floats, Floats, Floats]:
                progress.check()
                values = {s.name: m(planes) for s, (_, m) in zip(rig, measured, strict=True)}
                fused = [fused_early(rig, values, members) for members in parts]
                measurements = members_of(rig, values)
                members = LeaveOneOut(self._planes, measurements, fused[0]) if is_sparse else None
                return self._reduced(fused, planes, members)

            reduced = []
            for block in pool.map(work, self._blocks):
                reduced.append(block)
                progress.add()
        sums = np.sum([by_part for by_part, _, _ in reduced], axis=0)
        by_part = {members: Sums(*row) for members, row in zip(parts, sums, strict=True)}
        columns = np.concatenate([columns for _, columns, _ in reduced], axis=1)
        whole = by_part[parts[0]]
        if is_sparse:
            by_sensor = np.sum([by_sensor for _, _, by_sensor in reduced], axis=0)
            blind = H_BLIND * float(self._masses.sum())
            more = parts_by_sums(rig, float(whole.entropy.sum()), blind, by_sensor)
            by_part |= {members: Sums(*row) for members, row in more.items()}
        return Score(
            self._mean(whole.entropy),
            self._mean(whole.coverage),
            0.0,
            self._classes(whole),
            self._zones(columns),
            {s.name: self._sensor(s, rig, by_part, ready[s.name]) for s in rig},
            self._space.size,
            ground_map(columns),
        )

    def needs(self, groups: Grouped, space: PerceptionSpace) -> int:
        """Return about how many bytes it takes to score groups of sensors in a space."""
        firsts = [sensors[0] for sensors in groups]
        kernels = {(s.kind, s.curve): self._kernel(s) for s in firsts}
        vehicle, classes = self._vehicle, len(self._names)
        return grid_bytes(space, groups, kernels, vehicle, classes, self._workers)

    def _ready(self, rig: Rig, pool: Executor) -> dict[str, Any]:
        """Return each sensor's prepared measurement, by sensor name."""
        ready = pool.map(lambda sensor: self._kernel(sensor).prepare(sensor), rig)
        return dict(zip((s.name for s in rig), ready, strict=True))

    def _kernel(self, sensor: Sensor) -> GridKernel:
        """Return the kernel that measures sensors of this sensor's kind and AP curve."""
        kind, key = kind_of(sensor), (sensor.kind, sensor.curve)
        if key not in self._kernels:
            enough = self._fusion.saturation_count(sensor.curve or kind.name)
            self._kernels[key] = kind.on_grid(self._space, self._vehicle, enough)
        return self._kernels[key]

    def _measured(
        self, groups: Sequence[Sequence[Sensor]], ready: Mapping[str, Any], pool: Executor
    ) -> list[MeasuredGroup]:
        """Sum the measurements of each group; a group's sensors are of one kind."""
        keys = [(sensors[0].kind, sensors[0].curve) for sensors in groups]
        planes: dict[int, Planes] = {}
        for key in dict.fromkeys(keys):
            positions = [k for k, group_key in enumerate(keys) if group_key == key]
            of_key = [[ready[s.name] for s in groups[k]] for k in positions]
            planes |= zip(positions, self._kernels[key].planes(of_key, pool), strict=True)
        return [(curve or kind, planes[k]) for k, (kind, curve) in enumerate(keys)]

    def _weighed(
        self, parts: Sequence[Sequence[Group]], planes: slice, *, coverage: bool
    ) -> Iterator[tuple[Floats, Floats]]:
        """Yield prior-weighted entropy, and coverage if needed, of parts of a rig.

        By plane: sums over height (P, 1 or 2, ny, C), and entropies (ny, nz) of the first part.
        """
        for i, ground in enumerate(self._grounds[planes]):
            outside = self._outside(planes.start + i)
            weighed = np.empty((len(parts), 1 + coverage, *ground.shape))
            entropies_by_part = (self._planes.entropies(groups, i) for groups in parts)
            first: Floats | None = None
            for groups, entropies, sums in zip(parts, entropies_by_part, weighed, strict=True):
                first = entropies if first is None else first
                self._over_height(entropies, outside, sums[0])
                if coverage:
                    visible = self._planes.seen(groups, i).astype(float)
                    self._over_height(visible, outside, sums[1])
            weighed *= ground
            assert first is not None  # every rig has at least one part
            yield weighed, first

    def _reduced(
        self, parts: Sequence[Sequence[Group]], planes: slice, members: LeaveOneOut | None
    ) -> tuple[Floats, Floats, Floats]:
        """Return sums by part and class (P, 2, C), by column of the whole rig, and by sensor.

        The columns (3, n, ny) are entropy and coverage weighted by the prior, and the prior.
        Sums by sensor (3, S) come from `members`; they are empty without it.
        """
        by_class = np.zeros((len(parts), 2, len(self._names)))
        columns = np.empty((3, planes.stop - planes.start, self._grounds.shape[1]))
        by_sensor: Floats = np.zeros(1)
        for i, (weighed, entropies) in enumerate(self._weighed(parts, planes, coverage=True)):
            by_class += weighed.sum(axis=2)
            columns[:2, i] = weighed[0].sum(axis=-1)
            columns[2, i] = self._mass(planes.start + i).sum(axis=-1)
            if members is not None:
                weights = self._weights(planes.start + i)
                by_sensor = by_sensor + members.of_plane(i, entropies, weights)
        return by_class, columns, by_sensor

    def _weights(self, plane: int) -> Floats:
        """Return the prior (ny, nz) of a plane's voxels; 0 inside the vehicle's volume."""
        ground, outside = self._grounds[plane], self._outside(plane)
        pairs = zip(ground.T, self._profiles.T, strict=True)
        weights = reduce(add, (np.multiply.outer(*pair) for pair in pairs))
        return weights if outside is None else weights * outside

    def _mass(self, plane: int) -> Floats:
        """Return the prior (ny, C) of a plane's columns, by class."""
        outside, ground = self._outside(plane), self._grounds[plane]
        return ground if outside is None else ground * (outside @ self._profiles)

    def _outside(self, plane: int) -> Floats | None:
        """Return (ny, nz): 1 outside the vehicle, 0 inside; None where a plane misses it."""
        if self._tops is None or not self._reached[plane]:
            return None
        return (self._space.centers(2) >= self._tops[plane][:, None]).astype(float)

    def _over_height(self, values: Floats, outside: Floats | None, out: Floats) -> None:
        """Sum values (ny, nz) over height outside the vehicle, by class profile, into (ny, C)."""
        if outside is not None:
            values = values * outside
        rows = max(1, PRODUCT_AT_ONCE // self._profiles.size)
        for start in range(0, len(values), rows):
            block = slice(start, start + rows)
            np.matmul(values[block], self._profiles, out=out[block])

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
        zones = {}
        for name, mask in column_zones(self._space).items():
            h, c, mass = (float(values[mask].sum()) for values in columns)
            if mass > 0.0:
                zones[name] = PartScore(rounded(h / mass), rounded(c / mass), rounded(mass / total))
        return zones

    def _sensor(
        self, sensor: Sensor, rig: Rig, by_part: Mapping[Members, Sums], ready: Any
    ) -> SensorScore:
        names = tuple(s.name for s in rig)
        whole, alone = by_part[names], by_part[(sensor.name,)]
        without = by_part.get(tuple(n for n in names if n != sensor.name))
        failed = H_BLIND if without is None else self._mean(without.entropy)
        lost = rounded(failed - self._mean(whole.entropy))
        occlusion = self._kernel(sensor).occlusion(ready)
        return sensor_score(self._mean(alone.entropy), self._mean(alone.coverage), lost, occlusion)

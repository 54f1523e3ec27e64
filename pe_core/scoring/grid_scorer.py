"""Scores on every voxel of the grid, and the memory that a score needs.

It is estimated before a score starts; too much is refused in one line. A test holds the estimates
to measured peaks: neither is more than `FACTOR` times the other.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial, reduce
from operator import add
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError, available_bytes, size_text
from ..base.lazy_threads import threads
from ..base.values import rounded
from ..geometry.bins import blocks
from ..geometry.grids import PerceptionSpace
from ..metric.entropy import H_BLIND, CurveOf, ranged
from ..metric.fusion import Fusion, Group, LeaveOneOut, PlaneFusion, VisibleRows
from ..prior.prior import ClassDensity
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..sensors import GridKernel, kind_of
from ..sensors.kernels import BLOCK_PLANES, Planes, block_voxels
from .rig_batch import Members, RigBatch, fused_early, members_of, parts_by_sums, parts_of
from .sampling import FIRST_SAMPLES, MIN_SAMPLES, outside_masses
from .score import (
    PartScore,
    Score,
    ScoreProgress,
    SensorScore,
    Watch,
    column_zones,
    ground_map,
    sensor_score,
)

Grouped = Sequence[Sequence[Sensor]]
"""Sensors whose measurements are summed, and kept, together."""
FACTOR = 2.0  # Maximum ratio of an estimate and the measured memory, either way
COLUMN_BYTES = 10
"""Memory of a column and a class: the density, a copy, and arrays made of it."""
TREE_BYTES = 300  # Memory of a triangle of the vehicle, once rays are cast (measured)
PLANE_BYTES = 24
"""Memory of a voxel of a thread's planes: counts, sums, precision, entropy, weights."""
SAMPLE_BYTES = 600
"""Memory of a sampled voxel (measured: 270 to 420 while sampling, 590 with 32 sensors)."""
COARSER = (2, 4, 5, 10, 20)  # Factors of the voxel's side that a message suggests
MeasuredGroup = tuple[CurveOf, Planes]
"""The AP curve of some sensors, and what measures them on a run of x-planes."""
PRODUCT_AT_ONCE = 1 << 18
"""Multiplications in one call of BLAS: for more it starts threads, and ours are busy already."""


def columns_bytes(space: PerceptionSpace, classes: int) -> int:
    """Return the memory of the prior on the ground of a space [bytes]."""
    nx, ny, _ = space.shape
    return nx * ny * classes * COLUMN_BYTES


def require_room_for(space: PerceptionSpace, needed: Callable[[PerceptionSpace], int]) -> None:
    """Refuse a score of a grid that takes more memory than there is. `needed` returns the memory
    that a score of a space takes [bytes]. The message of the `InputError` has how much it takes,
    how much there is, and what would fit."""
    there = available_bytes()
    amount = needed(space)
    if there is not None and amount > there:
        fitting = next((s.interval for s in _coarser(space) if needed(s) <= there), None)
        ways = [f"samples = {FIRST_SAMPLES}"]
        ways += [] if fitting is None else [f"interval = {fitting:g}"]
        _refuse(amount, there, f"; try {' or '.join(ways)}")


def samples_bytes(samples: int, columns: int) -> int:
    """Return the memory [bytes] of a sampled score; `columns` is the prior's part of it."""
    return columns + samples * SAMPLE_BYTES


def require_room_for_samples(samples: int, columns: int) -> None:
    """Refuse a sample that takes more memory than there is; `columns` is the prior's part [bytes].
    The message of the `InputError` says how many voxels would fit."""
    there = available_bytes()
    amount = samples_bytes(samples, columns)
    if samples and there is not None and amount > there:
        max_samples = max(0, there - columns) // SAMPLE_BYTES
        fitting = 1 << max(0, max_samples.bit_length() - 1)
        _refuse(amount, there, f"; try samples = {fitting}" if fitting >= MIN_SAMPLES else "")


def _refuse(amount: int, there: int, ways: str) -> None:
    expected = f"what fits in the {size_text(there)} of memory that are free{ways}"
    raise InputError("score", "memory", expected, f"about {size_text(amount)}")


def _coarser(space: PerceptionSpace) -> Iterator[PerceptionSpace]:
    """Yield spaces of the same bounds with larger voxels, if these fill the bounds exactly."""
    for times in COARSER:
        try:
            yield PerceptionSpace(space.x, space.y, space.z, space.interval * times)
        except InputError:  # the bounds are no whole number of such voxels
            continue


class Sums(NamedTuple):
    """Entropy and coverage, weighted by the prior, by class: (C,) each."""

    entropy: Floats
    coverage: Floats


class GridScorer:
    """Scores rigs on all voxels, in runs of x-planes; `workers` threads share them."""

    def __init__(
        self,
        space: PerceptionSpace,
        densities: list[ClassDensity],
        vehicle: Vehicle | None,
        fusion: Fusion,
        workers: int | None,
    ) -> None:
        self._space = space
        self._vehicle = vehicle
        self._fusion = fusion
        self._planes = PlaneFusion(fusion, space.shape[1:])
        self._workers = workers or os.cpu_count() or 1
        self._blocks = list(blocks(space.shape[0], BLOCK_PLANES))
        self._names = [d.name for d in densities]
        self._grounds = np.stack([d.ground for d in densities], axis=-1)  # (nx, ny, C)
        self._profiles = np.stack([d.profile for d in densities], axis=-1)  # (nz, C)
        self._tops = None if vehicle is None else vehicle.top(space)
        self._reached = np.isfinite(-np.inf if self._tops is None else self._tops.max(axis=1))
        self._masses = np.array(outside_masses(densities, space, self._tops))
        self._kernels: dict[CurveOf, GridKernel] = {}  # as many as there are
        self._lock = threads().RLock()

    def entropy(self, rig: Rig) -> float:
        """Return the perception entropy alone."""
        require_room_for(self._space, partial(self.needs, list(rig.groups.values())))
        with self._lock, threads().ThreadPoolExecutor(self._workers) as pool:
            ready = self._ready(rig, pool)
            groups = self._measured(list(rig.groups.values()), ready, pool)

            def work(planes: slice) -> Floats:
                fused = [[(kind, measure(planes)) for kind, measure in groups]]
                weighed = self._weighed(fused, planes, coverage=False)
                return np.sum([plane[0, 0].sum(axis=0) for plane, _ in weighed], axis=0)

            return self._mean(np.sum(list(pool.map(work, self._blocks)), axis=0))

    def summary(self, rig: Rig) -> Score:
        """Return the score without the part by sensor."""
        return replace(self.score(rig, by_sensor=False), ground_map=None)

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the entropy of each of several rigs [nats]."""
        return [self.entropy(part) for part in RigBatch(rigs).parts]

    def score(self, rig: Rig, watch: Watch | None = None, by_sensor: bool = True) -> Score:
        """Return the full score; without the part by sensor if that is not asked for."""
        require_room_for(self._space, partial(self.needs, [[s] for s in rig]))
        progress = ScoreProgress(watch, len(self._blocks))
        # By the literal formula (eq. 7) a sensor changes the fusion also where it sees nothing.
        alike = self._fusion.model.blind == "floor" and self._fusion.model.frames is None
        is_sparse = by_sensor and alike and len(rig.sensors) > 1
        parts = parts_of(rig)[: 1 if is_sparse or not by_sensor else None]
        with self._lock, threads().ThreadPoolExecutor(self._workers) as pool:
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
        by_part = {members: Sums._make(row) for members, row in zip(parts, sums, strict=True)}
        columns = np.concatenate([columns for _, columns, _ in reduced], axis=1)
        whole = by_part[parts[0]]
        if is_sparse:
            sums_by_sensor = np.sum([sums for _, _, sums in reduced], axis=0)
            blind = H_BLIND * float(self._masses.sum())
            more = parts_by_sums(rig, float(whole.entropy.sum()), blind, sums_by_sensor)
            by_part |= {members: Sums._make(row) for members, row in more.items()}
        return Score(
            entropy=self._mean(whole.entropy),
            coverage=self._mean(whole.coverage),
            stderr=0.0,
            per_class=self._classes(whole),
            per_zone=self._zones(columns),
            per_sensor={
                s.name: self._sensor(s, rig, by_part, ready[s.name]) for s in rig if by_sensor
            },
            voxels=self._space.size,
            ground_map=ground_map(columns),
        )

    def needs(self, groups: Grouped, space: PerceptionSpace) -> int:
        """Return about how many bytes it takes to score groups of sensors in a space."""
        firsts = [sensors[0] for sensors in groups]
        kernels = {s.detector: self._kernel(s) for s in firsts}
        vehicle = self._vehicle
        classes = len(self._names)
        total = columns_bytes(space, classes) + self._workers * block_voxels(space) * PLANE_BYTES
        total += 0 if vehicle is None else len(vehicle.triangles) * TREE_BYTES
        for key, kernel in kernels.items():
            matching = [group for group in groups if group[0].detector == key]
            total += kernel.memory_bytes(matching, space, self._workers)
        return total

    def _ready(self, rig: Rig, pool: Executor) -> dict[str, Any]:
        """Return each sensor's prepared measurement, by sensor name."""
        ready = pool.map(lambda sensor: self._kernel(sensor).prepare(sensor), rig)
        return dict(zip((s.name for s in rig), ready, strict=True))

    def _kernel(self, sensor: Sensor) -> GridKernel:
        """Return the kernel that measures sensors of this sensor's kind and AP curve."""
        key = sensor.detector
        if key not in self._kernels:
            enough = self._fusion.saturation_count(key)
            self._kernels[key] = kind_of(sensor).on_grid(self._space, self._vehicle, enough)
        return self._kernels[key]

    def _measured(
        self, groups: Sequence[Sequence[Sensor]], ready: Mapping[str, Any], pool: Executor
    ) -> list[MeasuredGroup]:
        """Sum the measurements of each group; a group's sensors are of one kind."""
        keys = [sensors[0].detector for sensors in groups]
        planes: dict[int, Planes] = {}
        for key in dict.fromkeys(keys):
            positions = [k for k, group_key in enumerate(keys) if group_key == key]
            of_key = [[ready[s.name] for s in groups[k]] for k in positions]
            planes |= zip(positions, self._kernels[key].planes(of_key, pool), strict=True)
        return [(key, self._ranged(key, planes[k])) for k, key in enumerate(keys)]

    def _ranged(self, named: CurveOf, measure: Planes) -> Planes:
        """Return the measurement with the range term of its curve: no whole numbers then."""
        curve = self._fusion.curve(named)
        distance = np.hypot.outer(self._space.centers(0), self._space.centers(1))

        def with_range(planes: slice) -> VisibleRows:
            found = measure(planes)
            if not isinstance(found, VisibleRows):
                found = VisibleRows(slice(0, found.shape[1]), found)
            return VisibleRows(
                found.rows, ranged(found.m, curve, distance[planes, found.rows, None])
            )

        return with_range if curve.c else measure

    def _weighed(
        self, parts: Sequence[Sequence[Group]], planes: slice, *, coverage: bool
    ) -> Iterator[tuple[Floats, Floats]]:
        """Yield prior-weighted entropy, and coverage if needed, of parts of a rig. By plane: sums
        over height (P, 1 or 2, ny, C), and entropies (ny, nz) of the first part."""
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
        """Return sums by part and class (P, 2, C), by column of the whole rig, and by sensor. The
        columns (3, n, ny) are entropy and coverage weighted by the prior, and the prior. Sums by
        sensor (3, S) come from `members`; they are empty without it."""
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
        ground = self._grounds[plane]
        outside = self._outside(plane)
        by_class = zip(ground.T, self._profiles.T, strict=True)
        weights = reduce(add, (np.multiply.outer(across, profile) for across, profile in by_class))
        return weights if outside is None else weights * outside

    def _mass(self, plane: int) -> Floats:
        """Return the prior (ny, C) of a plane's columns, by class."""
        outside = self._outside(plane)
        ground = self._grounds[plane]
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
        whole = by_part[names]
        alone = by_part[(sensor.name,)]
        without = by_part.get(tuple(n for n in names if n != sensor.name))
        failed = H_BLIND if without is None else self._mean(without.entropy)
        lost = rounded(failed - self._mean(whole.entropy))
        occlusion = self._kernel(sensor).occlusion(ready)
        return sensor_score(self._mean(alone.entropy), self._mean(alone.coverage), lost, occlusion)

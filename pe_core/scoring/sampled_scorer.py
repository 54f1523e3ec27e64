"""Scores on a sample of voxels: fast, with a standard error."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from ..base.lazy_threads import threads
from ..base.values import rounded
from ..geometry.grids import PerceptionSpace
from ..metric.entropy import H_BLIND
from ..metric.fusion import Fusion
from ..prior.prior import ClassDensity
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..sensors import MeasurementCache, Voxels
from .leave_one_out import adds_up, mean_without_each
from .rig_batch import RigBatch, fused_early, members_of
from .sampling import BLOCKS, CENTERED, Shift, VoxelSample, draw, outside_masses
from .score import (
    ALIKE,
    FigureKey,
    PartScore,
    Scatter,
    Score,
    ScoreProgress,
    SensorScore,
    Watch,
    residuals,
    sample_digest,
    sensor_score,
    unseen_error,
    zone_masks,
)

SENSORS_FUSED = 80
"""Sensors that are fused in the time in which one is measured (measured: 40 to 100)."""


class _ZoneSums:
    """Sums values by run of the sequence, of the whole sample and of all zones at once. Zones
    overlap, so values are summed by the zones that they are in, and by run. Fast because values are
    put in order once, and each sum is then one of neighbours."""

    def __init__(self, zones: Mapping[str, NDArray[np.bool_]], run: Ints) -> None:
        code = np.ones(len(run), np.int64)  # a bit for the rig, and one for each zone
        for bit, inside in enumerate(zones.values(), 1):
            code |= inside.astype(np.int64) << bit
        parts, part = np.unique(code, return_inverse=True)
        bits = np.arange(1 + len(zones))[:, None]
        self._members = (parts >> bits & 1).astype(bool)  # (1 + zones, parts)
        part_and_run = part * BLOCKS + run
        self._order = np.argsort(part_and_run, kind="stable")
        self._bins, self._starts = np.unique(part_and_run[self._order], return_index=True)
        self._keys = [("rig", ""), *(("zone", name) for name in zones)]
        self.counts = self.by_run(np.ones(len(run)))
        """Number of voxels of the rig and of each zone, by run (1 + zones, BLOCKS)."""

    def by_run(self, values: Floats) -> Floats:
        """Return the sums (1 + zones, BLOCKS) of values (V,), of the rig and of each zone."""
        parts = self._members.shape[1]
        sums = np.zeros(parts * BLOCKS)
        sums[self._bins] = np.add.reduceat(values.take(self._order), self._starts)
        by_part = sums.reshape(parts, BLOCKS)
        return np.asarray((self._members[:, :, None] * by_part).sum(axis=1), float)

    def means(self, sums: Floats) -> Floats:
        """Return the means (1 + zones,) of values with these sums by run."""
        return np.asarray(sums.sum(axis=1) / self.counts.sum(axis=1))

    def residuals(self, sums: Mapping[str, Floats]) -> dict[FigureKey, tuple[float, ...]]:
        """Return the residuals (`Scatter`) of measures, of the rig and of each zone, from their
        sums by run."""
        mass = self.counts.sum(axis=1, keepdims=True)
        found = dict[FigureKey, tuple[float, ...]]()
        for measure, by_run in sums.items():
            rows = (by_run - self.means(by_run)[:, None] * self.counts) / mass
            for key, row in zip(self._keys, rows, strict=True):
                found[(*key, measure)] = tuple(map(rounded, row.tolist()))
        return found


class SampledScorer:
    """Scores rigs on one fixed sample of voxels; unmoved sensors are not measured again. It is
    thread-safe: a lock lets one thread score at a time."""

    def __init__(
        self,
        space: PerceptionSpace,
        densities: list[ClassDensity],
        vehicle: Vehicle | None,
        fusion: Fusion,
        samples: int,
        shift: Shift = CENTERED,
    ) -> None:
        self._fusion = fusion
        tops = None if vehicle is None else vehicle.top(space)
        self._sample: VoxelSample = draw(densities, space, samples, tops, shift=shift)
        self._distance = np.hypot(*self._sample.centers[:, :2].T)
        outside_masses(densities, space, tops)  # raises InputError when no weight is left
        x = self._sample.centers[:, 0]
        y = self._sample.centers[:, 1]
        masks = {name: mask for name, mask in zone_masks(x, y).items() if mask.any()}
        self._shares = {name: rounded(float(np.mean(mask))) for name, mask in masks.items()}
        self._by_zone = _ZoneSums(masks, self._sample.run)
        self._by_class = np.ascontiguousarray(self._sample.classes.T)  # (C, V)
        self._class_masses = self._by_class.sum(axis=1).tolist()
        voxels = Voxels(space, self._sample.index, self._sample.centers)
        self._sensors = MeasurementCache(voxels, vehicle, fusion.saturation_count)
        self._lock = threads().RLock()

    @cached_property
    def _digest(self) -> str:
        return sample_digest([self._sample.centers, self._sample.classes])

    def entropy(self, rig: Rig) -> float:
        """Return the perception entropy alone."""
        with self._lock:
            self._sensors.measure(rig)
            return self._entropy_of(rig, self._sensors.m)

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the entropy of each of several rigs; sensors that they share are measured once."""
        batch = RigBatch(rigs)
        with self._lock:
            self._sensors.measure(batch.all)
            m = self._sensors.m
            return [self._entropy_of(part, m) for part in batch.parts]

    def residuals(self, rigs: Sequence[Rig]) -> Floats:
        """Return by rig what each run of the sequence adds to the entropy above its mean."""
        batch = RigBatch(rigs)
        with self._lock:
            self._sensors.measure(batch.all)
            rows = []
            for part in batch.parts:
                values, _ = self._entropies(part, [s.name for s in part])
                rows.append(residuals(values, None, self._sample.run, BLOCKS))
            return np.array(rows)

    def summary(self, rig: Rig) -> Score:
        """Return the score without the part by sensor."""
        with self._lock:
            self._sensors.measure(rig)
            entropies, visible = self._entropies(rig, [s.name for s in rig])
            return self._summary(rig, entropies, visible)

    def score(self, rig: Rig, watch: Watch | None = None) -> Score:
        """Return the full score; `watch` gets the share that is done after each sensor."""
        count = len(rig.sensors)  # each is measured, then fused alone and left out
        progress = ScoreProgress(watch, count * (1.0 + 1.0 / SENSORS_FUSED))
        with self._lock:
            self._sensors.measure(rig, progress.add)
            entropies, visible = self._entropies(rig, [s.name for s in rig])
            whole = self._summary(rig, entropies, visible)
            failed = self._without_each(rig)
            per_sensor = {
                s.name: self._sensor(s, rig, failed[s.name] - whole.entropy, progress) for s in rig
            }
            assert whole.scatter is not None
            by_figure = {**whole.scatter.residuals, **self._class_residuals(entropies, visible)}
            scatter = Scatter(self._digest, by_figure)
            return replace(whole, per_sensor=per_sensor, scatter=scatter)

    def _entropy_of(self, rig: Rig, measured: Mapping[str, NDArray]) -> float:
        fused = fused_early(rig, measured, [s.name for s in rig])
        fused = self._fusion.ranged(fused, self._distance)
        return rounded(float(np.mean(self._fusion.entropies(fused)[0])))

    def _entropies(self, rig: Rig, members: Collection[str]) -> tuple[Floats, NDArray[np.bool_]]:
        """Return entropy and visibility of every sampled voxel, for some of the rig's sensors."""
        fused = fused_early(rig, self._sensors.m, members)
        return self._fusion.entropies(self._fusion.ranged(fused, self._distance))

    def _summary(self, rig: Rig, entropies: Floats, visible: NDArray[np.bool_]) -> Score:
        entropy, coverage = self._whole(entropies, visible)
        measures = {"entropy": entropies, "coverage": visible.astype(float)}
        sums = {name: self._by_zone.by_run(values) for name, values in measures.items()}
        return Score(
            entropy,
            coverage,
            self._standard_error(entropies, sums["entropy"][0], len(rig.groups)),
            per_class=self._classes(**measures),
            per_zone=self._zones(**sums),
            per_sensor={},
            voxels=len(self._sample.index),
            scatter=Scatter(self._digest, self._by_zone.residuals(sums)),
        )

    def _whole(self, entropies: Floats, visible: NDArray[np.bool_]) -> tuple[float, float]:
        """Return mean entropy and coverage."""
        return rounded(float(np.mean(entropies))), rounded(float(np.mean(visible)))

    def _zones(self, entropy: Floats, coverage: Floats) -> dict[str, PartScore]:
        """Return the score by zone, from the sums by run of the rig and of each zone."""
        entropies = self._by_zone.means(entropy)[1:]  # the rig is first
        coverages = self._by_zone.means(coverage)[1:]
        rows = zip(self._shares.items(), entropies, coverages, strict=True)
        return {name: PartScore(rounded(h), rounded(c), share) for (name, share), h, c in rows}

    def _classes(self, entropy: Floats, coverage: Floats) -> dict[str, PartScore]:
        """Return the score by class; a voxel counts by the probability that its object is of it."""
        per_class = {}
        product = np.empty(len(entropy))  # reused: the first writes to new memory are slow
        rows = zip(self._sample.names, self._by_class, self._class_masses, strict=True)
        for name, likely, mass in rows:
            if mass > 0.0:
                # Not by BLAS: on small products its threads only wait for each other.
                h, c = (
                    float(np.multiply(values, likely, out=product).sum()) / mass
                    for values in (entropy, coverage)
                )
                per_class[name] = PartScore(rounded(h), rounded(c), rounded(mass / len(likely)))
        return per_class

    def _class_residuals(
        self, entropies: Floats, visible: NDArray[np.bool_]
    ) -> dict[FigureKey, tuple[float, ...]]:
        """Return the residuals of entropy and coverage of each class."""
        by_class = dict(zip(self._sample.names, self._sample.classes.T, strict=True))
        return {
            ("class", name, measure): residuals(values, likely, self._sample.run, BLOCKS)
            for measure, values in (("entropy", entropies), ("coverage", visible.astype(float)))
            for name, likely in by_class.items()
            if likely.any()
        }

    def _without_each(self, rig: Rig) -> dict[str, float]:
        """Return the entropy of the rig without each sensor [nats], by name."""
        names = [s.name for s in rig]
        if len(names) == 1:
            return {names[0]: H_BLIND}
        if not adds_up(self._fusion):
            rests = {name: [other for other in names if other != name] for name in names}
            return {n: self._whole(*self._entropies(rig, rest))[0] for n, rest in rests.items()}
        groups = members_of(rig, self._sensors.m)
        means = mean_without_each(self._fusion, groups, self._distance)
        in_order = [s.name for sensors in rig.groups.values() for s in sensors]
        return dict(zip(in_order, map(rounded, means.tolist()), strict=True))

    def _sensor(
        self, sensor: Sensor, rig: Rig, lost: float, progress: ScoreProgress
    ) -> SensorScore:
        alone, coverage = self._whole(*self._entropies(rig, [sensor.name]))
        occlusion = self._sensors.occlusion(sensor)
        progress.add(1.0 / SENSORS_FUSED)
        return sensor_score(alone, coverage, rounded(lost), occlusion)

    def _standard_error(self, entropies: Floats, by_run: Floats, groups: int) -> float:
        """Return the standard error from the scatter of runs of the sequence, with these sums.

        Each run is a lattice, so this overestimates the error. Where all voxels have equal entropy,
        it is half of the bound by the rule of three, for voxels that may have any entropy from
        blind to the best that all groups can reach.
        """
        if np.ptp(entropies) <= ALIKE:
            return unseen_error(groups, len(entropies))
        sizes = self._by_zone.counts[0]
        means = by_run[sizes > 0] / sizes[sizes > 0]
        return rounded(float(np.std(means, ddof=1)) / np.sqrt(len(means)))

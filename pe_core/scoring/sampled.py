"""Scoring on a sample of voxels: fast, with a standard error."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from threading import RLock
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..kinds import MeasuredByName, Voxels
from ..metric.entropy import H_BEST, H_BLIND
from ..metric.fusion import Fusion
from ..prior.prior import ClassDensity
from ..scene.sensors import Rig, Sensor
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .cases import Cases, together
from .sampling import BLOCKS, CENTERED, VoxelSample, draw
from .scatter import FigureKey, Scatter, residuals, sample_digest
from .score import DECIMALS, Glance, PartScore, Score, SensorScore, rounded, sensor_score
from .subsets import fused_early
from .weights import outside_masses
from .zones import zone_masks

Floats = NDArray[np.float64]

ALIKE = 10.0**-DECIMALS
"""Entropies no farther apart than this do not differ [nats]."""
RULE_OF_THREE = 3.0
"""Of n draws that are all alike, fewer than 3 / n of the rest are not, 95 times in 100."""


class Judgement(NamedTuple):
    """What a candidate is worth: its entropy, or a lower bound of it [nats]."""

    entropy: float
    is_lower_bound: bool


class SampledScorer:
    """Scores rigs on one fixed sample of voxels; a sensor that has not moved is not remeasured.

    One thread at a time: others wait.
    """

    def __init__(
        self,
        space: PerceptionSpace,
        densities: list[ClassDensity],
        vehicle: Vehicle | None,
        fusion: Fusion,
        samples: int,
        shift: tuple[float, float, float] = CENTERED,
    ) -> None:
        self._vehicle, self._fusion = vehicle, fusion
        tops = None if vehicle is None else vehicle.top(space)
        self._sample: VoxelSample = draw(densities, space, samples, tops, shift)
        outside_masses(densities, space, tops)  # complains when nothing is left to weigh
        x, y = self._sample.centers[:, 0], self._sample.centers[:, 1]
        masks = {name: mask for name, mask in zone_masks(x, y).items() if mask.any()}
        self._zones = {n: (np.flatnonzero(m), rounded(float(np.mean(m)))) for n, m in masks.items()}
        voxels = Voxels(space, self._sample.index, self._sample.centers)
        self._sensors = MeasuredByName(voxels, vehicle, fusion.enough)
        self._is_free = RLock()

    @cached_property
    def _digest(self) -> str:
        return sample_digest([self._sample.centers, self._sample.classes])

    def entropy(self, rig: Rig, draft: bool = False) -> float:
        """Perception entropy alone."""
        with self._is_free:
            self._sensors.measure(rig, draft)
            return self._entropy_of(rig, self._sensors.m)

    def judge(self, rig: Rig, below: float) -> Judgement:
        """Perception entropy, or a lower bound of it where that already is not below `below`."""
        with self._is_free:
            asked = below < np.inf and self._vehicle is not None
            bound = self._lower_bound(rig, below) if asked else -np.inf
            if bound >= below:
                return Judgement(bound, True)
            return Judgement(self.entropy(rig), False)

    def _lower_bound(self, rig: Rig, below: float) -> float:
        """Bound a rig's entropy from below, closely enough to tell whether it is `below`.

        The vehicle takes beams and pixels away and adds none, so without it the entropy is no
        higher. It is asked about one moved sensor after the other, as long as that may matter.
        """
        known = {s.name: self._sensors.known(s, False) for s in rig}
        moved = [s for s in rig if known[s.name] is None]
        m = {
            s.name: self._sensors.unhidden(s) if (own := known[s.name]) is None else own.m
            for s in rig
        }
        bound = self._entropy_of(rig, m)
        for sensor in moved[:-1]:
            if bound >= below:
                break
            m[sensor.name] = self._sensors.measure_again(sensor)
            bound = self._entropy_of(rig, m)
        return bound

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Perception entropy of each of several rigs; what they share is measured once."""
        cases = Cases(rigs)
        with self._is_free:
            self._sensors.measure(cases.all)
            m = self._sensors.m
            return [self._entropy_of(part, m) for part in cases.parts]

    def judge_together(self, rigs: Sequence[Rig], below: float, worst: bool) -> Judgement:
        """As `judge`, of the mean of several rigs' entropies, or of the highest."""
        with self._is_free:
            asked = below < np.inf and self._vehicle is not None
            bound = self._bound_together(Cases(rigs), below, worst) if asked else -np.inf
            if bound >= below:
                return Judgement(bound, True)
            return Judgement(together(self.entropies(rigs), worst), False)

    def _bound_together(self, cases: Cases, below: float, worst: bool) -> float:
        """Bound several rigs together as `_lower_bound` does one.

        Half of the moved sensors are asked about at first: fusing each rig anew takes time, too.
        """
        known = {s.name: self._sensors.known(s, False) for s in cases.all}
        moved = [s for s in cases.all if known[s.name] is None]
        m = {
            s.name: self._sensors.unhidden(s) if (own := known[s.name]) is None else own.m
            for s in cases.all
        }
        bound = together([self._entropy_of(part, m) for part in cases.parts], worst)
        some = moved[: len(moved) // 2]
        if bound >= below or not some:
            return bound
        m |= {sensor.name: self._sensors.measure_again(sensor) for sensor in some}
        return together([self._entropy_of(part, m) for part in cases.parts], worst)

    def glance(self, rig: Rig, draft: bool = False) -> Glance:
        """Everything a sampled score tells of the whole rig."""
        with self._is_free:
            self._sensors.measure(rig, draft)
            return self._glance(rig, *self._entropies(rig, [s.name for s in rig]))

    def score(self, rig: Rig, draft: bool = False) -> Score:
        """Everything a sampled score tells."""
        with self._is_free:
            self._sensors.measure(rig, draft)
            values = self._entropies(rig, [s.name for s in rig])
            whole = self._glance(rig, *values)
            return Score(
                whole.entropy,
                whole.coverage,
                whole.stderr,
                whole.per_class,
                whole.per_zone,
                {s.name: self._sensor(s, rig, whole.entropy) for s in rig},
                whole.voxels,
                draft=whole.draft,
                scatter=self._scatter(*values),
            )

    def _entropy_of(self, rig: Rig, measured: Mapping[str, NDArray]) -> float:
        names = [s.name for s in rig]
        return self._whole(*self._fusion.entropies(fused_early(rig, measured, names)))[0]

    def _entropies(self, rig: Rig, members: Collection[str]) -> tuple[Floats, NDArray[np.bool_]]:
        """Entropy of every sampled voxel and whether it is seen, by some of the rig's sensors."""
        return self._fusion.entropies(fused_early(rig, self._sensors.m, members))

    def _glance(self, rig: Rig, entropies: Floats, seen: NDArray[np.bool_]) -> Glance:
        entropy, coverage = self._whole(entropies, seen)
        return Glance(
            entropy,
            coverage,
            self._standard_error(entropies, len(rig.groups)),
            self._classes(entropies, seen),
            self._by_zone(entropies, seen),
            len(self._sample.index),
            any(known.draft for known in self._sensors.last.values()),
        )

    def _whole(self, entropies: Floats, seen: NDArray[np.bool_]) -> tuple[float, float]:
        """Mean entropy and coverage."""
        return rounded(float(np.mean(entropies))), rounded(float(np.mean(seen)))

    def _classes(self, entropies: Floats, seen: NDArray[np.bool_]) -> dict[str, PartScore]:
        """Classes by how likely each sampled voxel's object is of the class."""
        found = {}
        for name, likely in zip(self._sample.names, self._sample.classes.T, strict=True):
            mass = float(likely.sum())
            if mass > 0.0:
                h, c = (float((values * likely).sum()) / mass for values in (entropies, seen))
                found[name] = PartScore(rounded(h), rounded(c), rounded(mass / len(likely)))
        return found

    def _by_zone(self, entropies: Floats, seen: NDArray[np.bool_]) -> dict[str, PartScore]:
        """Zones by the samples in them."""
        return {
            name: PartScore(*self._whole(entropies.take(inside), seen.take(inside)), share)
            for name, (inside, share) in self._zones.items()
        }

    def _scatter(self, entropies: Floats, seen: NDArray[np.bool_]) -> Scatter:
        """Return the residuals of entropy and coverage: of the rig, of zones and classes."""
        found: dict[FigureKey, tuple[float, ...]] = {}
        everywhere = np.arange(len(entropies))
        zones = {name: inside for name, (inside, _) in self._zones.items()}
        by_class = dict(zip(self._sample.names, self._sample.classes.T, strict=True))
        for measure, values in (("entropy", entropies), ("coverage", seen.astype(float))):
            for name, inside in {"": everywhere, **zones}.items():
                batch = self._sample.run[inside]
                group = "zone" if name else "rig"
                found[group, name, measure] = residuals(values[inside], None, batch, BLOCKS)
            for name, likely in by_class.items():
                if likely.any():
                    own = residuals(values, likely, self._sample.run, BLOCKS)
                    found["class", name, measure] = own
        return Scatter(self._digest, found)

    def _sensor(self, sensor: Sensor, rig: Rig, entropy: float) -> SensorScore:
        alone, coverage = self._whole(*self._entropies(rig, [sensor.name]))
        others = [s.name for s in rig if s.name != sensor.name]
        failed = self._whole(*self._entropies(rig, others))[0] if others else H_BLIND
        stopped = self._sensors.stopped(sensor)
        return sensor_score(alone, coverage, rounded(failed - entropy), stopped)

    def _standard_error(self, entropies: Floats, groups: int) -> float:
        """From the scatter of runs of the sequence: each is a lattice, so this errs high.

        Where no two voxels differ, half of what is left to doubt by the rule of three, if a voxel
        that was not drawn may be anything from blind to seen by all groups as well as can be.
        """
        if np.ptp(entropies) <= ALIKE:
            most = H_BLIND - H_BEST + np.log(groups)
            return rounded(RULE_OF_THREE / 2.0 * most / len(entropies))
        run = self._sample.run
        sums, sizes = np.bincount(run, entropies, BLOCKS), np.bincount(run, minlength=BLOCKS)
        means = sums[sizes > 0] / sizes[sizes > 0]
        return rounded(float(np.std(means, ddof=1)) / np.sqrt(len(means)))

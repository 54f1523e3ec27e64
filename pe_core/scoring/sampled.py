"""Scoring on a sample of voxels: fast, with a standard error."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from threading import RLock
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..kinds import Measured, SampleKernel, Voxels, kind_of
from ..metric.entropy import H_BLIND
from ..metric.fusion import Fusion
from ..prior.prior import ClassDensity
from ..scene.sensors import Rig, Sensor
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .sampling import BLOCKS, CENTERED, VoxelSample, draw
from .score import PartScore, Score, SensorScore, rounded, sensor_score
from .subsets import fused_early
from .weights import outside_masses
from .zones import zone_masks

Floats = NDArray[np.float64]


class Judgement(NamedTuple):
    """What a candidate is worth: its entropy, or a lower bound of it [nats]."""

    entropy: float
    is_lower_bound: bool


class SampledScorer:
    """Scores rigs on one fixed sample of voxels; a sensor that has not moved is not remeasured.

    What was measured last is kept by the sensor's name, for the sensors of the last rig. One thread
    at a time: others wait.
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
        self._space, self._vehicle, self._fusion = space, vehicle, fusion
        tops = None if vehicle is None else vehicle.top(space)
        self._sample: VoxelSample = draw(densities, space, samples, tops, shift)
        outside_masses(densities, space, tops)  # complains when nothing is left to weigh
        self._kernels: dict[str, SampleKernel] = {}  # by kind: as many as there are
        self._measured: dict[str, Measured] = {}  # by sensor name: those of the last rig
        self._is_free = RLock()

    def entropy(self, rig: Rig, draft: bool = False) -> float:
        """Perception entropy alone."""
        with self._is_free:
            self._measure(rig, draft)
            return self._entropy_of(rig, {name: known.m for name, known in self._measured.items()})

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
        moved = [s for s in rig if self._known(s, False) is None]
        m = {
            s.name: self._kernel(s).unhidden(s) if s in moved else self._measured[s.name].m
            for s in rig
        }
        bound = self._entropy_of(rig, m)
        for sensor in moved[:-1]:
            if bound >= below:
                break
            self._measured[sensor.name] = self._kernel(sensor).measure(sensor, False)
            m[sensor.name] = self._measured[sensor.name].m
            bound = self._entropy_of(rig, m)
        return bound

    def score(self, rig: Rig, draft: bool = False) -> Score:
        """Everything a sampled score tells."""
        with self._is_free:
            self._measure(rig, draft)
            entropies, seen = self._entropies(rig, [s.name for s in rig])
            entropy, coverage = self._whole(entropies, seen)
            return Score(
                entropy,
                coverage,
                self._standard_error(entropies),
                self._classes(entropies, seen),
                self._zones(entropies, seen),
                {s.name: self._sensor(s, rig, entropy) for s in rig},
                len(self._sample.index),
                draft=any(known.draft for known in self._measured.values()),
            )

    def _kernel(self, sensor: Sensor) -> SampleKernel:
        """Return what measures sensors of its kind."""
        kind = kind_of(sensor)
        if kind.name not in self._kernels:
            voxels = Voxels(self._space, self._sample.index, self._sample.centers)
            enough = self._fusion.enough(kind.name)
            self._kernels[kind.name] = kind.on_sample(voxels, self._vehicle, enough)
        return self._kernels[kind.name]

    def _measure(self, rig: Rig, draft: bool) -> None:
        """Measure what has moved, or is known as a draft only and now asked for in earnest."""
        self._measured = {
            s.name: self._known(s, draft) or self._kernel(s).measure(s, draft) for s in rig
        }
        for kernel in self._kernels.values():
            kernel.forget_all_but(rig.sensors)

    def _known(self, sensor: Sensor, draft: bool) -> Measured | None:
        known = self._measured.get(sensor.name)
        fits = known and (draft or not known.draft) and known.sensor.model is sensor.model
        return known if known and fits and known.sensor.pose == sensor.pose else None

    def _entropy_of(self, rig: Rig, measured: Mapping[str, NDArray]) -> float:
        names = [s.name for s in rig]
        return self._whole(*self._fusion.entropies(fused_early(rig, measured, names)))[0]

    def _entropies(self, rig: Rig, members: Collection[str]) -> tuple[Floats, NDArray[np.bool_]]:
        """Entropy of every sampled voxel and whether it is seen, by some of the rig's sensors."""
        measured = {name: known.m for name, known in self._measured.items()}
        return self._fusion.entropies(fused_early(rig, measured, members))

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

    def _zones(self, entropies: Floats, seen: NDArray[np.bool_]) -> dict[str, PartScore]:
        """Zones by the samples in them."""
        x, y = self._sample.centers[:, 0], self._sample.centers[:, 1]
        return {
            name: PartScore(
                *self._whole(entropies[mask], seen[mask]), rounded(float(np.mean(mask)))
            )
            for name, mask in zone_masks(x, y).items()
            if mask.any()
        }

    def _sensor(self, sensor: Sensor, rig: Rig, entropy: float) -> SensorScore:
        alone, coverage = self._whole(*self._entropies(rig, [sensor.name]))
        others = [s.name for s in rig if s.name != sensor.name]
        failed = self._whole(*self._entropies(rig, others))[0] if others else H_BLIND
        stopped = self._kernel(sensor).stopped(self._measured[sensor.name])
        return sensor_score(alone, coverage, rounded(failed - entropy), stopped)

    def _standard_error(self, entropies: Floats) -> float:
        """From the scatter of runs of the sequence: each is a lattice, so this errs high."""
        run = self._sample.run
        sums, sizes = np.bincount(run, entropies, BLOCKS), np.bincount(run, minlength=BLOCKS)
        means = sums[sizes > 0] / sizes[sizes > 0]
        return rounded(float(np.std(means, ddof=1)) / np.sqrt(len(means)))

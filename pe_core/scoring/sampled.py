"""Scoring on a sample of voxels: fast, with a standard error."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..kinds.camera.model import Camera
from ..kinds.camera.points import pixel_areas
from ..kinds.lidar.beams import BeamEnds, TurnedBeams, beam_counts
from ..kinds.lidar.model import Lidar
from ..kinds.lidar.points import Lattice, VoxelPoints, count_beams
from ..kinds.lidar.ties import position_in_voxels
from ..metric.entropy import H_BLIND
from ..metric.fusion import Fusion
from ..prior.prior import ClassDensity
from ..scene.sensors import Rig, Sensor
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .sampling import BLOCKS, CENTERED, VoxelSample, draw
from .score import PartScore, Score, SensorScore, rounded
from .subsets import fused_early
from .weights import outside_masses
from .zones import zone_masks

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Measured:
    """A sensor as it was measured: `m` (V,), and whether the vehicle's part in it is a draft."""

    sensor: Sensor
    m: NDArray
    draft: bool


class SampledScorer:
    """Scores rigs on one fixed sample of voxels; a sensor that has not moved is not remeasured."""

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
        self._points = VoxelPoints(self._sample.index)
        outside_masses(densities, space, tops)  # complains when nothing is left to weigh
        self._lattices: dict[Lidar, Lattice] = {}
        self._measured: dict[str, Measured] = {}
        self._beams: dict[str, tuple[Sensor, TurnedBeams]] = {}
        self._ends = BeamEnds(vehicle)

    def entropy(self, rig: Rig, draft: bool = False, below: float = math.inf) -> float:
        """Perception entropy alone: what an optimizer asks for, with what it has to be `below`."""
        if below < math.inf and self._vehicle is not None and not draft:
            bound = self._bound(rig, below)
            if bound >= below:
                return bound
        self._measure(rig, draft)
        return self._entropy_of({name: known.m for name, known in self._measured.items()}, rig)

    def _bound(self, rig: Rig, below: float) -> float:
        """Bound a rig's entropy from below, closely enough to tell whether it is `below`.

        The vehicle takes beams and pixels away and adds none, so without it the entropy is no
        higher. It is asked about one moved sensor after the other, as long as that may matter.
        """
        moved = [s for s in rig if self._known(s, False) is None]
        m = {s.name: self._free(s) if s in moved else self._measured[s.name].m for s in rig}
        bound = self._entropy_of(m, rig)
        for sensor in moved[:-1]:
            if bound >= below:
                break
            self._measured[sensor.name] = self._new(sensor, False)
            m[sensor.name] = self._measured[sensor.name].m
            bound = self._entropy_of(m, rig)
        return bound

    def _free(self, sensor: Sensor) -> NDArray:
        """Measure a sensor as if there were no vehicle."""
        if sensor.kind == "camera":
            return self._pixels(sensor, None)
        max_range = cast(Lidar, sensor.model).max_range
        beams = self._turned(sensor)
        return self._count(sensor, beams, np.full(len(beams.directions), max_range))

    def _entropy_of(self, measured: Mapping[str, NDArray], rig: Rig) -> float:
        names = [s.name for s in rig]
        return self._whole(*self._fusion.entropies(fused_early(rig, measured, names)))[0]

    def score(self, rig: Rig, draft: bool = False) -> Score:
        """Everything a sampled score tells."""
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

    def _measure(self, rig: Rig, draft: bool) -> None:
        """Measure what has moved, or is known as a draft only and now asked for in earnest."""
        self._measured = {s.name: self._known(s, draft) or self._new(s, draft) for s in rig}
        self._beams = {name: kept for name, kept in self._beams.items() if name in self._measured}

    def _known(self, sensor: Sensor, draft: bool) -> Measured | None:
        known = self._measured.get(sensor.name)
        fits = known and (draft or not known.draft) and known.sensor.model is sensor.model
        return known if known and fits and known.sensor.pose == sensor.pose else None

    def _new(self, sensor: Sensor, draft: bool) -> Measured:
        if sensor.kind == "camera":
            return Measured(sensor, self._pixels(sensor, self._vehicle), False)
        draft, beams = draft and self._ends.can_draft(sensor), self._turned(sensor)
        return Measured(
            sensor, self._count(sensor, beams, self._ends.of(sensor, beams, draft)), draft
        )

    def _entropies(self, rig: Rig, members: Collection[str]) -> tuple[Floats, NDArray[np.bool_]]:
        """Entropy of every sampled voxel and whether it is seen, by some of the rig's sensors."""
        measured = {name: known.m for name, known in self._measured.items()}
        return self._fusion.entropies(fused_early(rig, measured, members))

    def _count(self, sensor: Sensor, beams: TurnedBeams, ends: Floats) -> NDArray:
        model = cast(Lidar, sensor.model)
        if model not in self._lattices:
            self._lattices[model] = Lattice.of(model)
        side = self._space.interval
        return count_beams(
            self._points,
            position_in_voxels(sensor.pose.position, self._space.origin, side),
            self._lattices[model],
            sensor.pose.ground_from_sensor,
            beams.without_zeros,
            ends / side,
            self._fusion.enough,
        )

    def _turned(self, sensor: Sensor) -> TurnedBeams:
        """Return a LiDAR's beams, kept until it turns."""
        known = self._beams.get(sensor.name)
        if known and known[0].model is sensor.model and known[0].pose.rpy == sensor.pose.rpy:
            return known[1]
        beams = TurnedBeams.of(sensor)
        self._beams[sensor.name] = (sensor, beams)
        return beams

    def _pixels(self, sensor: Sensor, vehicle: Vehicle | None) -> NDArray:
        seen = (
            None if vehicle is None else vehicle.seen_from(sensor.pose.position, through_glass=True)
        )
        return pixel_areas(
            cast(Camera, sensor.model),
            sensor.pose,
            self._sample.centers,
            self._space.interval,
            seen,
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
        counts = beam_counts(sensor, self._vehicle)
        return SensorScore(alone, coverage, rounded(failed - entropy), *counts)

    def _standard_error(self, entropies: Floats) -> float:
        """From the scatter of runs of the sequence: each is a lattice, so this errs high."""
        run = self._sample.run
        sums, sizes = np.bincount(run, entropies, BLOCKS), np.bincount(run, minlength=BLOCKS)
        means = sums[sizes > 0] / sizes[sizes > 0]
        return rounded(float(np.std(means, ddof=1)) / np.sqrt(len(means)))

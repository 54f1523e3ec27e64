"""Scoring on a sample of voxels: fast, with a standard error."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from .fusion import Fusion
from .kernels.camera_points import pixel_areas
from .kernels.lidar_points import Lattice, count_beams
from .kernels.ties import offsets_in_voxels, without_zeros
from .occlusion import beam_counts, beam_field
from .prior import ClassDensity
from .sampling import BLOCKS, VoxelSample, draw
from .score import ClassScore, Score, SensorScore, rounded
from .sensors import Camera, Lidar, Rig, Sensor
from .space import PerceptionSpace
from .vehicle import Vehicle
from .weights import outside_shares

Floats = NDArray[np.float64]


class SampledScorer:
    """Scores rigs on one fixed sample of voxels; a sensor that has not moved is not remeasured."""

    def __init__(
        self,
        space: PerceptionSpace,
        densities: list[ClassDensity],
        vehicle: Vehicle | None,
        fusion: Fusion,
        samples: int,
    ) -> None:
        self._space, self._vehicle, self._fusion = space, vehicle, fusion
        tops = None if vehicle is None else vehicle.top(space)
        self._sample: VoxelSample = draw(densities, space, samples, tops)
        self._shares = outside_shares(densities, space, tops)
        self._lattices: dict[Lidar, Lattice] = {}
        self._measured: dict[str, tuple[Sensor, NDArray]] = {}

    def entropy(self, rig: Rig) -> float:
        """Perception entropy alone: what an optimizer asks for."""
        return self._summary(*self._entropies(rig))[0]

    def score(self, rig: Rig) -> Score:
        """Everything a sampled score tells."""
        entropies, seen = self._entropies(rig)
        entropy, coverage, classes = self._summary(entropies, seen)
        return Score(
            entropy,
            coverage,
            self._standard_error(entropies),
            classes,
            {s.name: self._alone(s) for s in rig},
            len(self._sample.index),
        )

    def _entropies(self, rig: Rig) -> tuple[Floats, NDArray[np.bool_]]:
        groups = [
            (members[0].kind, np.sum([self._measure(s) for s in members], axis=0))
            for members in rig.groups.values()
        ]
        self._measured = {s.name: self._measured[s.name] for s in rig}
        return self._fusion.entropies(groups)

    def _measure(self, sensor: Sensor) -> NDArray:
        known = self._measured.get(sensor.name)
        if known and known[0].model is sensor.model and known[0].pose == sensor.pose:
            return known[1]
        m = self._count(sensor) if sensor.kind == "lidar" else self._pixels(sensor)
        self._measured[sensor.name] = (sensor, m)
        return m

    def _count(self, sensor: Sensor) -> NDArray:
        model = cast(Lidar, sensor.model)
        if model not in self._lattices:
            self._lattices[model] = Lattice.of(model)
        field = beam_field(sensor, self._vehicle)
        side = self._space.interval
        return count_beams(
            offsets_in_voxels(self._sample.centers, sensor.pose.position, side),
            self._lattices[model],
            sensor.pose.ground_from_sensor,
            without_zeros(field.directions),
            field.ends / side,
        )

    def _pixels(self, sensor: Sensor) -> NDArray:
        vehicle = self._vehicle
        seen = None if vehicle is None else vehicle.seen_from(sensor.pose.position, "camera")
        return pixel_areas(
            cast(Camera, sensor.model),
            sensor.pose,
            self._sample.centers,
            self._space.interval,
            seen,
        )

    def _summary(
        self, entropies: Floats, seen: NDArray[np.bool_]
    ) -> tuple[float, float, dict[str, ClassScore]]:
        classes = {}
        entropy = coverage = 0.0
        for name, some, share in zip(
            self._sample.names, self._sample.slices, self._shares, strict=True
        ):
            if some.stop == some.start:
                continue
            h, c = float(np.mean(entropies[some])), float(np.mean(seen[some]))
            entropy, coverage = entropy + share * h, coverage + share * c
            classes[name] = ClassScore(rounded(h), rounded(c), rounded(share))
        return rounded(entropy), rounded(coverage), classes

    def _alone(self, sensor: Sensor) -> SensorScore:
        entropies, seen = self._fusion.entropies([(sensor.kind, self._measure(sensor))])
        entropy, coverage, _ = self._summary(entropies, seen)
        return SensorScore(entropy, coverage, *beam_counts(sensor, self._vehicle))

    def _standard_error(self, entropies: Floats) -> float:
        """From the scatter of runs of the sequence: each is a lattice, so this errs high."""
        variance = 0.0
        for some, share in zip(self._sample.slices, self._shares, strict=True):
            blocks = [b for b in np.array_split(entropies[some], BLOCKS) if len(b)]
            if len(blocks) > 1:
                means = [float(np.mean(b)) for b in blocks]
                variance += share**2 * float(np.var(means, ddof=1)) / len(blocks)
        return rounded(float(np.sqrt(variance)))

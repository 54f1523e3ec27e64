"""What the engine says of a rig: its scores by outcome, and pixels on objects in traffic.

All by the plan: default settings, all voxels of 0.1 m, a plate as the body.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core.base import Floats
from pe_core.metric import H_BLIND
from pe_core.metric.fusion import early_fusion
from pe_core.scoring.sight import Sight
from pe_core.scoring.targets import ObjectEvaluator, TargetRule
from pe_core.sensors import ObjectMeasurementCache

from ..paper.paper import STUDIES
from ..published.scores import box_triangles
from ..results_file import Json
from .published_rigs import PLATE_M, SIZES_M, PublishedRig

PLATE = "plate"
SEDAN = "sedan"
CLEARANCE_M = 0.3
ENTROPY = "entropy"
COVERAGE = "coverage"
EXPECTED_AP = "expected AP in traffic"
SEEN = "entropy of the seen"
BLIND_SECTOR = "blind sector"
SCORES = (ENTROPY, COVERAGE, EXPECTED_AP, SEEN, BLIND_SECTOR)
"""The scores of the plan in its order; higher is better for all."""
CLASS_OF = {"car": "car", "adult": "pedestrian", "mAP": ""}
"""The engine's class of an outcome; empty: all classes."""
WITHIN_M = {"car": 50.0, "adult": 40.0, "mAP": 50.0}
CARS_OUTCOME = "car"
CURVES = ("car", "adult")
"""Outcomes for which a curve is fitted."""
HEIGHT_M = 5.0


@dataclass(frozen=True)
class CameraEffort:
    """How much is computed; `interval` is the side of the voxels [m]."""

    seed: int = 20261129
    interval: float = 0.1
    scenes: int = 500
    permutations: int = 99_999
    resamples: int = 4000


def seen_entropy(entropy: float, coverage: float) -> float | None:
    """Return (PE - (1 - c) H_blind) / c, the mean entropy of what is seen; None where nothing is.

    `entropy` is PE [nats], `coverage` c in 0 to 1.
    """
    return None if coverage <= 0.0 else (entropy - (1.0 - coverage) * H_BLIND) / coverage


def scored_rig(rig: PublishedRig, body: str, effort: CameraEffort) -> Json:
    """Return the scores of a rig by outcome, and by class m and weight of the objects it sees.

    On another body than the plate, only the scores of cars.
    """
    found: Json = {"scores": {}, "pixels": {}}
    outcomes = tuple(CLASS_OF) if body == PLATE else (CARS_OUTCOME,)
    blind = _blind_sector(rig, body, effort)
    by_space = {
        within: _Measured.of(rig, body, within, effort)
        for within in sorted({WITHIN_M[outcome] for outcome in outcomes})
    }
    for outcome in outcomes:
        measured = by_space[WITHIN_M[outcome]]
        found["scores"][outcome] = measured.scores(CLASS_OF[outcome], blind)
        if outcome in CURVES and body == PLATE:
            found["pixels"][outcome] = measured.pixels(CLASS_OF[outcome], WITHIN_M[outcome])
    return found


def _blind_sector(rig: PublishedRig, body: str, effort: CameraEffort) -> float:
    """Return the width of the widest blind sector of the heights [deg]."""
    space = space_within(WITHIN_M[CARS_OUTCOME], effort.interval)
    sight = Sight(space, pe.Prior.road(), body_of(rig.vehicle, body))
    return max(sector.width for sector in sight.blind_sectors(rig.rig))


@dataclass(frozen=True, eq=False)
class _Measured:
    """A rig in the space within a distance: on voxels, and on objects."""

    voxels: pe.Score
    objects: pe.Score
    targets: ObjectEvaluator
    m: Floats

    @classmethod
    def of(cls, rig: PublishedRig, body: str, within: float, effort: CameraEffort) -> _Measured:
        space = space_within(within, effort.interval)
        vehicle = body_of(rig.vehicle, body)
        targets = targets_on(rig.vehicle, body, within, effort)
        cache = ObjectMeasurementCache(targets.drawn.objects, vehicle, True)
        return cls(
            pe.Evaluator(space, pe.Prior.road(), vehicle).summary(rig.rig),
            targets.score(rig.rig),
            targets,
            early_fusion(list(cache.measure(rig.rig).values())),
        )

    def scores(self, name: str, blind_sector: float) -> dict[str, float | None]:
        """Return the scores of the plan, higher for better, of a class or of all."""
        voxels = self.voxels.per_class[name] if name else self.voxels
        of_objects = self.objects.objects
        assert of_objects is not None
        seen = seen_entropy(voxels.entropy, voxels.coverage)
        return {
            ENTROPY: -voxels.entropy,
            COVERAGE: voxels.coverage,
            EXPECTED_AP: of_objects.per_class[name].ap if name else of_objects.ap,
            SEEN: None if seen is None else -seen,
            BLIND_SECTOR: -blind_sector,
        }

    def pixels(self, name: str, within: float) -> dict[str, list[float]]:
        """Return m and weight of the objects of a class that are seen, within a distance [m]."""
        objects = self.targets.drawn.objects
        near = np.hypot(*objects.centers[:, :2].T) <= within
        of_class = objects.labels == objects.class_names.index(name)
        rows = near & of_class & (self.m > 0.0)
        weights = self.targets.drawn.weights[rows]
        return {"m": self.m[rows].tolist(), "weights": weights.tolist()}


def space_within(distance: float, interval: float) -> pe.PerceptionSpace:
    """Return the space of x and y within a distance [m]."""
    along = (-distance, distance)
    return pe.PerceptionSpace(along, along, (0.0, HEIGHT_M), interval)


def body_of(vehicle: str, body: str) -> pe.Vehicle:
    """Return the plate of a vehicle, or the shipped sedan in its size with the clearance."""
    length, width = SIZES_M[vehicle]
    if body == PLATE:
        center = (0.0, 0.0, PLATE_M / 2.0)
        return pe.Vehicle(box_triangles(center, (length, width, PLATE_M), 0.0))
    mesh = pt.read_mesh(STUDIES.parent / f"{SEDAN}.npz")
    low, high = (edge(mesh.triangles.reshape(-1, 3), axis=0) for edge in (np.min, np.max))
    along = length / (high - low)[0]
    factors = np.array([along, width / (high - low)[1], along])
    return pe.Vehicle(mesh.triangles * factors, mesh.parts, mesh.part_names, clearance=CLEARANCE_M)


@lru_cache(maxsize=2)
def targets_on(vehicle: str, body: str, within: float, effort: CameraEffort) -> ObjectEvaluator:
    """Return the shipped sample of objects in traffic; it is kept for rigs of one vehicle."""
    rule = TargetRule("objects", True, effort.scenes)
    space = space_within(within, effort.interval)
    return ObjectEvaluator(space, pe.Prior.road(), body_of(vehicle, body), targets=rule)


def values_of_score(scores: Mapping[str, Json], outcome: str, score: str) -> Floats | None:
    """Return the values (R,) of a score by rig; None where one of them is undefined."""
    values = [by_outcome[outcome][score] for by_outcome in scores.values()]
    return None if None in values else np.array(values, dtype=float)

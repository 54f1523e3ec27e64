"""One run of the study: scenes are cast, a detector is trained and tested. It needs TensorFlow."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..results_file import made_by
from .batches import FEATURES, LAYERS
from .casting import Caster, RegionObjects, RegionVoxels
from .detector import Detector, Network, grid_network, points_network, versions
from .placements import Placement, placements
from .plan import FIXED, MIXED, POINTS, SPLITS, StudyPlan
from .result_files import run_digest
from .runs import Run
from .scenes import CLASSES
from .training import results, test_scenes, timed_training

Json = dict[str, Any]

TRAIN, VALIDATION, TEST = SPLITS


@dataclass(frozen=True)
class RunIdentity:
    """What `made_by` notes of a run besides the versions."""

    run: str
    plan: str


def run_one(plan: StudyPlan, run: Run) -> Json:
    """Return the results of a run as JSON data.

    Parameters
    ----------
    plan : StudyPlan
    run : Run
    """
    started = time.process_time()
    detector = Detector(_network(plan, run.detector), plan.training.rate, plan.training.average)
    compute = _mixed if run.placement is None else _of_placement
    return with_origin(compute(plan, run, detector), run.name, plan.digest, started)


def with_origin(data: Json, name: str, digest: str, started: float) -> Json:
    """Return the results of a run with its time and what made them.

    Parameters
    ----------
    data : dict
    name, digest : str
        Of the run and of its plan.
    started : float
        Processor time at its beginning [s].
    """
    made = {**made_by(RunIdentity(name, digest)), **versions()}
    made["digest"] = run_digest(digest, {k: made[k] for k in ("python", "numpy", "tensorflow")})
    seconds = round(time.process_time() - started, 1)
    return {**data, "seconds": seconds, "made": made}


def _network(plan: StudyPlan, name: str) -> Network:
    if name == POINTS:
        return points_network(FEATURES, plan.region.shape, len(CLASSES))
    return grid_network(LAYERS, len(CLASSES))


def _of_placement(plan: StudyPlan, run: Run, detector: Detector) -> Json:
    """Train and test a detector with one placement's points."""
    assert run.placement is not None
    placement, counts = run.placement, plan.scenes.counts
    scenes: dict[str, Sequence[RegionObjects]]
    if run.detector == POINTS:
        caster = Caster(plan, placement, run.world)
        scenes = {s: [caster.cloud(s, k) for k in range(counts[s])] for s in SPLITS}
    else:
        scenes = {s: _cast(plan, placement, run.world, s, counts[s]) for s in SPLITS}
    trained, training = timed_training(detector, plan, scenes[TRAIN], scenes[VALIDATION], run.seed)
    tested = test_scenes(detector, trained.weights, plan, scenes[TEST])
    return {**results(plan, scenes[TEST], tested), "training": training}


def _mixed(plan: StudyPlan, run: Run, detector: Detector) -> Json:
    """Train one detector with many placements, and test it with each, and with others."""
    trained_with, fresh = mixed_placements(plan)
    counts = {TRAIN: plan.mixed["scenes"], VALIDATION: plan.scenes.counts[VALIDATION]}
    scenes = {s: _cast_in_turn(plan, trained_with, run.world, s, n) for s, n in counts.items()}
    trained, training = timed_training(detector, plan, scenes[TRAIN], scenes[VALIDATION], run.seed)
    by_placement = {}
    for placement in (*trained_with, *fresh):
        test = _cast(plan, placement, run.world, TEST, plan.mixed["test_scenes"])
        tested = test_scenes(detector, trained.weights, plan, test)
        found = results(plan, test, tested)
        kept = {key: found[key] for key in ("ap", "by_class")}
        by_placement[placement.name] = {**kept, "trained_with": placement in trained_with}
    return {"placements": by_placement, "training": training}


def mixed_placements(plan: StudyPlan) -> tuple[list[Placement], list[Placement]]:
    """Return the placements that the mixed detector is trained with, and fresh ones."""
    drawn = placements(plan)
    by_vehicle = [[p for p in drawn if p.design == MIXED and p.vehicle == v] for v in plan.vehicles]
    each = plan.mixed["trained"] // len(plan.vehicles)
    trained = [
        p for turn in zip(*(group[:each] for group in by_vehicle), strict=True) for p in turn
    ]
    fresh = [p for group in by_vehicle for p in group[each:]]
    return trained, [*(p for p in drawn if p.design == FIXED), *fresh]


def _cast(
    plan: StudyPlan, placement: Placement, world: str, split: str, count: int
) -> list[RegionVoxels]:
    caster = Caster(plan, placement, world)
    return [caster.voxels(split, k) for k in range(count)]


def _cast_in_turn(
    plan: StudyPlan, chosen: list[Placement], world: str, split: str, count: int
) -> list[RegionVoxels]:
    casters = [Caster(plan, placement, world) for placement in chosen]
    return [casters[k % len(casters)].voxels(split, k) for k in range(count)]

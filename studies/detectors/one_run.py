"""One run of a study: scenes are made, a detector is trained and tested. It needs TensorFlow."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from ..results_file import Json, made_by
from .batches import FEATURES, LAYERS
from .cameras.lifting import Lifting
from .cameras.network import pictures_network
from .cameras.plan import CameraPlan
from .cameras.rendering import Renderer
from .casting import Caster, RegionObjects, SceneSource
from .detector import Detector, Network, grid_network, points_network, versions
from .frames.moving import FramesCaster
from .frames.plan import FramesPlan
from .placements import Placement, placements
from .plan import FIXED, MIXED, PLAIN, POINTS, SPLITS, StudyPlan
from .precision import results
from .runs import Run, run_digest
from .scenes import CLASSES, scene
from .training import tested, train

TRAIN, VALIDATION, TEST = SPLITS
BySplit = dict[str, list[RegionObjects]]


@dataclass(frozen=True)
class RunIdentity:
    """What `made_by` notes of a run besides the versions."""

    run: str
    plan: str


def run_one(plan: StudyPlan, run: Run) -> Json:
    """Return the results of a run of LiDARs as JSON data."""
    started = time.process_time()
    network = grid_network(LAYERS, len(CLASSES))
    if run.detector == POINTS:
        network = points_network(FEATURES, plan.region.shape, len(CLASSES))
    if run.placement is None:
        trained_with, fresh = mixed_placements(plan)
        chosen, count = [*trained_with, *fresh], plan.mixed["test_scenes"]
        found = _mixed(plan, run, _detector(plan, network), chosen, count)
    else:
        caster = Caster(plan, run.placement, run.world)
        make = caster.cloud if run.detector == POINTS else caster.voxels
        counts = plan.scenes.counts
        scenes: BySplit = {s: [make(s, k) for k in range(counts[s])] for s in SPLITS}
        found = _of_placement(plan, run, _detector(plan, network), scenes)
    return _with_origin(found, run, plan, started)


def run_camera(plan: CameraPlan, run: Run) -> Json:
    """Return the results of a run of cameras as JSON data."""
    started = time.process_time()
    assert run.placement is not None
    renderer = Renderer(plan, run.placement)
    scenes: BySplit = {
        split: [renderer.pictures(split, number) for number in range(plan.scenes[split])]
        for split in SPLITS
    }
    network = pictures_network(Lifting.of(plan, run.placement), len(CLASSES))
    found = _of_placement(plan.study, run, _detector(plan.study, network), scenes)
    return _with_origin(found, run, plan.study, started)


def run_frames(plan: FramesPlan, run: Run) -> Json:
    """Return the results of a detector with all frames; `one_frame` has those with the last one."""
    started = time.process_time()
    assert run.placement is not None
    caster, counts = FramesCaster(plan, run.placement), plan.study.scenes.counts
    both = {s: [caster.voxels(s, k) for k in range(counts[s])] for s in SPLITS}
    arms = []
    for arm in range(2):
        scenes: BySplit = {s: [of_scene[arm] for of_scene in both[s]] for s in SPLITS}
        network = grid_network((1 + arm) * LAYERS, len(CLASSES))
        arms.append(_of_placement(plan.study, run, _detector(plan.study, network), scenes))
    return _with_origin({**arms[1], "one_frame": arms[0]}, run, plan.study, started)


def run_layouts(
    plan: StudyPlan, run: Run, chosen: Sequence[Placement], count: int, source: SceneSource
) -> Json:
    """Return the results of the mixed detector at placements in so many scenes of a source."""
    started = time.process_time()
    detector = _detector(plan, grid_network(LAYERS, len(CLASSES)))
    return _with_origin(_mixed(plan, run, detector, chosen, count, source), run, plan, started)


def _detector(plan: StudyPlan, network: Network) -> Detector:
    return Detector(network, plan.training.rate, plan.training.average)


def _with_origin(data: Json, run: Run, plan: StudyPlan, started: float) -> Json:
    """Return the results of a run with its processor time and what made them."""
    made = {**made_by(RunIdentity(run.name, plan.digest)), **versions()}
    libraries = {k: made[k] for k in ("python", "numpy", "tensorflow")}
    made["digest"] = run_digest(plan.digest, libraries)
    return {**data, "seconds": round(time.process_time() - started, 1), "made": made}


def _of_placement(plan: StudyPlan, run: Run, detector: Detector, scenes: BySplit) -> Json:
    """Train and test a detector with what one placement sees."""
    trained, training = train(detector, plan, scenes[TRAIN], scenes[VALIDATION], run.seed)
    found = results(plan, scenes[TEST], tested(detector, trained.weights, plan, scenes[TEST]))
    return {**found, "training": training}


def _mixed(
    plan: StudyPlan,
    run: Run,
    detector: Detector,
    chosen: Sequence[Placement],
    count: int,
    source: SceneSource = scene,
) -> Json:
    """Train one detector with many placements, and test it at some in so many scenes of each."""
    trained_with, _ = mixed_placements(plan)
    counts = {TRAIN: plan.mixed["scenes"], VALIDATION: plan.scenes.counts[VALIDATION]}
    casters = [Caster(plan, placement, PLAIN) for placement in trained_with]
    scenes = {
        split: [casters[k % len(casters)].voxels(split, k) for k in range(number)]
        for split, number in counts.items()
    }
    trained, training = train(detector, plan, scenes[TRAIN], scenes[VALIDATION], run.seed)
    by_placement = {}
    for placement in chosen:
        caster = Caster(plan, placement, run.world, source)
        test = [caster.voxels(TEST, k) for k in range(count)]
        found = results(plan, test, tested(detector, trained.weights, plan, test))
        kept = {key: found[key] for key in ("ap", "by_class")}
        by_placement[placement.name] = {**kept, "trained_with": placement in trained_with}
    return {"placements": by_placement, "training": training}


def mixed_placements(plan: StudyPlan) -> tuple[list[Placement], Sequence[Placement]]:
    """Return the placements that the mixed detector is trained with, and fresh ones."""
    drawn = placements(plan)
    by_vehicle = [[p for p in drawn if p.design == MIXED and p.vehicle == v] for v in plan.vehicles]
    each = plan.mixed["trained"] // len(plan.vehicles)
    turns = zip(*(group[:each] for group in by_vehicle), strict=True)
    fresh = [p for group in by_vehicle for p in group[each:]]
    fixed = [p for p in drawn if p.design == FIXED]
    return [p for turn in turns for p in turn], [*fixed, *fresh]

"""A run: scenes are made, a detector is trained until it has converged, and tested.

It needs TensorFlow.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..results_file import Json, made_by
from .batches import FEATURES, NEITHER, ClassScene, Mirrors, detections, inputs, results, targets
from .casting import LAYERS, Caster, FramesCaster, RegionObjects
from .detector import (
    Detector,
    Network,
    TrainingState,
    Weights,
    grid_network,
    pictures_network,
    points_network,
    versions,
)
from .pictures import Lifting, Renderer
from .placements import Placement, good_placements, placements
from .plan import CAMERAS, FIXED, FRAMES, MIXED, PLAIN, POINTS, SPLITS, Plan, shape_of
from .runs import Run, run_digest
from .scenes import CLASSES, Layouts, scene

TRAIN, VALIDATION, TEST = SPLITS
BySplit = dict[str, list[RegionObjects]]


@dataclass(frozen=True, slots=True)
class Trained:
    """The weights with the lowest validation loss, and the loss of the averaged ones by epoch.

    `converged` says whether the rule of the plan ended the training.
    """

    weights: Weights
    losses: list[float]
    converged: bool


def train(
    detector: Detector,
    plan: Plan,
    scenes: Sequence[RegionObjects],
    validation: Sequence[RegionObjects],
    seed: int,
) -> tuple[Trained, Json]:
    """Train a detector, and return with it how that went, as JSON data.

    The seed sets first weights, the order of scenes and the mirroring.
    """
    started = time.process_time()
    rule = plan.training
    rng = np.random.default_rng([seed, 1])
    state = detector.start(seed)
    losses: list[float] = []
    best = state.average
    converged = False
    while len(losses) < rule.max_epochs and not converged:
        _epoch(detector, state, plan, scenes, rng=rng)
        losses.append(_mean_loss(detector, state.average, plan, validation))
        if losses[-1] == min(losses):
            best = state.average
        converged = _has_converged(losses, rule)
    return Trained(best, losses, converged), {
        "epochs": len(losses),
        "converged": converged,
        "validation_losses": losses,
        "training_seconds": round(time.process_time() - started, 1),
    }


def _has_converged(losses: Sequence[float], rule: Plan) -> bool:
    """Whether the loss fell by less than the rule's share within its window."""
    if len(losses) < max(rule.min_epochs, rule.window + 1):
        return False
    return losses[-1] > (1.0 - rule.improvement) * losses[-1 - rule.window]


def _epoch(
    detector: Detector,
    state: TrainingState,
    plan: Plan,
    scenes: Sequence[RegionObjects],
    rng: np.random.Generator,
) -> None:
    size = plan.training.batch
    region = plan.region
    order = rng.permutation(len(scenes))
    for first in range(0, len(order) - size + 1, size):
        batch = [scenes[k] for k in order[first : first + size]]
        mirrors: list[Mirrors] = [NEITHER] * size
        if plan.training.mirrored:
            mirrors = [(bool(a), bool(b)) for a, b in rng.integers(0, 2, (size, 2))]
        detector.train(state, inputs(batch, region, mirrors), targets(batch, region, mirrors))


def _batches(
    scenes: Sequence[RegionObjects], size: int
) -> Iterator[tuple[list[RegionObjects], int]]:
    """Yield batches of one size, and how many of each count: the last is filled by repetition."""
    for first in range(0, len(scenes), size):
        batch = list(scenes[first : first + size])
        yield batch + [batch[-1]] * (size - len(batch)), len(batch)


def _mean_loss(
    detector: Detector, weights: Weights, plan: Plan, scenes: Sequence[RegionObjects]
) -> float:
    size = plan.training.batch
    region = plan.region
    mirrors = [NEITHER] * size
    losses = [
        detector.loss(weights, inputs(batch, region, mirrors), targets(batch, region, mirrors))
        for batch, _ in _batches(scenes, size)
    ]
    return round(float(np.mean(losses)), 6)


def tested(
    detector: Detector, weights: Weights, plan: Plan, scenes: Sequence[RegionObjects]
) -> list[list[ClassScene]]:
    """Return detections and objects of the test's scenes, by class."""
    by_class: list[list[ClassScene]] = [[] for _ in CLASSES]
    size = plan.training.batch
    region = plan.region
    for batch, count in _batches(scenes, size):
        heat, offsets = detector.outputs(weights, inputs(batch, region, [NEITHER] * size))
        for k in range(count):
            for c, (scores, centers) in enumerate(detections(heat[k], offsets[k], region)):
                objects = batch[k].centers[batch[k].labels == c].astype(float)
                by_class[c].append(ClassScene(scores, centers, objects))
    return by_class


@dataclass(frozen=True)
class RunIdentity:
    """What `made_by` notes of a run besides the versions."""

    run: str
    plan: str


def result_of(plan: Plan, run: Run, layouts: Layouts | None = None) -> Json:
    """Return the results of a run as JSON data; a mixed detector is tested in `layouts` if given.

    Results of frames are those of all frames; `one_frame` has those with the last one.
    """
    started = time.process_time()
    if run.placement is None:
        found = _mixed(plan, run, layouts)
    elif run.design == CAMERAS:
        network = pictures_network(Lifting.of(plan, run.placement), len(CLASSES))
        make = Renderer(plan, run.placement).pictures
        counts = plan.cameras.scenes
        found = _of_placement(plan, run, network, _scenes(make, counts))
    elif run.design == FRAMES:
        both = _scenes(FramesCaster(plan, run.placement).voxels, plan.scenes)
        arms = []
        for arm in range(2):
            scenes: BySplit = {s: [of_scene[arm] for of_scene in both[s]] for s in SPLITS}
            network = grid_network((1 + arm) * LAYERS, len(CLASSES))
            arms.append(_of_placement(plan, run, network, scenes))
        found = {**arms[1], "one_frame": arms[0]}
    else:
        caster = Caster(plan, run.placement, run.world)
        network = grid_network(LAYERS, len(CLASSES))
        if run.detector == POINTS:
            network = points_network(FEATURES, shape_of(plan.region), len(CLASSES))
        cast = caster.cloud if run.detector == POINTS else caster.voxels
        found = _of_placement(plan, run, network, _scenes(cast, plan.scenes))
    made = {**made_by(RunIdentity(run.name, plan.digest)), **versions()}
    libraries = {k: made[k] for k in ("python", "numpy", "tensorflow")}
    made["digest"] = run_digest(plan.digest, libraries)
    return {**found, "seconds": round(time.process_time() - started, 1), "made": made}


def _scenes(make: Callable[[str, int], Any], counts: Mapping[str, int]) -> dict[str, list[Any]]:
    return {split: [make(split, k) for k in range(counts[split])] for split in SPLITS}


def _of_placement(plan: Plan, run: Run, network: Network, scenes: BySplit) -> Json:
    """Train and test a detector with what one placement sees."""
    detector = Detector(network, plan.training.rate, plan.training.average)
    trained, training = train(detector, plan, scenes[TRAIN], scenes[VALIDATION], seed=run.seed)
    found = results(plan, scenes[TEST], tested(detector, trained.weights, plan, scenes[TEST]))
    return {**found, "training": training}


def _mixed(plan: Plan, run: Run, layouts: Layouts | None) -> Json:
    """Train one detector with many placements, and test it at them and at fresh ones.

    With `layouts` it is tested in all of these, at the good placements of the second plan.
    """
    trained_with, fresh = mixed_placements(plan)
    chosen = [*trained_with, *fresh]
    count = plan.mixed.test_scenes
    if layouts:
        chosen = list(good_placements(plan))
        count = len(layouts)
    network = grid_network(LAYERS, len(CLASSES))
    detector = Detector(network, plan.training.rate, plan.training.average)
    counts = {TRAIN: plan.mixed.scenes, VALIDATION: plan.scenes[VALIDATION]}
    casters = [Caster(plan, placement, PLAIN) for placement in trained_with]
    scenes = {
        split: [casters[k % len(casters)].voxels(split, k) for k in range(number)]
        for split, number in counts.items()
    }
    trained, training = train(detector, plan, scenes[TRAIN], scenes[VALIDATION], seed=run.seed)
    by_placement = {}
    for placement in chosen:
        caster = Caster(plan, placement, run.world, layouts or scene)
        test = [caster.voxels(TEST, k) for k in range(count)]
        found = results(plan, test, tested(detector, trained.weights, plan, test))
        kept = {key: found[key] for key in ("ap", "by_class")}
        by_placement[placement.name] = {**kept, "trained_with": placement in trained_with}
    return {"placements": by_placement, "training": training}


def mixed_placements(plan: Plan) -> tuple[list[Placement], list[Placement]]:
    """Return the placements that the mixed detector is trained with, and fresh ones."""
    drawn = placements(plan)
    by_vehicle = [[p for p in drawn if p.design == MIXED and p.vehicle == v] for v in plan.vehicles]
    each = plan.mixed.trained // len(plan.vehicles)
    turns = zip(*(group[:each] for group in by_vehicle), strict=True)
    fresh = [p for group in by_vehicle for p in group[each:]]
    fixed = [p for p in drawn if p.design == FIXED]
    return [p for turn in turns for p in turn], [*fixed, *fresh]

"""One run: a detector is trained until it has converged, and tested."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .batches import NEITHER, Mirrors, detections, inputs, targets
from .casting import RegionObjects
from .detector import Detector, TrainingState, Weights
from .plan import DetectionRegion, StudyPlan, TrainingRule
from .precision import ClassScene, average_precision, in_ring
from .scenes import CLASSES

Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Trained:
    """A trained detector's weights, and how its training went.

    Attributes
    ----------
    weights : dict of arrays
        Those with the lowest validation loss.
    losses : list of float
        Validation loss of the averaged weights after each epoch.
    converged : bool
        Whether the rule of the plan ended the training.
    """

    weights: Weights
    losses: list[float]
    converged: bool


def train(
    detector: Detector,
    rule: TrainingRule,
    region: DetectionRegion,
    scenes: Sequence[RegionObjects],
    validation: Sequence[RegionObjects],
    seed: int,
) -> Trained:
    """Train a detector; the seed sets first weights, the order of scenes and the mirroring."""
    rng = np.random.default_rng([seed, 1])
    state = detector.start(seed)
    losses: list[float] = []
    best = state.average
    while len(losses) < rule.max_epochs:
        _epoch(detector, state, rule, region, scenes, rng)
        losses.append(_mean_loss(detector, state.average, rule.batch, region, validation))
        if losses[-1] == min(losses):
            best = state.average
        if _has_converged(losses, rule):
            return Trained(best, losses, True)
    return Trained(best, losses, False)


def _has_converged(losses: Sequence[float], rule: TrainingRule) -> bool:
    """Whether the loss fell by less than the rule's share within its window."""
    if len(losses) < max(rule.min_epochs, rule.window + 1):
        return False
    return losses[-1] > (1.0 - rule.improvement) * losses[-1 - rule.window]


def _epoch(
    detector: Detector,
    state: TrainingState,
    rule: TrainingRule,
    region: DetectionRegion,
    scenes: Sequence[RegionObjects],
    rng: np.random.Generator,
) -> None:
    order = rng.permutation(len(scenes))
    for first in range(0, len(order) - rule.batch + 1, rule.batch):
        batch = [scenes[k] for k in order[first : first + rule.batch]]
        mirrors: list[Mirrors] = [NEITHER] * rule.batch
        if rule.mirrored:
            mirrors = [(bool(a), bool(b)) for a, b in rng.integers(0, 2, (rule.batch, 2))]
        detector.train(state, inputs(batch, region, mirrors), targets(batch, region, mirrors))


def _batches(
    scenes: Sequence[RegionObjects], size: int
) -> Iterator[tuple[list[RegionObjects], int]]:
    """Yield batches of one size, and how many of each count: the last is filled by repetition."""
    for first in range(0, len(scenes), size):
        batch = list(scenes[first : first + size])
        yield batch + [batch[-1]] * (size - len(batch)), len(batch)


def _mean_loss(
    detector: Detector,
    weights: Weights,
    size: int,
    region: DetectionRegion,
    scenes: Sequence[RegionObjects],
) -> float:
    mirrors = [NEITHER] * size
    losses = [
        detector.loss(weights, inputs(batch, region, mirrors), targets(batch, region, mirrors))
        for batch, _ in _batches(scenes, size)
    ]
    return round(float(np.mean(losses)), 6)


def test_scenes(
    detector: Detector, weights: Weights, plan: StudyPlan, scenes: Sequence[RegionObjects]
) -> list[list[ClassScene]]:
    """Return detections and objects of the test's scenes, by class."""
    by_class: list[list[ClassScene]] = [[] for _ in CLASSES]
    size, region = plan.training.batch, plan.region
    for batch, count in _batches(scenes, size):
        heat, offsets = detector.outputs(weights, inputs(batch, region, [NEITHER] * size))
        for k in range(count):
            for c, (scores, centers) in enumerate(detections(heat[k], offsets[k], region)):
                objects = batch[k].centers[batch[k].labels == c].astype(float)
                by_class[c].append(ClassScene(scores, centers, objects))
    return by_class


def results(
    plan: StudyPlan, scenes: Sequence[RegionObjects], tested: list[list[ClassScene]]
) -> Json:
    """Return the results of a test: AP of all classes, by class, by ring, of objects with beams."""
    by_ring = {
        ring: _class_aps(
            plan, [[in_ring(s, inner, outer) for s in of_class] for of_class in tested]
        )
        for ring, (inner, outer) in plan.precision.rings.items()
    }
    met = [
        [
            ClassScene(s.scores, s.detected, s.objects[v.beams[v.labels == c] > 0])
            for s, v in zip(of_class, scenes, strict=True)
        ]
        for c, of_class in enumerate(tested)
    ]
    by_class = _class_aps(plan, tested)
    return {
        "ap": _mean(by_class),
        "by_class": by_class,
        "by_ring": by_ring,
        "of_objects_with_beams": _class_aps(plan, met),
        "objects": {
            n: sum(len(s.objects) for s in t) for n, t in zip(CLASSES, tested, strict=True)
        },
        "objects_with_beams": {
            n: sum(len(s.objects) for s in t) for n, t in zip(CLASSES, met, strict=True)
        },
    }


def _class_aps(plan: StudyPlan, tested: list[list[ClassScene]]) -> dict[str, float | None]:
    """Return the AP of each class: the mean over the plan's distances; None without objects."""
    aps: dict[str, float | None] = {}
    for name, scenes in zip(CLASSES, tested, strict=True):
        values = [average_precision(scenes, d) for d in plan.precision.distances_m]
        known = [v for v in values if v is not None]
        aps[name] = round(float(np.mean(known)), 6) if known else None
    return aps


def _mean(by_class: dict[str, float | None]) -> float:
    """Return the mean AP of the classes; a class without any object counts as 0."""
    return round(float(np.mean([ap or 0.0 for ap in by_class.values()])), 6)


def timed_training(
    detector: Detector,
    plan: StudyPlan,
    scenes: Sequence[RegionObjects],
    validation: Sequence[RegionObjects],
    seed: int,
) -> tuple[Trained, Json]:
    """Train a detector, and return with it how that went, as JSON data."""
    started = time.process_time()
    trained = train(detector, plan.training, plan.region, scenes, validation, seed)
    return trained, {
        "epochs": len(trained.losses),
        "converged": trained.converged,
        "validation_losses": trained.losses,
        "training_seconds": round(time.process_time() - started, 1),
    }

"""A detector is trained until it has converged, and tested."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..results_file import Json
from .batches import NEITHER, Mirrors, detections, inputs, targets
from .casting import RegionObjects
from .detector import Detector, TrainingState, Weights
from .plan import StudyPlan, TrainingRule
from .precision import ClassScene
from .scenes import CLASSES


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
    plan: StudyPlan,
    scenes: Sequence[RegionObjects],
    validation: Sequence[RegionObjects],
    seed: int,
) -> tuple[Trained, Json]:
    """Train a detector, and return with it how that went, as JSON data.

    The seed sets first weights, the order of scenes and the mirroring.
    """
    started, rule = time.process_time(), plan.training
    rng = np.random.default_rng([seed, 1])
    state = detector.start(seed)
    losses: list[float] = []
    best, converged = state.average, False
    while len(losses) < rule.max_epochs and not converged:
        _epoch(detector, state, plan, scenes, rng)
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


def _has_converged(losses: Sequence[float], rule: TrainingRule) -> bool:
    """Whether the loss fell by less than the rule's share within its window."""
    if len(losses) < max(rule.min_epochs, rule.window + 1):
        return False
    return losses[-1] > (1.0 - rule.improvement) * losses[-1 - rule.window]


def _epoch(
    detector: Detector,
    state: TrainingState,
    plan: StudyPlan,
    scenes: Sequence[RegionObjects],
    rng: np.random.Generator,
) -> None:
    size, region = plan.training.batch, plan.region
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
    detector: Detector, weights: Weights, plan: StudyPlan, scenes: Sequence[RegionObjects]
) -> float:
    size, region = plan.training.batch, plan.region
    mirrors = [NEITHER] * size
    losses = [
        detector.loss(weights, inputs(batch, region, mirrors), targets(batch, region, mirrors))
        for batch, _ in _batches(scenes, size)
    ]
    return round(float(np.mean(losses)), 6)


def tested(
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

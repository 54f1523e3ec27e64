"""Robustness of a rig: its entropy with mounting errors, or with a failed sensor.

`RobustObjective` is what a search minimises under a `Tolerance`; `robustness` reports how far the
entropy of the start and of the result moves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..base.degrees import degrees_in_file
from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.protocol import Evaluation, Objective, RigEvaluator
from ..scoring.scenarios import mean_or_worst
from .tolerance import FRESH, Tolerance, mounted_off, without_each


class RobustObjective:
    """The entropy of a rig with all mounting errors and failures of a tolerance: mean or worst.

    The mounting errors, drawn from `seed`, are the same for every rig.
    """

    def __init__(self, evaluator: RigEvaluator, tolerance: Tolerance, seed: int = 0) -> None:
        self._evaluator, self._tolerance, self._seed = evaluator, tolerance, seed

    def entropy(self, rig: Rig) -> float:
        """Return the mean of the entropies of a rig's cases, or the highest [nats]."""
        entropies = self._evaluator.entropies(self._tolerance.cases(rig, self._seed))
        return mean_or_worst(entropies, self._tolerance.worst)

    def evaluate(self, rig: Rig, cutoff: float = math.inf) -> Evaluation:
        """Return that mean (or highest); where it is not below `cutoff`, perhaps a lower bound.

        As `Evaluator.evaluate`. The bound is the mean (or highest) of bounds and entropies.
        """
        cases = self._tolerance.cases(rig, self._seed)
        return self._evaluator.evaluate_together(cases, cutoff, self._tolerance.worst)

    def shared_parts(self) -> tuple[object, ...]:
        """Return what workers are sent once: the evaluator."""
        return (self._evaluator,)


def objective_of(evaluator: RigEvaluator, tolerance: Tolerance, seed: int = 0) -> Objective:
    """Return what a search minimises: the evaluator, or `RobustObjective` if a tolerance is on."""
    return RobustObjective(evaluator, tolerance, seed) if tolerance.is_on else evaluator


WORKSHOP = Tolerance(0.01, math.radians(0.3), draws=6)
"""The errors of a careful workshop: these are evaluated where a study names none."""


@dataclass(frozen=True, slots=True)
class RigRobustness:
    """The entropies of one placement with errors and failures, all on one sample of voxels [nats].

    Attributes
    ----------
    entropy : float
        Without errors and failures.
    mounted_off, mounted_worst : float
        Mean over the mounting errors, and the worst.
    stderr : float
        Standard error of `mounted_off`, from the scatter of the draws; an overestimate.
    failed, failed_worst : float or None
        Mean over the failures of each single sensor, and the worst; None for a single sensor.
    missed : str or None
        The sensor whose failure is the worst.
    """

    entropy: float
    mounted_off: float
    mounted_worst: float
    stderr: float
    failed: float | None = None
    failed_worst: float | None = None
    missed: str | None = None

    @property
    def rise(self) -> float:
        """How much mounting errors raise the entropy on average [nats]."""
        return rounded(self.mounted_off - self.entropy)

    @property
    def loss(self) -> float | None:
        """Mean rise of the entropy when a sensor fails [nats]; None for a single sensor."""
        return None if self.failed is None else rounded(self.failed - self.entropy)


@dataclass(frozen=True, slots=True)
class Robustness:
    """The robustness of the start and of the result of a search.

    Attributes
    ----------
    errors : Tolerance
        The mounting errors: the study's, or `WORKSHOP`. The search did not use these draws.
    samples : int
        How many voxels were evaluated.
    before, after : RigRobustness
    """

    errors: Tolerance
    samples: int
    before: RigRobustness
    after: RigRobustness

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "position": self.errors.position,
            "angle": degrees_in_file(self.errors.angle),
            "draws": self.errors.draws,
            "samples": self.samples,
            "before": asdict(self.before),
            "after": asdict(self.after),
        }


def robustness(
    evaluator: RigEvaluator, before: Rig, after: Rig, tolerance: Tolerance, seed: int = 0
) -> Robustness:
    """Return how far errors and failures raise the entropy of two placements.

    The evaluator should be sampled: every sensor is measured once for each draw. The mounting
    errors of the tolerance are used; without any, those of `WORKSHOP`. `seed` is that of the study;
    a search with this seed uses other errors.
    """
    errors = replace(tolerance if tolerance.mounts_off else WORKSHOP, failures=False, worst=False)
    first = _robustness_of(evaluator, before, errors, seed)
    last = first if after is before else _robustness_of(evaluator, after, errors, seed)
    return Robustness(errors, evaluator.samples, first, last)


def _robustness_of(
    evaluator: RigEvaluator, rig: Rig, errors: Tolerance, seed: int
) -> RigRobustness:
    with_errors = evaluator.entropies(mounted_off(rig, errors, seed, FRESH))
    rigs_without = without_each(rig) if len(rig) > 1 else []
    entropy, *failed = evaluator.entropies([rig, *rigs_without])
    about_errors = (
        rounded(float(np.mean(with_errors))),
        max(with_errors),
        _standard_error(with_errors, errors.draws, len(rig)),
    )
    if not failed:
        return RigRobustness(entropy, *about_errors)
    missed = rig.sensors[int(np.argmax(failed))].name
    return RigRobustness(
        entropy, *about_errors, rounded(float(np.mean(failed))), max(failed), missed
    )


def _standard_error(entropies: Sequence[float], draws: int, sensors: int) -> float:
    """Return the standard error from the scatter of each sensor's pairs of opposite draws."""
    half, variance = draws // 2, 0.0
    if half < 2:
        return 0.0
    combinations = np.array(entropies).reshape(-1, draws)
    for number in range(sensors):
        aligned = [np.roll(values, k * number) for k, values in enumerate(combinations)]
        by_draw = np.mean(aligned, axis=0)
        variance += float(np.var(by_draw.reshape(2, half).mean(axis=0), ddof=1)) / half
    return rounded(math.sqrt(variance))

"""The objective of a search for placements that stand mounting errors and the loss of a sensor."""

from __future__ import annotations

import math

from ..scene.sensors import Rig
from ..scoring import RigJudge
from ..scoring.cases import together
from .objective import Judgement, Objective
from .tolerance import Tolerance


class RobustObjective:
    """What a rig is worth by an evaluator in all cases of a tolerance: their mean, or the worst.

    Parameters
    ----------
    evaluator : RigJudge
    tolerance : Tolerance
    seed : int
        Of the mounting errors, which are the same for every rig.
    """

    def __init__(self, evaluator: RigJudge, tolerance: Tolerance, seed: int = 0) -> None:
        self._evaluator, self._tolerance, self._seed = evaluator, tolerance, seed

    def entropy(self, rig: Rig) -> float:
        """Mean entropy of a rig's cases, or the highest [nats]."""
        found = self._evaluator.entropies(self._tolerance.cases(rig, self._seed))
        return together(found, self._tolerance.worst)

    def judge(self, rig: Rig, below: float = math.inf) -> Judgement:
        """Tell whether that is below a value: it, or a lower bound that is not below either.

        As `Evaluator.judge`: the bound is the mean (or highest) of the entropies and of lower
        bounds of those that were not needed.
        """
        cases = self._tolerance.cases(rig, self._seed)
        return self._evaluator.judge_together(cases, below, self._tolerance.worst)


def objective_of(evaluator: RigJudge, tolerance: Tolerance, seed: int = 0) -> Objective:
    """Return what a search minimises: the evaluator, or all cases of a tolerance that is on."""
    return RobustObjective(evaluator, tolerance, seed) if tolerance.is_on else evaluator

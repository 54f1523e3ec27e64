"""Conditions as the objective of a search: `[optimize] conditions = "mean"` or `"worst"`.

A placement's value is the weighted mean of its entropies in all states and weathers, or the highest
of those with a weight; with a tolerance, each of these is the mean (or the worst) of its cases.
"""

from __future__ import annotations

import math

from ..base.errors import InputError
from ..scene.rig import Rig
from ..scoring.protocol import Evaluation, Objective, RigEvaluator
from ..scoring.scenarios import mean_or_worst
from ..search import objective_of
from .condition_table import StateEvaluators, weighted_mean
from .study import Study

MEAN, WORST = "mean", "worst"


class ConditionObjective:
    """What a search over conditions minimises.

    Parameters
    ----------
    study : Study
        With states, weathers or both, and `search.conditions`.
    samples : int
        Voxels that a candidate is evaluated on.
    """

    def __init__(self, study: Study, samples: int, workers: int | None = None) -> None:
        self._study, self._samples, self._workers = study, samples, workers
        self._worst = study.search.conditions == WORST
        self._conditions = [c for c in study.conditions.all if c.weight > 0.0]
        self._evaluators = StateEvaluators(study, samples, workers, searching=True)

    def __reduce__(self) -> tuple[object, ...]:
        return ConditionObjective, (self._study, self._samples, self._workers)

    def entropy(self, rig: Rig) -> float:
        """Return the mean or the worst of a rig's entropies under all conditions [nats]."""
        return self.evaluate(rig).entropy

    def evaluate(self, rig: Rig, cutoff: float = math.inf) -> Evaluation:
        """Return that value; of the worst a lower bound once it is not below `cutoff`."""
        search = self._study.search
        cases = search.tolerance.cases(rig, search.seed) if search.tolerance.is_on else [rig]
        values, weights = list[float](), list[float]()
        for state in dict.fromkeys(c.state for c in self._conditions):
            own = [c for c in self._conditions if c.state == state]
            rigs = [c.rig(case, self._study.vehicle) for c in own for case in cases]
            found = self._evaluators.in_state(state)[0].entropies(rigs)
            for number, condition in enumerate(own):
                part = found[number * len(cases) : (number + 1) * len(cases)]
                values.append(mean_or_worst(part, search.tolerance.worst))
                weights.append(condition.weight)
            if self._worst and max(values) >= cutoff and len(values) < len(self._conditions):
                return Evaluation(max(values), True)
        return Evaluation(max(values) if self._worst else weighted_mean(values, weights), False)


def study_objective(
    study: Study, evaluator: RigEvaluator, samples: int, workers: int | None = None
) -> Objective:
    """Return what a study's search minimises, without its requirements.

    `InputError` when conditions are to be searched over and the study has none.
    """
    search = study.search
    if search.conditions is None:
        return objective_of(evaluator, search.tolerance, search.seed)
    if not study.conditions:
        expected = "[[state]] or [[weather]] with it"
        raise InputError("optimize", "conditions", expected, "neither")
    return ConditionObjective(study, samples, workers)

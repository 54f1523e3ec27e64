"""Races: a candidate that is surely worse than the leader is not evaluated on all voxels.

Both are evaluated on the first voxels of the common sample. A difference on the same voxels has a
far smaller error than either entropy, as most voxels differ little. Only a candidate that is not
worse by `SURE_ERRORS` of its standard errors is evaluated on the whole sample, which alone decides
what is better. So a race saves time, and changes a search only where it errs.

Placements that differ in few voxels differ perhaps in none of the first ones: then the scatter says
nothing. So the error is never taken to be smaller than by the rule of three.

The race of descents in `methods.portfolio` is another one: it shares the budget among them.

Racing on common samples: O. Maron, A. W. Moore, Hoeffding races, 1994; M. Birattari et al., A
racing algorithm for configuring metaheuristics, 2002.
"""

from functools import cached_property
from typing import Any, NamedTuple

from ..base.errors import InputError
from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring import Evaluator, RigEvaluator
from ..scoring.score import standard_error, unseen_error
from .objective import Objective

SURE_ERRORS = 3.0
"""From so many standard errors on a candidate is surely worse."""
RACED_PART = 16
"""A race is on the first voxels of the sample: all of them divided by this."""
MIN_RACED = 4096
"""Voxels of the smallest race: on fewer ones a LiDAR takes nearly as long, because rays are cast,
and a candidate that is not stopped costs both."""


class Rise(NamedTuple):
    """By how much an entropy is higher than another on the same voxels, and the standard error of
    that [nats]."""

    nats: float
    error: float

    def is_surely_above(self, spare: float) -> bool:
        """Whether the rise is above `spare` [nats] by more than `SURE_ERRORS` standard errors."""
        return self.nats - spare > SURE_ERRORS * self.error


def rise_between(evaluator: RigEvaluator, leader: Rig, rig: Rig) -> Rise:
    """Return how much higher the entropy of a rig is than that of the leader, on a sample."""
    rigs = [leader, rig]  # the leader first: it stays the same, so it is measured once
    before, after = evaluator.entropies(rigs)
    of_leader, of_rig = evaluator.residuals(rigs)
    error = max(
        standard_error(of_rig - of_leader), unseen_error(len(rig.groups), evaluator.samples)
    )
    return Rise(rounded(after - before), error)


class RacedEntropy:
    """The entropy of an evaluator as what a search minimises; candidates race on a part of its
    sample."""

    def __init__(self, evaluator: Evaluator) -> None:
        self._evaluator = evaluator

    def __reduce__(self) -> tuple[object, ...]:
        return RacedEntropy, (self._evaluator,)

    def __call__(self, rig: Rig) -> float:
        """Return the entropy of a rig on all voxels [nats]."""
        return self._evaluator.entropy(rig)

    @cached_property
    def _first_voxels(self) -> Evaluator:
        return self._evaluator.on_first(self._evaluator.samples // RACED_PART)

    def loses(self, rig: Rig, leader: Rig, spare: float) -> bool:
        """Whether the entropy of a rig is surely higher than that of the leader, by more than
        `spare` [nats]."""
        return rise_between(self._first_voxels, leader, rig).is_surely_above(spare)


def entropy_objective(evaluator: RigEvaluator) -> Objective:
    """Return the entropy of an evaluator as what a search minimises; on a large sample candidates
    race."""
    if isinstance(evaluator, Evaluator) and evaluator.samples >= MIN_RACED * RACED_PART:
        return Objective(RacedEntropy(evaluator))
    return Objective(evaluator.entropy)


def as_objective(given: Any) -> Objective:
    """Return an objective; of an evaluator that of its entropy, of a function that of its figure.
    `InputError` for anything else."""
    if isinstance(given, Objective):
        return given
    if hasattr(given, "entropy"):
        return entropy_objective(given)
    if callable(given):
        return Objective(given)
    expected = "an Evaluator, or a function of a rig"
    raise InputError("optimize", "objective", expected, type(given).__name__)

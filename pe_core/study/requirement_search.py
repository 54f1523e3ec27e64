"""Constraints of a search: feasible first, then entropy.

`[optimize] requirements = "keep"`: a placement that meets all requirements beats each one that does
not. Of placements that break some, the one with the least violation is the best; their entropies do
not matter and are not computed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.protocol import Evaluation, Objective
from ..scoring.requirements import RequirementChecker
from ..search import Tolerance, optimize, shared_parts
from ..search.methods.method import sampled_candidate
from .blind_ground_search import BlindGroundLimit
from .requirement_check import mounting_cases
from .study import Study

KEEP = "keep"
INFEASIBLE = 100.0
"""Value of a placement that breaks a constraint, without the violation: above all entropies."""


class FeasibilityRule(Protocol):
    """Something that a placement keeps, or breaks by so much."""

    def violation(self, rig: Rig) -> float:
        """Return by how much a placement breaks it; 0 where it is kept."""


class RequirementConstraint:
    """The constraint that all requirements of a study are met.

    Parameters
    ----------
    checker : RequirementChecker
    tolerance : Tolerance
        Its mounting errors are those that requirements have to be met under.
    seed : int
    """

    def __init__(self, checker: RequirementChecker, tolerance: Tolerance, seed: int = 0) -> None:
        self._checker, self._tolerance, self._seed = checker, tolerance, seed

    def violation(self, rig: Rig) -> float:
        """Return the sum of the violations of all requirements; 0 where all are met."""
        wanted = self._checker.requirements
        cases = mounting_cases(wanted, rig, self._tolerance, self._seed)
        return rounded(sum(self._checker.shortfalls(rig, cases)))


class FeasibleFirst:
    """What a search with constraints minimises.

    The value of a placement is its entropy [nats] if it keeps all constraints; else it is
    `INFEASIBLE` and the sum of the violations.

    Parameters
    ----------
    objective : Objective
        The entropy.
    constraints : sequence of FeasibilityRule
    """

    def __init__(self, objective: Objective, constraints: Sequence[FeasibilityRule]) -> None:
        self._objective, self._constraints = objective, tuple(constraints)

    def entropy(self, rig: Rig) -> float:
        """Return the value of a placement."""
        violation = self.violation(rig)
        return INFEASIBLE + violation if violation else self._objective.entropy(rig)

    def evaluate(self, rig: Rig, cutoff: float = math.inf) -> Evaluation:
        """Return the value of a placement, or a lower bound that is not below `cutoff`.

        What is not below a cutoff with its entropy is not below it if it breaks a constraint, so
        constraints, which take longer, are then not checked.
        """
        if cutoff > INFEASIBLE:
            violation = self.violation(rig)
            return (
                Evaluation(INFEASIBLE + violation, False)
                if violation
                else self._objective.evaluate(rig, cutoff)
            )
        found = self._objective.evaluate(rig, cutoff)
        if found.is_lower_bound or found.entropy >= cutoff:
            return Evaluation(found.entropy, True)
        violation = self.violation(rig)
        return Evaluation(INFEASIBLE + violation, False) if violation else found

    def shared_parts(self) -> tuple[object, ...]:
        """Return what workers are sent once: the parts of the objective, and the constraints."""
        return (*shared_parts(self._objective), *self._constraints)

    def violation(self, rig: Rig) -> float:
        """Return the sum of the violations of all constraints; 0 where all are kept."""
        return rounded(sum(each.violation(rig) for each in self._constraints))


def constraints_of(study: Study) -> tuple[FeasibilityRule, ...]:
    """Return what placements of a study's search have to keep: requirements, blind ground.

    `InputError` when a zone of a requirement that is to be kept cannot be placed.
    """
    search, constraints = study.search, list[FeasibilityRule]()
    if search.requirements == KEEP and study.requirements:
        checker = study.checker()
        constraints.append(RequirementConstraint(checker, search.tolerance, search.seed))
    if search.goals.blind_ground == KEEP:
        constraints.append(BlindGroundLimit.of(study))
    return tuple(constraints)


def feasible_first(objective: Objective, constraints: Sequence[FeasibilityRule]) -> Objective:
    """Return what a search minimises: the objective, or `FeasibleFirst` of it."""
    return FeasibleFirst(objective, constraints) if constraints else objective


def is_infeasible(value: float) -> bool:
    """Whether a value of a search is that of a placement that breaks a constraint."""
    return value >= INFEASIBLE


CONFLICT_TRIES = 80
"""Placements that are tried for each requirement that is not met."""
MAX_CONFLICTS = 3


class _OneFirst:
    """One requirement first, then as few violations of the others as possible."""

    def __init__(self, checker: RequirementChecker, number: int) -> None:
        self._checker, self._number = checker, number

    def entropy(self, rig: Rig) -> float:
        """Return 10 times the violation of the one, and the sum of the others'."""
        found = self._checker.shortfalls(rig)
        return rounded(10.0 * found[self._number] + sum(found) - found[self._number])

    def evaluate(self, rig: Rig, cutoff: float = math.inf) -> Evaluation:
        """Return the value of a placement."""
        return Evaluation(self.entropy(rig), False)


def _best_for(objective: _OneFirst, study: Study) -> Rig:
    """Return the best of random placements, and of a short search from there."""
    coding, rng = study.coding(), np.random.default_rng(study.search.seed)

    def sample() -> list[float]:
        return [float(rng.uniform(v.low, v.high)) for v in coding.variables]

    sampled = [sampled_candidate(coding, sample) for _ in range(CONFLICT_TRIES // 2)]
    rigs = [study.rig, *(each.rig for each in sampled if each is not None)]
    best = min(rigs, key=objective.entropy)
    space, seed = study.with_rig(best).search_space(), study.search.seed
    for step in optimize(objective, best, space, seed, evaluations=CONFLICT_TRIES // 2):
        best = step.best
    return best


def conflicts(
    study: Study, rig: Rig, checker: RequirementChecker | None = None
) -> dict[str, tuple[str, ...] | None]:
    """Return which requirements stand against each one that a placement does not meet.

    For each of the first `MAX_CONFLICTS` that are not met a short search looks for a placement that
    meets it. Those that are then broken and were not before stand against it. Mounting errors are
    left out.

    Returns
    -------
    dict of tuple of str, or None
        By name of the requirement: the others; empty if only the budget of the search was short;
        None if no placement met it even without all others.
    """
    checker = checker or study.checker()
    names = [each.name for each in checker.requirements]
    before = checker.shortfalls(rig)
    found: dict[str, tuple[str, ...] | None] = {}
    for number in [k for k, off in enumerate(before) if off][:MAX_CONFLICTS]:
        best = _best_for(_OneFirst(checker, number), study.with_rig(rig))
        after = checker.shortfalls(best)
        broken = tuple(n for n, was, now in zip(names, before, after, strict=True) if now > was)
        found[names[number]] = None if after[number] else broken
    return found

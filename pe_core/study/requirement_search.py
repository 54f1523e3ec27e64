"""Requirements as constraints of a search: feasible first, then entropy.

`[optimize] requirements = "keep"`: a placement that meets all requirements beats each one that does
not. Of placements that break some, the one with the least violation is the best; their entropies do
not matter and are not computed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..scene.rig import Rig
from ..scoring.protocol import Judgement, Objective
from ..scoring.requirements import RequirementChecker
from ..scoring.score import rounded
from ..search import Parametrization, Tolerance, mounted_off, optimize
from ..search.design_variable import METRE, RADIAN, SHARE
from ..search.methods.method import sampled_candidate
from .requirement_check import checker_of

if TYPE_CHECKING:
    from .study import Study

KEEP = "keep"
INFEASIBLE = 100.0
"""Value of a placement that breaks a requirement, without the violation: above all entropies."""


class FeasibleFirst:
    """What a search with requirements minimises.

    The value of a placement is its entropy [nats] if it meets all requirements; else it is
    `INFEASIBLE` and the sum of the violations, each above 0 to 1.

    Parameters
    ----------
    objective : Objective
        The entropy.
    checker : RequirementChecker
    tolerance : Tolerance
        Its mounting errors are those that requirements have to be met under.
    seed : int
    """

    def __init__(
        self,
        objective: Objective,
        checker: RequirementChecker,
        tolerance: Tolerance,
        seed: int = 0,
    ) -> None:
        self._objective, self._checker = objective, checker
        self._tolerance, self._seed = tolerance, seed

    def entropy(self, rig: Rig) -> float:
        """Return the value of a placement."""
        violation = self.violation(rig)
        return INFEASIBLE + violation if violation else self._objective.entropy(rig)

    def judge(self, rig: Rig, below: float = math.inf) -> Judgement:
        """Return the value of a placement, or a lower bound that is not below `below`."""
        violation = self.violation(rig)
        if violation:
            return Judgement(INFEASIBLE + violation, False)
        return self._objective.judge(rig, below)

    def violation(self, rig: Rig) -> float:
        """Return the sum of the violations of all requirements; 0 where all are met."""
        return rounded(sum(self._checker.shortfalls(rig, self._cases(rig))))

    def _cases(self, rig: Rig) -> list[Rig]:
        if not any(each.under.mounting for each in self._checker.requirements):
            return []
        return mounted_off(rig, self._tolerance, self._seed)[: self._tolerance.draws]


def feasible_first(
    study: Study, objective: Objective, checker: RequirementChecker | None = None
) -> Objective:
    """Return what a study's search minimises: the objective, or `FeasibleFirst` of it.

    Raises
    ------
    InputError
        When a zone of a requirement that is to be kept cannot be placed.
    """
    search = study.search
    if search.requirements != KEEP or not study.requirements:
        return objective
    return FeasibleFirst(objective, checker or checker_of(study), search.tolerance, search.seed)


def is_infeasible(value: float) -> bool:
    """Whether a value of a search is that of a placement that breaks a requirement."""
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

    def judge(self, rig: Rig, below: float = math.inf) -> Judgement:
        """Return the value of a placement."""
        return Judgement(self.entropy(rig), False)


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
    checker = checker or checker_of(study)
    names = [each.name for each in checker.requirements]
    before = checker.shortfalls(rig)
    found: dict[str, tuple[str, ...] | None] = {}
    for number in [k for k, off in enumerate(before) if off][:MAX_CONFLICTS]:
        best = _best_for(_OneFirst(checker, number), study.with_rig(rig))
        after = checker.shortfalls(best)
        broken = tuple(n for n, was, now in zip(names, before, after, strict=True) if now > was)
        found[names[number]] = None if after[number] else broken
    return found


HELP_STEPS = {
    METRE: (0.05, 0.1, 0.2, 0.4, 0.8),
    RADIAN: (0.05, 0.1, 0.2, 0.4, 0.8),
    SHARE: (0.1, 0.2),
}
"""Steps of one design variable that are tried: in metres, radians (3 to 46 deg), and shares."""


@dataclass(frozen=True, slots=True)
class Suggestion:
    """The nearest placement found that meets a requirement, and what it breaks.

    Attributes
    ----------
    rig : Rig
    moved : tuple of str
        Names of the sensors that are elsewhere.
    breaks : tuple of str
        Requirements that were met and no longer are.
    """

    rig: Rig
    moved: tuple[str, ...]
    breaks: tuple[str, ...]

    @property
    def text(self) -> str:
        """Where the sensors would be: "rear at (-2.5, 0, 1.5) m, roll 0, pitch 30, yaw 180"."""
        where = []
        for name in self.moved:
            pose = self.rig[name].pose
            x, y, z = (f"{v:.3g}" for v in pose.position)
            roll, pitch, yaw = (f"{v:.3g}" for v in pose.rotation_deg)
            where.append(f"{name} at ({x}, {y}, {z}) m, roll {roll}, pitch {pitch}, yaw {yaw}")
        broken = f"; that breaks {', '.join(self.breaks)}" if self.breaks else ""
        return "; ".join(where) + broken


def suggestions(
    study: Study, checker: RequirementChecker | None = None
) -> dict[str, Suggestion | None]:
    """Return for each requirement that is not met the nearest placement found that meets it.

    One design variable of the search (a coordinate, or a place along a mount) is changed at a time,
    by small steps first. Mounting errors are left out.

    Returns
    -------
    dict of Suggestion or None
        By name; None where no step of one variable is enough.
    """
    checker, coding = checker or checker_of(study), study.coding()
    names = [each.name for each in checker.requirements]
    before = checker.shortfalls(study.rig)
    left = [number for number, off in enumerate(before) if off]
    found: dict[str, Suggestion | None] = dict.fromkeys(names[k] for k in left)
    for rig in _steps_of_one(coding):
        if not left:
            break
        after = checker.shortfalls(rig)
        for number in [k for k in left if not after[k]]:
            left.remove(number)
            moved = tuple(s.name for s in rig if s.pose != study.rig[s.name].pose)
            broken = [
                n for n, was, off in zip(names, before, after, strict=True) if off and not was
            ]
            found[names[number]] = Suggestion(rig, moved, tuple(broken))
    return found


def _steps_of_one(coding: Parametrization) -> Iterator[Rig]:
    """Yield allowed placements that differ from the start in one variable, near ones first."""
    start = coding.start.vector
    for rank in range(max(map(len, HELP_STEPS.values()))):
        for number, variable in enumerate(coding.variables):
            for step in HELP_STEPS[variable.unit][rank : rank + 1]:
                for shift in (step, -step):
                    vector = list(start)
                    vector[number] = variable.clipped(start[number] + shift)
                    candidate = coding.candidate(vector)
                    if candidate.vector != start and coding.allowed(candidate.rig):
                        yield candidate.rig

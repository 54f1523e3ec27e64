"""Requirements and blind ground as constraints of a search.

`[limits] requirements = true`: a placement that meets all requirements beats each one that does
not. Of placements that break some, the one with the least violation is the best; their entropies do
not matter and are not computed. `[limits] blind_ground = 3.0`: a placement with more blind ground
is infeasible, too; with `true`, one with more than the study's own.
"""

import math
from collections.abc import Iterable, Iterator, Sequence

from ..base.errors import InputError
from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.sampling import SEARCHED
from ..scoring.score import Objective
from ..scoring.sight import Sight
from ..search import shared_parts
from ..search.dispatch import value_below
from ..search.figures import FIGURES, KEPT, REACH
from ..search.limits import Limits
from ..search.rig_view import RigView
from .conditions import mounting_cases
from .study import Study

INFEASIBLE = 100.0
"""Value of a placement that breaks a constraint, without the violation: above all entropies."""


class FiguresLimit:
    """The constraint that key figures of a rig cost no more than limits; the vehicle is as drawn.

    A limit is the cost of its number, and those of the rig `start` without one. Scenes of a search
    are others than those that its result is reported on: the number is moved by the difference of
    the start's figures on both. So a limit is one of the change from the start, in which the
    scatter of scenes cancels.

    Parameters
    ----------
    sight : Sight
        Has the scenes of the search.
    reported : Sight
        Has the scenes that the result is reported on.
    keys : sequence of str
        Names of `FIGURES`.
    """

    def __init__(
        self, sight: Sight, reported: Sight, keys: Sequence[str], limits: Limits, start: Rig
    ) -> None:
        self._sight = sight
        self._keys = tuple(keys)
        self._limits = dict(_costs(sight, self._keys, start))
        asked = [key for key in self._keys if limits.value(key) is not None]
        for key, costs in _costs(reported, asked, start):
            limit = FIGURES[key].cost_of(limits.value(key) or 0.0)
            pairs = zip(self._limits[key], costs, strict=True)
            self._limits[key] = tuple(rounded(limit + searched - own) for searched, own in pairs)

    def violation(self, rig: Rig, enough: float = math.inf) -> float:
        """Return the sum of the shares of a rig's costs above their limits; 0 if none is.
        Where it comes to `enough`, further costs are not computed."""
        pairs = (
            pair
            for key, own in _costs(self._sight, self._keys, rig)
            for pair in zip(own, self._limits[key], strict=True)
        )
        return _added((1.0 - limit / cost for cost, limit in pairs if cost > limit), enough)


def _costs(sight: Sight, keys: Sequence[str], rig: Rig) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Yield the names of figures and their costs."""
    view = RigView(sight, rig)
    for key in keys:
        yield key, FIGURES[key].costs(view)


class RequirementConstraint:
    """The constraint that all requirements of a study are met, with the tolerance's errors."""

    def __init__(self, study: Study) -> None:
        self._checker = study.checker()
        search = study.search
        self._tolerance = search.tolerance
        self._seed = search.seed

    def shortfalls(self, rig: Rig) -> tuple[float, ...]:
        """Return for each requirement 0 where it is met, else how far it is off."""
        wanted = self._checker.requirements
        cases = mounting_cases(wanted, rig, self._tolerance, self._seed)
        return self._checker.shortfalls(rig, cases)

    def violation(self, rig: Rig, enough: float = math.inf) -> float:
        """Return the sum of the violations of all requirements; 0 where all are met."""
        return rounded(sum(self.shortfalls(rig)))


FeasibilityRule = FiguresLimit | RequirementConstraint
"""Something that a placement keeps, or breaks by its `violation`."""


class FeasibleFirst:
    """What a search with constraints minimises. The value of a placement is its entropy [nats],
    that of the objective, if it keeps all constraints; else it is `INFEASIBLE` and the sum of the
    violations."""

    def __init__(self, objective: Objective, constraints: Sequence[FeasibilityRule]) -> None:
        self._objective = objective
        self._constraints = tuple(constraints)

    def entropy(self, rig: Rig) -> float:
        """Return the value of a placement."""
        return self.below(rig, math.inf)

    def below(self, rig: Rig, cutoff: float) -> float:
        """Return the value of a placement where it is below `cutoff`; otherwise one that is not.
        What is not below with its entropy is not if it breaks a constraint, so constraints, which
        take longer, are then not checked; nor are further ones after a violation that is enough."""
        if cutoff > INFEASIBLE:
            violation = self.violation(rig, cutoff - INFEASIBLE)
            return INFEASIBLE + violation if violation else self._objective.entropy(rig)
        found = value_below(self._objective, rig, cutoff)
        return math.inf if found < cutoff and self.violation(rig, 0.0) else found

    def shared_parts(self) -> tuple[object, ...]:
        """Return what workers are sent once: the parts of the objective, and the constraints."""
        return (*shared_parts(self._objective), *self._constraints)

    def violation(self, rig: Rig, enough: float = math.inf) -> float:
        """Return the sum of the violations of all constraints; 0 where all are kept.
        Where it comes to `enough`, further ones are not computed."""
        return _added((each.violation(rig, enough) for each in self._constraints), enough)


def _added(violations: Iterable[float], enough: float) -> float:
    total = 0.0
    for each in violations:
        total += each
        if (found := rounded(total)) and found >= enough:
            break
    return rounded(total)


def constraints_of(study: Study) -> tuple[FeasibilityRule, ...]:
    """Return what placements of a study's search have to keep: requirements, key figures.
    `InputError` when a zone of a requirement that is to be kept cannot be placed."""
    constraints = list[FeasibilityRule]()
    if study.limits.keeps_requirements and study.requirements:
        constraints.append(RequirementConstraint(study))
    if keep := [key for key in KEPT if study.limits.kept(key) is not None]:
        if REACH in keep and study.targets.are_objects:
            raise InputError("limits", REACH, "a reach of voxels", "a study on objects")
        limit = FiguresLimit(
            study.sight(SEARCHED), study.sight(), keep, study.limits, start=study.rig
        )
        constraints.append(limit)
    return tuple(constraints)


def feasible_first(objective: Objective, constraints: Sequence[FeasibilityRule]) -> Objective:
    """Return what a search minimises: the objective, or `FeasibleFirst` of it."""
    return FeasibleFirst(objective, constraints) if constraints else objective


def is_infeasible(value: float) -> bool:
    """Whether a value of a search is that of a placement that breaks a constraint."""
    return value >= INFEASIBLE

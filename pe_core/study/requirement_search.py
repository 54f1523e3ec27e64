"""Requirements and blind ground as constraints of a search.

`[limits] requirements = true`: a placement that meets all requirements beats each one that does
not. Of placements that break some, the one with the least violation is the best; their entropies do
not matter and are not computed. `[limits] blind_ground = 3.0`: a placement with more blind ground
is infeasible, too; with `true`, one with more than the study's own.
"""

import math
from collections.abc import Iterator, Sequence

from ..base.errors import InputError
from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.sampling import SEARCHED
from ..scoring.sight import Sight
from ..search import FeasibilityRule, violation_sum
from ..search.figures import FIGURES, KEPT, REACH
from ..search.limits import Limits
from ..search.rig_view import RigView
from .conditions import mounting_cases
from .study import Study


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
        return violation_sum((1.0 - limit / cost for cost, limit in pairs if cost > limit), enough)


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

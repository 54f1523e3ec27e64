"""The sensitivity analysis of a search's result: what it computes, within which budget."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pe_core.scene.rig import Rig
from pe_core.search import AXES
from pe_core.search.goals import FULL, OFF
from pe_core.study.condition_table import is_by_ap
from pe_core.study.study import EXPECTED_AP, Study

from .archive import Archive
from .constraints import ActiveConstraint, Neighbourhood, Unmet, active_constraints
from .flatness import FAR, NEAR, AxisCost, flatness
from .fresh_samples import FreshSamples
from .optima import BETWEEN, DESCENT, EXAMINED, MAX_RUNNERS_UP, Basins, Endings

SHARE = 8
"""The analysis evaluates at most the search's evaluations divided by this."""
ENDINGS_NEED = EXAMINED * (1 + len(BETWEEN)) + MAX_RUNNERS_UP * DESCENT
"""Evaluations that the endings of a search take at most, about."""


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """How sure a search is of its result.

    Attributes
    ----------
    voxels : int
        Voxels (or scenes of objects) that the search has not seen, on which all is evaluated.
    evaluations : int
        Rigs that were evaluated.
    axes : tuple of AxisCost
        What a step costs, by sensor and axis.
    constraints : tuple of ActiveConstraint
        Those that are active; one without names says that a longer search would gain.
    endings : Endings or None
        Where the starts ended; None where the budget was too small.
    by_ap : bool
        Whether the search was by expected AP: costs and gains are then differences of the AP, and
        positive is still worse.
    """

    voxels: int
    evaluations: int
    axes: tuple[AxisCost, ...]
    constraints: tuple[ActiveConstraint, ...]
    endings: Endings | None
    by_ap: bool = False

    @property
    def active(self) -> tuple[ActiveConstraint, ...]:
        """The active constraints."""
        return tuple(each for each in self.constraints if each.constraints)

    @property
    def unfinished(self) -> ActiveConstraint | None:
        """An allowed step that would be better: the search was too short for it."""
        return next((each for each in self.constraints if not each.constraints), None)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data, as result.json holds it."""
        return {
            "voxels": self.voxels,
            "evaluations": self.evaluations,
            "axes": [each.to_dict() for each in self.axes],
            "constraints": [each.to_dict() for each in self.constraints],
            "endings": None if self.endings is None else self.endings.to_dict(),
            **({"objective": EXPECTED_AP} if self.by_ap else {}),
        }


def is_analysed(study: Study) -> bool:
    """Return whether the result of a long search is analysed.

    A search over states and weathers minimises what no fresh sample has.
    """
    return study.search.goals.sensitivity != OFF and study.search.conditions is None


def budget_of(study: Study, evaluations: int) -> tuple[tuple[float, ...], bool] | None:
    """Return the steps of the table and whether the endings are examined; None for no analysis.

    Short searches have less, so that the analysis does not outlast them.
    """
    wanted, sensors = study.search.goals.sensitivity, len(study.rig)
    if not is_analysed(study):
        return None
    if wanted == FULL:
        return (NEAR, FAR), True
    left = evaluations // SHARE
    near = 2 * len(AXES) * sensors  # back and forth
    if left < near:
        return None
    steps = (NEAR, FAR) if left >= 2 * near else (NEAR,)
    return steps, left >= 2 * near + ENDINGS_NEED


def analyse(
    start: Study,
    best: Study,
    archive: Archive,
    evaluations: int,
    samples: FreshSamples,
    goes_on: Callable[[], bool] = lambda: True,
) -> Sensitivity | None:
    """Return the sensitivity analysis of a search's result; None where its budget is too small.

    The result depends on the study alone, not on workers or time. `start` is the study as it was
    given, `best` with the result, `archive` what the search evaluated in so many `evaluations`.
    `samples` are of `best`. Where `goes_on` returns False, the analysis is given up.
    """
    parts = budget_of(best, evaluations)
    if parts is None or not goes_on():
        return None
    steps, with_endings = parts
    space = start.search_space()
    design = Neighbourhood(best.rig, space)
    axes = []
    for row in flatness(samples, design.status, steps):
        axes.append(row)
        if not goes_on():
            return None
    found = active_constraints(axes, design, _unmet_by(best))
    endings = Basins(samples, space).endings(archive.placements()) if with_endings else None
    return Sensitivity(
        samples.size, samples.evaluations, tuple(axes), found, endings, is_by_ap(best)
    )


def _unmet_by(study: Study) -> Unmet | None:
    """Return what names the kept requirements that a rig does not meet; None without any."""
    if not study.search.requirements or not study.requirements:
        return None
    checker = study.checker()
    names = [each.name for each in checker.requirements]

    def unmet(rig: Rig) -> list[str]:
        return [n for n, off in zip(names, checker.shortfalls(rig), strict=True) if off]

    return unmet

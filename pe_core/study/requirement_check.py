"""A study held to its requirements: the checker, and verdicts with mounting errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..base.errors import InputError
from ..scene.rig import Rig
from ..scoring.requirements import Requirement, RequirementChecker, Verdict
from ..search import Tolerance, mounted_off
from .condition_check import ConditionedChecker

if TYPE_CHECKING:
    from .study import Study


def checker_of(study: Study) -> RequirementChecker:
    """Return what holds rigs to a study's requirements.

    Raises
    ------
    InputError
        When a zone cannot be placed round the vehicle, the rig lacks a kind of sensor, or mounting
        errors are asked for that the study does not state.
    """
    if any(each.under.states or each.under.weathers for each in study.requirements):
        checker: RequirementChecker = ConditionedChecker(study)
    else:
        checker = RequirementChecker(
            study.requirements,
            study.vehicle,
            model=study.model,
            reference=study.reference,
            space=study.space,
        )
    checker.check_rig(study.rig)
    for each in study.requirements:
        if each.under.mounting and not study.search.tolerance.mounts_off:
            who = f"requirement {each.name!r}"
            raise InputError(who, "under.mounting", "errors in [optimize.tolerance]", "none")
    return checker


def verdicts_of(
    study: Study, rig: Rig, checker: RequirementChecker | None = None
) -> tuple[Verdict, ...]:
    """Return the verdicts on a rig, with each combination of the study's mounting errors."""
    if not study.requirements:
        return ()
    search = study.search
    cases = mounting_cases(study.requirements, rig, search.tolerance, search.seed)
    return (checker or checker_of(study)).check(rig, cases=cases)


def mounting_cases(
    requirements: Sequence[Requirement], rig: Rig, tolerance: Tolerance, seed: int
) -> list[Rig]:
    """Return the rig with each draw of the mounting errors, if a requirement asks for them."""
    if not any(each.under.mounting for each in requirements):
        return []
    return mounted_off(rig, tolerance, seed)[: tolerance.draws]

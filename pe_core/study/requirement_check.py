"""A study held to its requirements: the checker, and verdicts with mounting errors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ..base.errors import InputError
from ..prior import HIGHWAY_CLASSES, ROAD_CLASSES
from ..scene.rig import Rig
from ..scoring.requirements import (
    BODIES,
    CheckStep,
    Requirement,
    RequirementChecker,
    Verdict,
)
from ..search import Tolerance, mounted_off
from .condition_check import ConditionedChecker

if TYPE_CHECKING:
    from .study import Study


def checker_of(study: Study, as_drawn: RequirementChecker | None = None) -> RequirementChecker:
    """Return what holds rigs to a study's requirements.

    `as_drawn` is one of the same requirements and vehicle, if there is one already: what it has
    measured is not measured again.

    Raises
    ------
    InputError
        When a zone cannot be placed round the vehicle, the rig lacks a kind of sensor, or mounting
        errors are asked for that the study does not state.
    """
    _check_classes(study)
    if any(each.under.states or each.under.weathers for each in study.requirements):
        checker: RequirementChecker = ConditionedChecker(study, as_drawn)
    else:
        checker = as_drawn or RequirementChecker(
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


def _check_classes(study: Study) -> None:
    """Raise `InputError` for a body of a class that nothing is known of: a typing error."""
    known = {
        *study.prior.class_names,
        *(each.name for each in (*ROAD_CLASSES, *HIGHWAY_CLASSES)),
        *(body.class_name for body in BODIES.values()),
        *(name for curves in study.model.objects.values() for name in curves),
        *(name for sensor in study.rig for name in getattr(sensor.model, "rcs", ())),
    }
    for each in study.requirements:
        for body in each.bodies:
            if body.class_name is not None and body.class_name not in known:
                listed = ", ".join(sorted(filter(None, known)))
                who = f"requirement {each.name!r}"
                raise InputError(who, "body.class", f"one of {listed}", repr(body.class_name))


def check_steps(
    study: Study, rig: Rig, checker: RequirementChecker | None = None
) -> Iterator[CheckStep]:
    """Yield the verdicts on a rig, with each combination of the study's mounting errors, one after
    the other, with steps in between."""
    if not study.requirements:
        return
    search = study.search
    cases = mounting_cases(study.requirements, rig, search.tolerance, search.seed)
    yield from (checker or checker_of(study)).steps(rig, cases=cases)


def verdicts_of(
    study: Study, rig: Rig, checker: RequirementChecker | None = None
) -> tuple[Verdict, ...]:
    """Return the verdicts of `check_steps`."""
    steps = check_steps(study, rig, checker)
    return tuple(step.verdict for step in steps if step.verdict is not None)


def mounting_cases(
    requirements: Sequence[Requirement], rig: Rig, tolerance: Tolerance, seed: int
) -> list[Rig]:
    """Return the rig with each draw of the mounting errors, if a requirement asks for them."""
    if not any(each.under.mounting for each in requirements):
        return []
    return mounted_off(rig, tolerance, seed)[: tolerance.draws]

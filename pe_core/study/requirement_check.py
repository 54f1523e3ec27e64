"""A study's requirements: in states and weathers, with mounting errors, of known classes.

Of `[requirement.under] states, weathers`: a requirement has to be met as drawn and in clear air,
and in each named state and weather, and in both together. Its zone stays where the vehicle as drawn
puts it: an open door moves no zone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from ..base.errors import InputError
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from ..scoring.requirements import CheckStep, Requirement, RequirementChecker, Verdict
from ..search import Tolerance, mounted_off
from .condition_set import Conditions, StateInWeather

EVERY = "*"
"""Stands for all states, or all weathers, of a study."""


class ConditionedChecker(RequirementChecker):
    """Holds rigs to requirements as drawn, and under the conditions that these name.

    The worst verdict counts: one that is not met, or the smallest margin.

    Parameters
    ----------
    requirements : sequence of Requirement
    vehicle : Vehicle or None
        As drawn.
    conditions : Conditions
        Those of the study, whose names requirements have.
    as_drawn : RequirementChecker, optional
        What holds rigs to the same requirements as drawn and in clear air; made where it is None.
    **options
        AP curves, axles and space, as of a `RequirementChecker`.
    """

    def __init__(
        self,
        requirements: Sequence[Requirement],
        vehicle: Vehicle | None,
        conditions: Conditions,
        as_drawn: RequirementChecker | None = None,
        **options: Any,
    ) -> None:
        self._again = partial(ConditionedChecker, requirements, vehicle, conditions, **options)
        self._as_drawn = as_drawn or RequirementChecker(requirements, vehicle, **options)
        self.requirements, self.zones = self._as_drawn.requirements, self._as_drawn.zones
        self.vehicle = vehicle
        by_condition: dict[StateInWeather, list[int]] = {}
        for number, requirement in enumerate(requirements):
            for condition in conditions_of(requirement, conditions):
                by_condition.setdefault(condition, []).append(number)
        self._parts = []
        for condition, numbers in by_condition.items():
            own, moved = [requirements[n] for n in numbers], condition.vehicle(vehicle)
            checker = RequirementChecker(own, moved, anchor=vehicle, **options)
            self._parts.append((condition, numbers, checker))

    def __reduce__(self) -> tuple[object, ...]:
        return self._again, ()

    def steps(
        self, rig: Rig, *, preview: bool = False, cases: Sequence[Rig] = ()
    ) -> Iterator[CheckStep]:
        """Yield the worst verdict on each requirement under its conditions, with steps between."""
        drawn = self._as_drawn.steps(rig, preview=preview, cases=cases)
        parts = []
        for condition, numbers, checker in self._parts:
            moved, others = self._under(condition, rig), [self._under(condition, c) for c in cases]
            parts.append((condition, numbers, checker.steps(moved, preview=preview, cases=others)))
        number = 0
        for step in drawn:
            worst = step.verdict
            if worst is None:
                yield step
                continue
            for condition, numbers, steps in parts:
                for other in steps if number in numbers else ():
                    if other.verdict is not None:  # the next one is of another requirement
                        if _rank(other.verdict) < _rank(worst):
                            worst = replace(other.verdict, condition=condition.name)
                        break
                    yield CheckStep(step.fraction)
            number += 1
            yield CheckStep(step.fraction, worst)

    def shortfalls(self, rig: Rig, cases: Sequence[Rig] = ()) -> tuple[float, ...]:
        """Return for each requirement the largest shortfall under its conditions."""
        largest = list(self._as_drawn.shortfalls(rig, cases))
        for condition, numbers, checker in self._parts:
            moved, others = self._under(condition, rig), [self._under(condition, c) for c in cases]
            for n, value in zip(numbers, checker.shortfalls(moved, others), strict=True):
                largest[n] = max(largest[n], value)
        return tuple(largest)

    def _under(self, condition: StateInWeather, rig: Rig) -> Rig:
        return condition.rig(rig, self.vehicle)


def conditions_of(requirement: Requirement, conditions: Conditions) -> Iterator[StateInWeather]:
    """Yield the conditions under which a requirement has to be met, besides as drawn.

    `InputError` for an unknown state or weather; the nearest names are offered.
    """
    under = requirement.under
    states = _expanded(under.states, [each.name for each in conditions.states])
    weathers = _expanded(under.weathers, [each.name for each in conditions.weathers])
    for state in (None, *states):
        for weather in (None, *weathers):
            if state is not None or weather is not None:
                yield conditions.one(state, weather)


def _expanded(names: Sequence[str], known: Sequence[str]) -> list[str]:
    return list(dict.fromkeys(n for name in names for n in (known if name == EVERY else [name])))


def _rank(verdict: Verdict) -> tuple[bool, float, float]:
    """Return what orders verdicts, the worst first."""
    margin = float("inf") if verdict.margin is None else verdict.margin
    return verdict.met, margin, -(verdict.blind_m2 or 0.0) if verdict.met else verdict.share


def check_classes(requirements: Sequence[Requirement], known: Iterable[str | None]) -> None:
    """Raise `InputError` for a body of a class that is none of the known: a typing error."""
    names = {name for name in known if name is not None}
    for each in requirements:
        for body in each.bodies:
            if body.class_name is not None and body.class_name not in names:
                who, expected = f"requirement {each.name!r}", f"one of {', '.join(sorted(names))}"
                raise InputError(who, "body.class", expected, repr(body.class_name))


def mounting_cases(
    requirements: Sequence[Requirement], rig: Rig, tolerance: Tolerance, seed: int
) -> list[Rig]:
    """Return the rig with each draw of the mounting errors, if a requirement asks for them."""
    if not any(each.under.mounting for each in requirements):
        return []
    return mounted_off(rig, tolerance, seed)[: tolerance.draws]

"""Requirements in states and weathers: `[requirement.under] states, weathers`.

A requirement has to be met as drawn and in clear air, and in each named state and weather, and in
both together. Its zone stays where the vehicle as drawn puts it: an open door moves no zone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..scene.rig import Rig
from ..scoring.requirements import Requirement, RequirementChecker, Verdict
from .condition_set import Conditions, StateInWeather

if TYPE_CHECKING:
    from .study import Study

EVERY = "*"
"""Stands for all states, or all weathers, of a study."""


class ConditionedChecker(RequirementChecker):
    """Holds rigs to requirements as drawn, and under the conditions that these name.

    The worst verdict counts: one that is not met, or the smallest margin.
    """

    def __init__(self, study: Study) -> None:
        options: dict[str, Any] = {
            "model": study.model,
            "reference": study.reference,
            "space": study.space,
        }
        super().__init__(study.requirements, study.vehicle, **options)
        self._study = study
        by_condition: dict[StateInWeather, list[int]] = {}
        for number, requirement in enumerate(study.requirements):
            for condition in conditions_of(requirement, study.conditions):
                by_condition.setdefault(condition, []).append(number)
        self._parts = [
            (
                condition,
                numbers,
                RequirementChecker(
                    [study.requirements[n] for n in numbers],
                    condition.vehicle(study.vehicle),
                    anchor=study.vehicle,
                    **options,
                ),
            )
            for condition, numbers in by_condition.items()
        ]

    def __reduce__(self) -> tuple[object, ...]:
        return ConditionedChecker, (self._study,)

    def check(
        self, rig: Rig, *, preview: bool = False, cases: Sequence[Rig] = ()
    ) -> tuple[Verdict, ...]:
        """Return the worst verdict on each requirement under its conditions."""
        worst = list(super().check(rig, preview=preview, cases=cases))
        for condition, numbers, checker in self._parts:
            moved, others = self._under(condition, rig), [self._under(condition, c) for c in cases]
            for n, verdict in zip(
                numbers, checker.check(moved, preview=preview, cases=others), strict=True
            ):
                if _rank(verdict) < _rank(worst[n]):
                    worst[n] = replace(verdict, condition=condition.name)
        return tuple(worst)

    def shortfalls(self, rig: Rig, cases: Sequence[Rig] = ()) -> tuple[float, ...]:
        """Return for each requirement the largest shortfall under its conditions."""
        largest = list(super().shortfalls(rig, cases))
        for condition, numbers, checker in self._parts:
            moved, others = self._under(condition, rig), [self._under(condition, c) for c in cases]
            for n, value in zip(numbers, checker.shortfalls(moved, others), strict=True):
                largest[n] = max(largest[n], value)
        return tuple(largest)

    def _under(self, condition: StateInWeather, rig: Rig) -> Rig:
        return condition.rig(rig, self._study.vehicle)


def conditions_of(requirement: Requirement, conditions: Conditions) -> Iterator[StateInWeather]:
    """Yield the conditions under which a requirement has to be met, besides as drawn.

    Raises
    ------
    InputError
        For an unknown state or weather; the nearest names are offered.
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

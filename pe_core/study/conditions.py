"""The conditions of a study, states of the vehicle and weathers, and requirements under them.

In the study file conditions are `[[state]]` and `[[weather]]`.

Of `[requirement.robust_to] states, weathers`: a requirement has to be met as drawn and in clear
air, and in each named state and weather, and in both together. Its zone stays where the vehicle as
drawn puts it: an open door moves no zone. Requirements have mounting errors and classes of a study,
too.
"""

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, TypeVar

from ..base.errors import InputError, require_kind, require_name, shown
from ..base.setting import Part
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from ..scene.vehicle_state import State
from ..scoring.requirements import CheckStep, Requirement, RequirementChecker, Verdict
from ..search import Tolerance, mounted_off
from ..sensors.weather import Weather, checked_weights

T = TypeVar("T", State, Weather)
MAX_CONDITIONS = 200
AS_DRAWN = "as drawn"
CLEAR = "clear"
"""Names of the state and of the weather of a study that has none."""
EVERY = "*"  # Stands for all states, or all weathers, of a study


@dataclass(frozen=True)
class StateInWeather:
    """A state of the vehicle in a weather; None: as it is drawn, and clear air."""

    state: State | None = None
    weather: Weather | None = None

    @property
    def name(self) -> str:
        """Names of state and weather, "door open, fog"."""
        names = [each.name for each in (self.state, self.weather) if each is not None]
        return ", ".join(names) or CLEAR

    @property
    def weight(self) -> float:
        """Product of the weights of state and weather."""
        weight = 1.0 if self.state is None else self.state.weight
        return weight * (1.0 if self.weather is None else self.weather.weight)

    @property
    def is_as_drawn(self) -> bool:
        """Whether the vehicle is as it is drawn, in clear air."""
        state = self.state
        weather = self.weather
        return (state is None or state.is_as_drawn) and (weather is None or weather.is_clear)

    def __call__(self, rig: Rig, vehicle: Vehicle | None) -> tuple[Rig, Vehicle | None]:
        """Return a rig and a vehicle, which are as they are drawn, under this condition."""
        return self.rig(rig, vehicle), self.vehicle(vehicle)

    def vehicle(self, vehicle: Vehicle | None) -> Vehicle | None:
        """Return the vehicle under this condition."""
        return vehicle if self.state is None else self.state.vehicle(vehicle)

    def rig(self, rig: Rig, vehicle: Vehicle | None) -> Rig:
        """Return a rig under this condition; `vehicle` is as it is drawn."""
        moved = rig if self.state is None else self.state.rig(rig, vehicle)
        return moved if self.weather is None else self.weather(moved)[0]


@dataclass(frozen=True)
class Conditions:
    """States and weathers of a study; each state occurs in each weather.

    `InputError` when names repeat, all weights are 0, or there are more than `MAX_CONDITIONS`.
    """

    states: Annotated[Sequence[State], Part(key="state")] = ()
    weathers: Annotated[Sequence[Weather], Part(key="weather")] = ()

    def __post_init__(self) -> None:
        for key, source, kind in (("states", "state", State), ("weathers", "weather", Weather)):
            items = tuple(getattr(self, key))
            for each in items:
                require_kind("study", key, each, kind)
            checked_weights(f"[[{source}]]", items)
            object.__setattr__(self, key, items)
        if len(self.all) > MAX_CONDITIONS:
            expected = f"at most {MAX_CONDITIONS} states times weathers"
            raise InputError("study", "state", expected, len(self.all))

    def __bool__(self) -> bool:
        return bool(self.states or self.weathers)

    @property
    def all(self) -> tuple[StateInWeather, ...]:
        """Every state in every weather, by state."""
        states: Sequence[State | None] = self.states or (None,)
        weathers: Sequence[Weather | None] = self.weathers or (None,)
        return tuple(StateInWeather(state, weather) for state in states for weather in weathers)

    def one(self, state: str | None = None, weather: str | None = None) -> StateInWeather:
        """Return the condition of a state and a weather by name; None: as drawn, clear air.

        `InputError` for an unknown name; the nearest ones are offered.
        """
        return StateInWeather(
            _named("state", state, self.states), _named("weather", weather, self.weathers)
        )

    def check(self, vehicle: Vehicle | None, rig: Rig) -> None:
        """Raise `InputError` for a state with parts or sensors that there are not."""
        for state in self.states:
            state.moves(vehicle, rig)
            for name in (name for motion in state.motions for name in motion.sensors or ()):
                require_name(f"state {state.name!r}", "move.sensors", name, [s.name for s in rig])

    def without(self, gone: Set[str]) -> "Conditions":
        """Return the conditions where states no longer name sensors that are gone."""
        states = []
        for state in self.states:
            motions = [
                replace(each, sensors=each.sensors and [n for n in each.sensors if n not in gone])
                for each in state.motions
                if each.parts or set(each.sensors or ()) - gone
            ]
            states.append(replace(state, motions=motions))
        return replace(self, states=states)


def _named(kind: str, name: str | None, items: Sequence[T]) -> T | None:
    if name is None:
        return None
    if not items:
        raise InputError("study", kind, f"[[{kind}]] in the study", shown(name))
    require_name("study", kind, name, [each.name for each in items])
    return next(each for each in items if each.name == name)


class ConditionedChecker(RequirementChecker):
    """Holds rigs to requirements as drawn, and under the conditions that these name.

    The worst verdict counts: one that is not met, or the smallest margin. The vehicle is as drawn;
    `as_drawn` checks the same requirements as drawn and in clear air, and is made where it is None.
    Further options are those of a `RequirementChecker`.
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
        self.requirements = self._as_drawn.requirements
        self.zones = self._as_drawn.zones
        self.vehicle = vehicle
        by_condition: dict[StateInWeather, list[int]] = {}
        for number, requirement in enumerate(requirements):
            for condition in conditions_of(requirement, conditions):
                by_condition.setdefault(condition, []).append(number)
        self._parts = []
        for condition, numbers in by_condition.items():
            own = [requirements[n] for n in numbers]
            moved = condition.vehicle(vehicle)
            checker = RequirementChecker(own, moved, **options)
            self._parts.append((condition, numbers, checker))

    def __reduce__(self) -> tuple[object, ...]:
        return self._again, ()

    def steps(
        self, rig: Rig, *, preview: bool = False, cases: Sequence[Rig] = (), early: bool = False
    ) -> Iterator[CheckStep]:
        """Yield the worst verdict on each requirement under its conditions, with steps between. Of
        a requirement under conditions none is early."""
        drawn = self._as_drawn.steps(rig, preview=preview, cases=cases, early=early)
        conditioned = {self.requirements[n].name for _, numbers, _ in self._parts for n in numbers}
        parts = []
        for condition, numbers, checker in self._parts:
            moved = self._under(condition, rig)
            others = [self._under(condition, c) for c in cases]
            parts.append((condition, numbers, checker.steps(moved, preview=preview, cases=others)))
        number = 0
        for step in drawn:
            if step.verdict is None:
                yield step
                continue
            if step.is_early:
                is_whole = step.verdict.name not in conditioned
                yield step if is_whole else CheckStep(step.fraction)
                continue
            found = [step.verdict]
            for condition, numbers, steps in parts:
                for other in steps if number in numbers else ():
                    if other.verdict is not None:  # the next one is of another requirement
                        found.append(replace(other.verdict, condition=condition.name))
                        break
                    yield CheckStep(step.fraction)
            number += 1
            yield CheckStep(step.fraction, worst_verdict(found))

    def shortfalls(self, rig: Rig, cases: Sequence[Rig] = ()) -> tuple[float, ...]:
        """Return for each requirement the largest shortfall under its conditions."""
        largest = list(self._as_drawn.shortfalls(rig, cases))
        for condition, numbers, checker in self._parts:
            moved = self._under(condition, rig)
            others = [self._under(condition, c) for c in cases]
            for n, value in zip(numbers, checker.shortfalls(moved, others), strict=True):
                largest[n] = max(largest[n], value)
        return tuple(largest)

    def _under(self, condition: StateInWeather, rig: Rig) -> Rig:
        return condition.rig(rig, self.vehicle)


def conditions_of(requirement: Requirement, conditions: Conditions) -> Iterator[StateInWeather]:
    """Yield the conditions under which a requirement has to be met, besides as drawn. `InputError`
    for an unknown state or weather; the nearest names are offered."""
    under = requirement.robust_to
    states = _expanded(under.states, [each.name for each in conditions.states])
    weathers = _expanded(under.weathers, [each.name for each in conditions.weathers])
    for state in (None, *states):
        for weather in (None, *weathers):
            if state is not None or weather is not None:
                yield conditions.one(state, weather)


def _expanded(names: Sequence[str], known: Sequence[str]) -> list[str]:
    return list(dict.fromkeys(n for name in names for n in (known if name == EVERY else [name])))


def worst_verdict(verdicts: Sequence[Verdict]) -> Verdict:
    """Return the worst of the verdicts on one requirement, the first of equal ones. What it says of
    lost sensors, and what it leaves to spare, hold under all conditions: each may need another."""
    worst = min(verdicts, key=_rank)
    without = {name: all(v.without[name] for v in verdicts) for name in worst.without}
    fewest, most = zip(*(v.sensors for v in verdicts), strict=True)
    whole = all(v.met_whole for v in verdicts)
    found = replace(worst, without=without, sensors=(min(fewest), max(most)), met_whole=whole)
    if worst.ground is None:
        return found
    every = [(v.ground.spare_m2, v.ground.spare_out) for v in verdicts if v.ground is not None]
    area, out = (None if None in each else min(each) for each in zip(*every, strict=True))
    return replace(found, ground=replace(worst.ground, spare_m2=area, spare_out=out))


def _rank(verdict: Verdict) -> tuple[bool, float, float]:
    """Return what orders verdicts, the worst first."""
    margin = float("inf") if verdict.margin is None else verdict.margin
    return verdict.met, margin, -(verdict.blind_m2 or 0.0) if verdict.met else verdict.share


def check_classes(requirements: Sequence[Requirement], known: Iterable[str | None]) -> None:
    """Raise `InputError` for a body of a class that is none of the known: a typing error."""
    names = {name for name in known if name is not None}
    for each in requirements:
        for body in each.bodies:
            if body.class_name is not None:
                who = f"requirement {each.name!r}"
                require_name(who, "body.class", body.class_name, sorted(names))


def mounting_cases(
    requirements: Sequence[Requirement], rig: Rig, tolerance: Tolerance, seed: int
) -> list[Rig]:
    """Return the rig with each draw of the mounting errors, if a requirement asks for them."""
    if not any(each.robust_to.mounting for each in requirements):
        return []
    return mounted_off(rig, tolerance, seed)[: tolerance.draws]

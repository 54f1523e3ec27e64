"""The conditions of a study: states of the vehicle, weathers, and both together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from ..base.errors import InputError
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from ..scene.vehicle_state import State, check_name
from ..sensors.weather import Weather, checked_weights

T = TypeVar("T", State, Weather)

MAX_CONDITIONS = 200
AS_DRAWN, CLEAR = "as drawn", "clear"
"""Names of the state and of the weather of a study that has none."""


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
        state, weather = self.state, self.weather
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

    Raises
    ------
    InputError
        When names repeat, all weights are 0, or there are more than `MAX_CONDITIONS`.
    """

    states: Sequence[State] = ()
    weathers: Sequence[Weather] = ()

    def __post_init__(self) -> None:
        for key, source, kind in (("states", "state", State), ("weathers", "weather", Weather)):
            items = tuple(getattr(self, key))
            for each in items:
                if not isinstance(each, kind):
                    raise InputError("study", key, f"a {kind.__name__}", type(each).__name__)
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

        Raises
        ------
        InputError
            For an unknown name; the nearest ones are offered.
        """
        return StateInWeather(
            _named("state", state, self.states), _named("weather", weather, self.weathers)
        )

    def check(self, vehicle: Vehicle | None, rig: Rig) -> None:
        """Raise `InputError` for a state with parts or sensors that there are not."""
        for state in self.states:
            state.moves(vehicle, rig)


def _named(kind: str, name: str | None, items: Sequence[T]) -> T | None:
    if name is None:
        return None
    check_name("study", kind, name, [each.name for each in items])
    return next(each for each in items if each.name == name)

"""States and weathers in the study file: `[[state]]` and `[[weather]]`."""

from __future__ import annotations

import math
from typing import Any

from ..base.degrees import degrees_in_file
from ..base.errors import InputError
from ..base.setting import settings_of
from ..base.setting_file import key_of, read_settings, settings_table
from ..base.table_reader import Table
from ..base.values import A_NAME
from ..scene.vehicle_state import ZERO, Motion, State
from ..sensors.weather import Weather
from .condition_set import Conditions

BODY = ("heave", "roll_rad", "pitch_rad")


def read_conditions(table: Table) -> Conditions:
    """Return the conditions of a study's table; `InputError` with the file and the key."""
    states = [_read_state(each) for each in table.tables("state")]
    weathers = [_read_weather(each) for each in table.tables("weather")]
    try:
        return Conditions(states, weathers)
    except InputError as error:
        raise InputError(
            table.source, f"{error.source}: {error.field}", error.expected, error.found
        ) from None


def condition_tables(conditions: Conditions) -> dict[str, Any]:
    """Return the tables that `read_conditions` reads; None for what is absent."""
    return {
        "weather": [_weather_table(each) for each in conditions.weathers] or None,
        "state": [state_table(each) for each in conditions.states] or None,
    }


def state_from_dict(data: Any, source: str = "state") -> State:
    """Return a state of the plain data of its table."""
    return _read_state(Table(data, source))


def _read_weather(table: Table) -> Weather:
    name = table.text("name", rule=A_NAME)
    values = read_settings(table, Weather)
    table.finish()
    return _made(table, lambda: Weather(name, **values))


def _read_state(table: Table) -> State:
    name = table.text("name", rule=A_NAME)
    values = read_settings(table, State, ("weight", "frame"))
    motions = [_read_motion(each) for each in table.tables("move")]
    body = table.table("body")
    values |= read_settings(body, State, BODY)
    about, unsprung = _triple(body, "about"), body.texts("unsprung", ())
    body.finish()
    table.finish()
    return _made(table, lambda: State(name, motions, **values, about=about, unsprung=unsprung))


def _read_motion(table: Table) -> Motion:
    parts, sensors = table.texts("parts"), table.texts("sensors", None)
    roll, pitch, yaw = (math.radians(degrees) for degrees in _triple(table, "rotation"))
    about, move = _triple(table, "about"), _triple(table, "move")
    table.finish()
    return _made(table, lambda: Motion(parts, (roll, pitch, yaw), about, move, sensors))


def _triple(table: Table, key: str) -> tuple[float, float, float]:
    x, y, z = table.numbers(key, 3, ZERO)
    return x, y, z


def _made(table: Table, make: Any) -> Any:
    """Return what `make` makes; an error of it names the table in the file."""
    try:
        return make()
    except InputError as error:
        field = error.field.rpartition(".")[2]
        raise table.error(field, error.expected, error.found) from None


def _weather_table(weather: Weather) -> dict[str, Any]:
    return {"name": weather.name, **_changed(weather, tuple(settings_of(Weather)))}


def state_table(state: State) -> dict[str, Any]:
    """Return the table of a state, without what has its default."""
    body = _changed(state, BODY)
    if state.about != ZERO:
        body["about"] = list(state.about)
    if state.unsprung:
        body["unsprung"] = list(state.unsprung)
    moves = [_motion_table(motion) for motion in state.motions]
    own = {"name": state.name, **_changed(state, ("weight", "frame"))}
    return own | ({"body": body} if body else {}) | ({"move": moves} if moves else {})


def _motion_table(motion: Motion) -> dict[str, Any]:
    table: dict[str, Any] = {"parts": list(motion.parts)}
    if motion.rotation != ZERO:
        table["rotation"] = [degrees_in_file(angle) for angle in motion.rotation]
    for key in ("about", "move"):
        if (value := getattr(motion, key)) != ZERO:
            table[key] = list(value)
    if motion.sensors is not None:
        table["sensors"] = list(motion.sensors)
    return table


def _changed(instance: Any, names: tuple[str, ...]) -> dict[str, Any]:
    """Return the settings that differ from their defaults, by key."""
    table, settings = settings_table(instance, names), settings_of(type(instance))
    return {
        key_of(name): table[key_of(name)]
        for name in names
        if getattr(instance, name) != settings[name].default
    }

"""States and weathers in the study file: `[[state]]` and `[[weather]]`."""

from __future__ import annotations

from functools import partial
from typing import Any

from ..base.errors import InputError
from ..base.setting_file import changed_settings, read_settings
from ..base.table_reader import Table
from ..base.values import A_NAME
from ..scene.vehicle_state import Motion, State
from ..sensors.weather import Weather
from .condition_set import Conditions

OF_STATE, BODY = ("weight", "frame"), ("heave", "roll_rad", "pitch_rad", "about", "unsprung")
"""Settings of the tables [[state]] and [state.body]."""


def read_conditions(table: Table) -> Conditions:
    """Return the conditions of a study's table; `InputError` with the file and the key."""
    states, weathers = [_read_state(each) for each in table.tables("state")], []
    for each in table.tables("weather"):
        name, values = each.text("name", rule=A_NAME), read_settings(each, Weather)
        each.finish()
        weathers.append(_made(each, partial(Weather, name, **values)))
    try:
        return Conditions(states, weathers)
    except InputError as error:
        raise InputError(
            table.source, f"{error.source}: {error.field}", error.expected, error.found
        ) from None


def condition_tables(conditions: Conditions) -> dict[str, Any]:
    """Return the tables that `read_conditions` reads; None for what is absent."""
    return {
        "weather": [{"name": each.name, **changed_settings(each)} for each in conditions.weathers]
        or None,
        "state": [state_table(each) for each in conditions.states] or None,
    }


def state_from_dict(data: Any, source: str = "state") -> State:
    """Return a state of the plain data of its table."""
    return _read_state(Table(data, source))


def _read_state(table: Table) -> State:
    name, body = table.text("name", rule=A_NAME), table.table("body")
    values = read_settings(table, State, OF_STATE) | read_settings(body, State, BODY)
    body.finish()
    motions = []
    for each in table.tables("move"):
        motion = read_settings(each, Motion)
        each.finish()
        motions.append(_made(each, partial(Motion, **motion)))
    table.finish()
    return _made(table, lambda: State(name, motions, **values))


def _made(table: Table, make: Any) -> Any:
    """Return what `make` makes; an error of it names the table in the file."""
    try:
        return make()
    except InputError as error:
        field = error.field.rpartition(".")[2]
        raise table.error(field, error.expected, error.found) from None


def state_table(state: State) -> dict[str, Any]:
    """Return the table of a state, without what has its default."""
    body = changed_settings(state, BODY)
    moves = [changed_settings(motion) for motion in state.motions]
    own = {"name": state.name, **changed_settings(state, OF_STATE)}
    return own | ({"body": body} if body else {}) | ({"move": moves} if moves else {})

"""The table [optimize] of a study, bounds and choices of its sensors: read and written."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..base.errors import InputError, shown
from ..base.setting import key_of, read_declared, read_settings, settings_of, settings_table
from ..base.table_reader import Table
from ..base.values import A_NAME, degrees_in_file
from ..geometry.poses import Pose
from ..scene.rig import SensorModel
from ..search import (
    AXES,
    DEFAULT_METHOD,
    METHODS,
    POSITION_AXES,
    SCHEDULED_METHOD,
    Choice,
    Option,
    Schedule,
    Selection,
    Tolerance,
    checked_bounds,
)
from ..search.goals import Front, Goals, Start, Stop
from ..search.tolerance import CASES, ERRORS
from ..sensors import KINDS
from .mounting_file import mounting_tables, read_mounting
from .study import ENTROPY, Search

Bounds = tuple[float, float]
KEYS_FIRST = ("evaluations", "seed", "samples")
"""The order of these keys is part of a study's fingerprint; keys that came later follow."""
Read = Callable[[Table], SensorModel]
AXES_OF_A_POSE = 6
"""x, y, z [m], roll, pitch, yaw [deg]."""


def read_limits(table: Table) -> dict[str, Bounds]:
    """Return the bounds of a sensor's axes; degrees become radians."""
    limits = {}
    for axis in AXES:
        bounds = table.raw(axis, None)
        if bounds is None:
            continue
        low, high = table.numbers(axis, 2)
        if axis not in POSITION_AXES:
            low, high = math.radians(low), math.radians(high)
        try:
            limits[axis] = checked_bounds(table.source, axis, (low, high))
        except InputError as error:
            raise table.error(axis, error.expected, shown(bounds)) from None
    table.finish()
    return limits


def read_search(
    table: Table,
    free: Mapping[str, tuple[str, ...]],
    limits: Mapping[str, Mapping[str, Bounds]],
    on: Mapping[str, str],
    folder: Path,
    *,
    is_choice: bool,
) -> Search:
    """Return the search of `[optimize]`. `free`, `limits` and `on` are free axes, bounds and mounts
    by sensor, from `[[sensor]]`; `is_choice`: the study has a choice of sensors, which is screened
    by a schedule."""
    method = table.text("method", DEFAULT_METHOD, tuple(METHODS))
    search = Search(
        free,
        limits,
        schedule=_read_schedule(table, method == SCHEDULED_METHOD or is_choice),
        mounting=read_mounting(table, on, folder),
        method=method,
        tolerance=_read_tolerance(table),
        goals=read_goals(table),
        **read_settings(table, Search),
    )
    table.finish()
    return search


def _read_schedule(table: Table, is_used: bool) -> Schedule:
    """Return the schedule; keys of one that no search would use are an error."""
    for key in () if is_used else map(key_of, settings_of(Schedule)):
        if key in table:
            expected = f'method = "{SCHEDULED_METHOD}", the only method with this key'
            found = f'method = "{table.text("method")}"' if "method" in table else "no method"
            raise table.error(key, expected, found)
    values = read_settings(table, Schedule)
    try:
        return Schedule(**values)
    except InputError as error:  # too many rounds
        raise table.error(key_of(error.field), error.expected, error.found) from None


def _read_tolerance(table: Table) -> Tolerance:
    """Return mounting errors and failures: the table `tolerance`, and two keys beside it."""
    errors = table.table("tolerance")
    values = read_settings(errors, Tolerance, ERRORS) | read_settings(table, Tolerance, CASES)
    errors.finish()
    with table.naming():
        return Tolerance(**values)


def search_table(search: Search, *, is_choice: bool) -> dict[str, Any]:
    """Return the table `[optimize]` of a search; with a schedule where one is used."""
    is_scheduled = search.method == SCHEDULED_METHOD or is_choice
    default, errors = Tolerance(), settings_table(search.tolerance, ERRORS)
    is_default = errors == settings_table(default, ERRORS)
    cases = {key: value or None for key, value in settings_table(search.tolerance, CASES).items()}
    return {
        "method": search.method,
        **settings_table(search, KEYS_FIRST),
        **settings_table(search),
        "objective": None if search.objective == ENTROPY else search.objective,
        **(settings_table(search.schedule) if is_scheduled else {}),
        "tolerance": None if is_default else errors,
        **cases,
        **goals_tables(search.goals),
        **mounting_tables(search.mounting),
    }


def in_file(name: str, value: Any) -> Any:
    """Return a value as the file holds it: angles in degrees."""
    angle = name in AXES[3:] or name.endswith("_rad")
    return degrees_in_file(value) if angle else value


def read_selection(table: Table, model: Read) -> Selection:
    """Return the choices and limits of `[[choice]]` and `[selection]`, from a study's table.
    `model` reads the model of an option from its table."""
    choices = [_read_choice(each, model) for each in table.tables("choice")]
    own = table.table("selection")
    limits = read_settings(own, Selection)
    kinds = own.table("max_of_kind")
    counts = {kind: kinds.whole(kind, None) for kind in KINDS}
    kinds.finish()
    own.finish()
    max_of_kind = {kind: count for kind, count in counts.items() if count is not None}
    with own.naming():
        return Selection(choices, max_of_kind=max_of_kind, **limits)


def selection_tables(
    selection: Selection, model: Callable[[SensorModel], str | dict[str, Any]]
) -> dict[str, Any]:
    """Return the tables that `read_selection` reads; None where there is nothing to choose."""
    limits = settings_table(selection)
    currency = limits.pop("currency")
    own = {
        **limits,
        "max_of_kind": dict(selection.max_of_kind) or None,
        "currency": currency or None,
    }
    choices = [_choice_table(choice, model) for choice in selection.choices]
    has_limits = any(value is not None for value in own.values())
    return {"choice": choices or None, "selection": own if has_limits else None}


def _read_choice(table: Table, model: Read) -> Choice:
    if "sensor" in table and "sensors" in table:
        raise table.error("sensor, sensors", "one of the two", "both")
    sensors = (table.text("sensor"),) if "sensor" in table else table.texts("sensors", ())
    mount, optional = table.text("mount", None), table.raw("optional", False)
    options = [_read_option(each, model) for each in table.tables("option")]
    table.raw("sensor", None)  # a known name, whether present or not
    table.finish()
    with table.naming():
        return Choice(options, sensors, mount, optional)


def _read_option(table: Table, model: Read) -> Option:
    with table.naming():
        chosen = model(table)
    price = read_settings(table, Option)
    table.finish()
    return Option(chosen, **price)


def _choice_table(
    choice: Choice, model: Callable[[SensorModel], str | dict[str, Any]]
) -> dict[str, Any]:
    named = {"sensor": choice.sensors[0]} if len(choice.sensors) == 1 else {}
    several = {"sensors": list(choice.sensors)} if len(choice.sensors) > 1 else {}
    return {
        **named,
        **several,
        "mount": choice.mount,
        "optional": choice.optional,
        "option": [{"model": model(o.model), **settings_table(o)} for o in choice.options],
    }


def read_goals(table: Table) -> Goals:
    """Return the goals in the table `[optimize]`; an `InputError` names the key in the file."""
    stop = read_declared(table.table("stop"), Stop)
    front = read_declared(table.table("front"), Front)
    starts = [_read_start(each) for each in table.tables("start")]
    with table.naming():
        goals = read_settings(table, Goals)
        return Goals(stop, starts=starts, front=front, **goals)


def _read_start(table: Table) -> Start:
    name, placements = table.text("name", rule=A_NAME), table.table("placements")
    poses = {}
    for sensor in placements.names:
        values = placements.numbers(sensor, AXES_OF_A_POSE)
        try:
            poses[sensor] = Pose.from_degrees(values[:3], values[3:])
        except InputError as error:
            raise placements.error(sensor, error.expected, error.found) from None
    placements.finish()
    table.finish()
    return Start(name, poses)


def goals_tables(goals: Goals) -> dict[str, Any]:
    """Return the keys that `read_goals` reads; None for those at their default."""
    default = Goals()
    own = settings_table(goals)
    return {
        "stop": None if goals.stop == default.stop else settings_table(goals.stop),
        "fixed": own.pop("fixed") or None,
        "start": [{"name": each.name, "placements": each.numbers} for each in goals.starts] or None,
        "front": None if goals.front == default.front else settings_table(goals.front),
        **own,
    }

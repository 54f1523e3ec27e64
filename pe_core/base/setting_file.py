"""Settings in a study file: read from a table by their declarations, and written to one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from .degrees import degrees_in_file
from .setting import REQUIRED, OneOf, Pair, Setting, Toggle, settings_of
from .table_reader import REQUIRED as NEEDED
from .table_reader import Table
from .values import Angle, Number, Whole


def key_of(name: str) -> str:
    """Return the key of a setting in its table: angles are in degrees there."""
    return name.replace("_rad", "_deg")


def read_settings(table: Table, cls: type, names: Iterable[str] = ()) -> dict[str, Any]:
    """Return the settings of a dataclass that a table has, defaults for the others.

    Raises
    ------
    InputError
        When a value breaks its rule; the line names the key in the file.
    """
    settings = settings_of(cls)
    return {name: _read(table, settings[name]) for name in names or settings}


def settings_table(instance: Any, names: Iterable[str] = ()) -> dict[str, Any]:
    """Return the table that `read_settings` reads; None for what is absent."""
    settings = settings_of(type(instance))
    return {
        key_of(name): value_in_file(settings[name], getattr(instance, name))
        for name in names or settings
    }


def value_in_file(setting: Setting, value: Any) -> Any:
    """Return a value as a file holds it: angles in degrees, ranges as lists."""
    if value is not None and isinstance(setting.rule, Angle):
        return degrees_in_file(value)
    return list(value) if isinstance(value, tuple) else value


def _read(table: Table, setting: Setting) -> Any:
    key, rule = key_of(setting.name), setting.rule
    default = NEEDED if setting.default is REQUIRED else setting.default
    match rule:
        case Angle():
            if key not in table:
                return table.raw(key, default)
            radians = math.radians(table.number(key))
            return rule.checked(table.source, table.field(key), radians)
        case Number():
            return table.number(key, default, rule)
        case Whole():
            return table.whole(key, default, rule)
        case OneOf():
            return table.text(key, default, rule.among)
        case Pair():
            return table.numbers(key, 2, default)
        case Toggle():
            value = table.raw(key, default)
            return rule.checked(table.source, table.field(key), value)
    raise TypeError(f"no way to read {type(rule).__name__} of {key}")

"""Settings in a study file: read from a table by their declarations, and written to one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from .degrees import degrees_in_file
from .setting import REQUIRED, Setting, Triple, settings_of
from .table_reader import REQUIRED as NEEDED
from .table_reader import Table
from .values import ANY, Angle, listed


def key_of(name: str) -> str:
    """Return the key of a setting in its table: angles are in degrees there."""
    return name.replace("_rad", "_deg")


def read_settings(
    table: Table, cls: type, names: Iterable[str] = (), default: object = None
) -> dict[str, Any]:
    """Return the settings of a dataclass that a table has, defaults for the others.

    An instance as `default` has the defaults in place of the declared ones.

    `InputError` when a value breaks its rule; the line names the key in the file.
    """
    settings = settings_of(cls)
    return {
        name: _read(table, settings[name], getattr(default, name, settings[name].default))
        for name in names or settings
    }


def settings_table(instance: Any, names: Iterable[str] = ()) -> dict[str, Any]:
    """Return the table that `read_settings` reads; None for what is absent."""
    settings = settings_of(type(instance))
    return {
        key_of(name): value_in_file(settings[name], getattr(instance, name))
        for name in names or settings
    }


def changed_settings(instance: Any, names: Iterable[str] = ()) -> dict[str, Any]:
    """Return the table that `read_settings` reads, without what has its default."""
    settings = settings_of(type(instance))
    changed = [n for n in names or settings if getattr(instance, n) != settings[n].default]
    return settings_table(instance, changed) if changed else {}


def value_in_file(setting: Setting, value: Any) -> Any:
    """Return a value as a file holds it: angles in degrees, lists for tuples."""
    if isinstance(value, tuple):
        return [value_in_file(setting, each) for each in value]
    return degrees_in_file(value) if value is not None and _is_angle(setting) else value


def _is_angle(setting: Setting) -> bool:
    rule = setting.rule
    return isinstance(rule.rule if isinstance(rule, Triple) else rule, Angle)


def _read(table: Table, setting: Setting, default: Any) -> Any:
    key = key_of(setting.name)
    value = table.raw(key, NEEDED if default is REQUIRED else default)
    if key not in table:
        return value
    source, field = table.source, table.field(key)
    if not _is_angle(setting):
        return setting.rule.checked(source, field, value)
    items = listed(value, 3) if isinstance(setting.rule, Triple) else None
    if items is None:
        return setting.rule.checked(source, field, math.radians(ANY.checked(source, field, value)))
    radians = [math.radians(ANY.checked(source, field, item)) for item in items]
    return setting.rule.checked(source, field, radians)

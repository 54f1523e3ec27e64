"""The table [optimize] of a study, and the bounds of its sensors: read and written."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..base.degrees import degrees_in_file
from ..base.errors import InputError, shown
from ..base.setting import settings_of
from ..base.setting_file import key_of, read_settings, settings_table
from ..base.table_reader import Table
from ..search import (
    AXES,
    METHODS,
    POSITION_AXES,
    Schedule,
    Tolerance,
    checked_bounds,
    checked_method,
)
from ..search.tolerance import CASES, ERRORS
from .mounting_file import mounting_tables, read_mounting
from .study import Search

Bounds = tuple[float, float]
KEYS_FIRST = ("evaluations", "seed", "samples")
"""The order of these keys is part of a study's fingerprint; keys that came later follow."""


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
) -> Search:
    """Return the search of `[optimize]`.

    `free`, `limits` and `on` are free axes, bounds and mounts by sensor, from `[[sensor]]`.
    """
    search = Search(
        free,
        limits,
        schedule=_read_schedule(table),
        mounting=read_mounting(table, on, folder),
        method=_read_method(table),
        tolerance=_read_tolerance(table),
        **read_settings(table, Search),
    )
    table.finish()
    return search


def _read_method(table: Table) -> str:
    """Return the method; by default "random" where the study has keys of a schedule."""
    scheduled = any(key_of(name) in table for name in settings_of(Schedule))
    return table.text("method", checked_method(table.source, None, scheduled), tuple(METHODS))


def _read_schedule(table: Table) -> Schedule:
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
    try:
        return Tolerance(**values)
    except InputError as error:
        raise table.error(error.field, error.expected, error.found) from None


def _tolerance_keys(tolerance: Tolerance) -> dict[str, Any]:
    """Return the keys that `_read_tolerance` reads; None for a default value."""
    default, errors = Tolerance(), settings_table(tolerance, ERRORS)
    is_default = errors == settings_table(default, ERRORS)
    cases = {key: value or None for key, value in settings_table(tolerance, CASES).items()}
    return {"tolerance": None if is_default else errors, **cases}


def search_table(search: Search) -> dict[str, Any]:
    """Return the table `[optimize]` of a search."""
    return {
        "method": search.method,
        **settings_table(search, KEYS_FIRST),
        **settings_table(search),
        **settings_table(search.schedule),
        **_tolerance_keys(search.tolerance),
        **mounting_tables(search.mounting),
    }


def in_file(name: str, value: Any) -> Any:
    """Return a value as the file holds it: angles in degrees."""
    angle = name in AXES[3:] or name.endswith("_rad")
    return degrees_in_file(value) if angle else value

"""What a search may do: its tables in the study file, and the bounds of its sensors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..errors import InputError, shown
from ..search import (
    AXES,
    METHODS,
    POSITION_AXES,
    Schedule,
    checked_bounds,
    checked_method,
)
from ..text.degrees import degrees_in_file
from ..text.tables import Table
from .mounting_file import mounting_tables, read_mounting
from .study import DEFAULT_SEARCH_SAMPLES, EVALUATIONS, SEED, Search
from .tolerance_file import read_tolerance, tolerance_keys

Bounds = tuple[float, float]


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
    """Return the search of `[optimize]`; what its sensors say of themselves is known already."""
    search = Search(
        free,
        limits,
        table.whole("seed", 0, SEED),
        table.whole("samples", DEFAULT_SEARCH_SAMPLES),
        _read_schedule(table),
        read_mounting(table, on, folder),
        _read_method(table),
        table.whole("evaluations", 0, EVALUATIONS),
        tolerance=read_tolerance(table),
    )
    table.finish()
    return search


def _read_method(table: Table) -> str:
    """Return the method; a study with a schedule and none means the one that has schedules."""
    scheduled = any(_key(field.name) in table for field in fields(Schedule))
    return table.text("method", checked_method(table.source, None, scheduled), tuple(METHODS))


def _key(name: str) -> str:
    return name.replace("_rad", "_deg")


def _read_schedule(table: Table) -> Schedule:
    """Return the schedule: each of its fields is a key, in degrees where it is in radians."""
    values: dict[str, Any] = {}
    for field in fields(Schedule):
        key = _key(field.name)
        if key in table:
            value = table.raw(key) if key == "candidates" else table.number(key)
            values[field.name] = value if key == field.name else math.radians(value)
        table.raw(key, None)  # a known name, whether present or not
    try:
        return Schedule(**values)
    except InputError as error:
        key = _key(error.field)
        raise table.error(key, error.expected, error.found) from None


def search_table(search: Search) -> dict[str, Any]:
    """Return the table `[optimize]` of a search."""
    return {
        "method": search.method,
        "evaluations": search.evaluations,
        "seed": search.seed,
        "samples": search.samples,
        **{
            _key(field.name): in_file(field.name, getattr(search.schedule, field.name))
            for field in fields(Schedule)
        },
        **tolerance_keys(search.tolerance),
        **mounting_tables(search.mounting),
    }


def in_file(name: str, value: Any) -> Any:
    """Return a value as the file holds it: angles in degrees."""
    angle = name in AXES[3:] or name.endswith("_rad")
    return degrees_in_file(value) if angle else value

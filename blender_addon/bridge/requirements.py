"""Requirements of a scene: a row each, whose table is that of a study file, as JSON text.

The properties of a row that the panel shows are read from the table and written into it, so there
is one copy of each value.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

import bpy

from ..engine import pe, requirements, studies, text

UNKNOWN, NOT_MET, MET = -1, 0, 1
"""Verdicts as a row stores them."""
TableData = dict[str, Any]
Requirement = requirements.Requirement
Verdict = requirements.Verdict


def requirements_of(settings: bpy.types.PropertyGroup) -> tuple[Requirement, ...]:
    """Return the requirements of a scene that are switched on.

    Raises
    ------
    InputError
        When a row's table is wrong, or two rows have one name.
    """
    found = [requirement_of(row) for row in settings.requirements if row.enabled]
    return requirements.checked_requirements(found)


def requirement_of(row: bpy.types.PropertyGroup) -> Requirement:
    """Return the requirement of a row; `InputError` where its table is wrong."""
    return _read(row.name, table_of_row(row))


def table_of_row(row: bpy.types.PropertyGroup) -> TableData:
    """Return a row's table, without its name; `InputError` where the text is no table."""
    try:
        table = json.loads(row.table or "{}")
    except ValueError:
        table = None
    if not isinstance(table, dict):
        raise pe.InputError("scene", f"requirement {row.name!r}", "a table as JSON", "other text")
    return table


def full_table(row: bpy.types.PropertyGroup) -> TableData:
    """Return a row's table with the keys of its preset; empty where the table is wrong."""
    try:
        return studies.requirement_file.full_table(requirement_of(row))
    except pe.InputError:
        return {}


def write_row(row: bpy.types.PropertyGroup, requirement: Requirement) -> None:
    """Write a requirement to a row."""
    table = studies.requirement_file.requirement_table(requirement)
    row.name = table.pop("name")
    row.table = json.dumps(table)
    row.problem = ""
    forget_verdict(row)


def write_requirements(settings: bpy.types.PropertyGroup, wanted: Sequence[Requirement]) -> None:
    """Write requirements to a scene, in place of its own."""
    settings.requirements.clear()
    for each in wanted:
        write_row(settings.requirements.add(), each)
    settings.requirement_index = 0


def edit_row(row: bpy.types.PropertyGroup, change: Callable[[TableData], None]) -> None:
    """Change a row's table; a change that makes it wrong is not made, and the row says why."""
    try:
        table = table_of_row(row)
        change(table)
        requirement = _read(row.name, table)
    except pe.InputError as error:
        row.problem = f"{error.field}: expected {error.expected}, found {error.found}"
        return
    write_row(row, requirement)


def requirements_key(settings: bpy.types.PropertyGroup) -> tuple[tuple[str, str], ...]:
    """Return a key of the requirements that are switched on."""
    return tuple((row.name, row.table) for row in settings.requirements if row.enabled)


def store_verdicts(settings: bpy.types.PropertyGroup, verdicts: Sequence[Verdict]) -> None:
    """Store verdicts in the rows of their requirements; other rows have none."""
    found = {verdict.name: verdict for verdict in verdicts}
    for row in settings.requirements:
        verdict = found.get(row.name)
        if verdict is None:
            forget_verdict(row)
            continue
        row.met = MET if verdict.met else NOT_MET
        row.margin_text, row.verdict = verdict.margin_text, verdict.text
        row.has_worst = verdict.worst is not None
        row.worst = verdict.worst or (0.0, 0.0)


def forget_verdict(row: bpy.types.PropertyGroup) -> None:
    """Remove a row's verdict: it is not of the requirement as it is now."""
    row.met, row.verdict, row.margin_text, row.has_worst = UNKNOWN, "", "", False


def _read(name: str, table: TableData) -> Requirement:
    reader = text.Table({**table, "name": name}, "scene", f"requirement {name!r}")
    return studies.requirement_file.read_requirement(reader)

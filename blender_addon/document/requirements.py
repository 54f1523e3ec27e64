"""Requirements of a scene: a row each, whose table is that of a study file, as JSON text.

The properties of a row that the panel shows are read from the table and written into it, so there
is one copy of each value.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import asdict, replace
from functools import lru_cache

from bpy.types import PropertyGroup

from ..engine import pe, requirements, studies
from .study_table import TableData

REASON = "reason"  # Key of a stored text that is why there is no verdict
Requirement = requirements.Requirement
Verdict = requirements.Verdict
VerdictSummary = requirements.VerdictSummary


def requirements_of(settings: PropertyGroup) -> tuple[Requirement, ...]:
    """Return the requirements of a scene that are switched on. `InputError` when a row's table is
    wrong, or two rows have one name."""
    found = [
        _read(row.name, _loaded(row.name, row.table))
        for row in settings.requirements
        if row.enabled
    ]
    return requirements.checked_requirements(found)


def _loaded(name: str, text_of_row: str) -> TableData:
    try:
        table = json.loads(text_of_row or "{}")
    except ValueError:
        table = None
    if not isinstance(table, dict):
        raise pe.InputError("scene", f"requirement {name!r}", "a table as JSON", "other text")
    return table


def full_table(row: PropertyGroup) -> TableData:
    """Return a row's table with the keys of its preset; empty where the table is wrong. It is
    cached, and not to be changed."""
    try:
        return _full_table(row.name, row.table)[0]
    except pe.InputError:
        return {}


@lru_cache(maxsize=256)
def _full_table(name: str, table: str) -> tuple[TableData, str]:
    """Return the table of a row of that name, and what its verdict is called after. Panels ask for
    it again for each field."""
    requirement = _read(name, _loaded(name, table))
    return studies.write_fields(requirement), requirement.after


def after_of(row: PropertyGroup) -> str:
    """Return what a row's verdict is called after; empty where that is nothing, or is unknown."""
    return _full_table(row.name, row.table)[1] if full_table(row) else ""


def write_row(row: PropertyGroup, requirement: Requirement) -> None:
    """Write a requirement to a row."""
    row.name = requirement.name
    table = studies.write(requirement)
    table.pop("name", None)  # a preset may have its own
    row.table = json.dumps(table)
    row.problem = ""
    forget_verdict(row)


def write_requirements(settings: PropertyGroup, wanted: Sequence[Requirement]) -> None:
    """Write requirements to a scene, in place of its own."""
    settings.requirements.clear()
    for each in wanted:
        write_row(settings.requirements.add(), each)
    settings.requirement_index = 0


def edit_row(row: PropertyGroup, change: Callable[[TableData], None]) -> None:
    """Change a row's full table; a change that makes it wrong is not made, and the row says why."""
    try:
        table = deepcopy(_full_table(row.name, row.table)[0])
        change(table)
        preset = table.pop("preset", None)
        requirement = _read(row.name, table)
    except pe.InputError as error:
        row.problem = f"{error.field}: expected {error.expected}, found {error.found}"
        return
    write_row(row, _of_preset(requirement, preset))


def _of_preset(requirement: Requirement, preset: str | None) -> Requirement:
    """Return a requirement as one of its preset, if a study file can say it as a change of it."""
    if preset is None:
        return requirement
    changed = replace(requirement, preset=preset)
    try:
        again = _read(requirement.name, studies.write(changed))
    except pe.InputError:
        return requirement
    return again if again == changed else requirement


def requirements_key(settings: PropertyGroup) -> tuple[tuple[str, str], ...]:
    """Return a key of the requirements that are switched on."""
    return tuple((row.name, row.table) for row in settings.requirements if row.enabled)


def preset_of(row: PropertyGroup) -> str | None:
    """Return the identifier of a row's preset; None of an own or a wrong one."""
    return full_table(row).get("preset")


def store_verdicts(
    settings: PropertyGroup, verdicts: Sequence[Verdict], reasons: Mapping[str, str] | None = None
) -> None:
    """Store verdicts in the rows of their requirements; other rows have none, perhaps a reason."""
    found = {verdict.name: verdict.summary for verdict in verdicts}
    for row in settings.requirements:
        forget_verdict(row)
        if row.name in found:
            row.verdict = json.dumps(asdict(found[row.name]))
        elif reasons is not None and row.name in reasons:
            row.verdict = json.dumps({REASON: reasons[row.name]})


def forget_verdict(row: PropertyGroup) -> None:
    """Remove a row's verdict: it is not of the requirement as it is now."""
    row.verdict = ""


def stored_verdict(row: PropertyGroup) -> VerdictSummary | str | None:
    """Return a row's last verdict; the reason where it was not checked; None for neither."""
    stored = json.loads(row.verdict) if row.verdict else None
    if stored is None or REASON in stored:
        return None if stored is None else str(stored[REASON])
    worst = stored["worst"]
    return VerdictSummary(**stored | {"worst": None if worst is None else tuple(worst)})


def _read(name: str, table: TableData) -> Requirement:
    node = studies.Node({**table, "name": name}, "scene", f"requirement {name!r}")
    return studies.read(Requirement, node)

"""The study's table of a scene: the text that holds all settings of its file, as JSON.

A scene's table has the keys of a study file, except what Blender holds (sensors, vehicle, prior
and what is a list in the panel). Properties are views of it: `value_at` and `put` are what they
read and write. A value that is the file's default is left out.
"""

import json
from collections.abc import Mapping
from copy import deepcopy
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from bpy.types import PropertyGroup

from ..choices import EXPECTED_AP, OBJECTS
from ..engine import kinds, pe, search, studies

T = TypeVar("T")
TableData = dict[str, Any]
Keys = tuple[str, ...]
LARGEST_INT = 2**31 - 1  # A property holds no larger whole number
KEPT_AT_FIRST = ("blind_ground", "blind_sector")
"""Figures that a search in a new scene does not make worse."""
TOLERANCE: Keys = ("optimize", "tolerance")
REFERENCE: Keys = ("reference",)
SCORED_PARTS = ("space", "metric", "ap", "fusion")
"""Parts of a document that a score needs besides the prior."""
BEGINS = {
    path: {
        name: setting.panel.default
        for name, setting in studies.settings_of(cls).items()
        if setting.panel is not None and setting.panel.default is not None
    }
    for path, cls in ((REFERENCE, pe.Reference), (TOLERANCE, pe.Tolerance))
}
"""What a table begins with that a switch of the panel adds."""


def as_typed(value: float) -> float:
    """Return the shortest decimal number that a property of single precision stands for."""
    return float(str(np.float32(value)))


@lru_cache(maxsize=512)
def parsed(table: str) -> TableData | None:
    """Return the table of a text, not to be changed; None where the text is no table."""
    try:
        found = json.loads(table or "{}")
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


def value_at(table: str, path: Keys, default: Any = None) -> Any:
    """Return the value at a path of keys of a text's table; the default where there is none."""
    value: Any = parsed(table)
    for key in path:
        value = value.get(key) if isinstance(value, Mapping) else None
    return default if value is None else value


def put(group: PropertyGroup, path: Keys, value: Any) -> None:
    """Write a value into a group's table; None, or an empty table, removes the key."""
    table = deepcopy(parsed(group.table)) or {}
    begin = None if value is None else _begin_of(path)
    if begin is not None and value_at(group.table, path[:-1]) is None:
        _put(table, path[:-1], begin)
    _put(table, path, value)
    write_table(group, table)


def _put(table: TableData, path: Keys, value: Any) -> None:
    key, *below = path
    if below:
        inner = table[key] if isinstance(table.get(key), dict) else {}
        _put(inner, tuple(below), value)
        value = inner or None
    if value is None:
        table.pop(key, None)
    else:
        table[key] = value


def _begin_of(path: Keys) -> TableData | None:
    """Return with what the table of a key begins that has other keys that are required."""
    if path[:-1] == REFERENCE:
        return dict(BEGINS[REFERENCE])
    return curve_table(path[1]) if path[0] == "ap" and len(path) == 3 else None


def curve_table(kind: str) -> TableData | None:
    """Return the table of the AP curve of a kind of sensor; None where there is no such kind."""
    known = kinds.KINDS.get(kind)
    return None if known is None else studies.write(known.curve)


def write_table(group: PropertyGroup, table: Mapping[str, Any]) -> None:
    """Write a table to a group, if it differs from the group's own."""
    content = json.dumps(table)
    if content != group.table:
        group.table = content


def property_value(setting: studies.Setting, value: Any) -> Any:
    """Return a value of a file as its property shows it."""
    rule = setting.rule
    panel = setting.panel
    if isinstance(rule, studies.Several):
        return set(value)
    if isinstance(rule, studies.Texts):
        return ", ".join(value)
    if studies.is_switch(setting):
        return value is not None
    if value is None:
        return 0 if panel is None else panel.none if panel.absent is None else panel.absent[0]
    return min(value, LARGEST_INT) if isinstance(rule, studies.Whole) else value


def read_row(cls: type[T], row: PropertyGroup, where: str, **more: Any) -> T:
    """Return the instance that the table of a list's row stands for. `where` names the row in
    errors, `more` are keys that the table does not have. `InputError` where a value is wrong."""
    table = parsed(row.table)
    if table is None:
        raise pe.InputError("scene", where, "a table as JSON", "other text")
    return studies.read(cls, studies.Node({**table, **more}, "scene", where))


def store_row(row: PropertyGroup, instance: Any, **more: Any) -> None:
    """Write an instance to a list's row: its name, and its table without that."""
    table = {**studies.write(instance), **more}
    row.name = table.pop("name", row.name)
    write_table(row, table)


def in_file(setting: studies.Setting) -> Any:
    """Return the default of a setting as a file has it; None where a value is required."""
    default = setting.default
    return None if default is studies.REQUIRED else studies.value_in_file(setting.rule, default)


def value_of_property(setting: studies.Setting, value: Any) -> Any:
    """Return a property's value as a file has it; None for the value that stands for none."""
    rule: Any = setting.rule
    panel = setting.panel
    if isinstance(rule, studies.Pair):
        return list(map(as_typed, value))
    if isinstance(rule, studies.Several):
        return [each for each in rule.among if each in value]
    if isinstance(rule, studies.Texts):
        return [each.strip() for each in value.split(",") if each.strip()]
    if isinstance(rule, studies.Name):
        return value.strip()
    if studies.is_switch(setting):
        return rule.among[0] if value else None
    if panel is not None and panel.absent is not None and value == panel.absent[0]:
        return None
    if isinstance(rule, studies.Number):
        value = as_typed(value)
    is_none = value < rule.minimum if panel and panel.none else not value
    return None if setting.is_optional and is_none else value


def new_table() -> str:
    """Return the text of a new scene: what its panel shows and a study file has by default in
    another way."""
    table: TableData = {"limits": dict.fromkeys(KEPT_AT_FIRST, True)}
    for key, setting, *_ in studies.setting_keys(of_scene=True):
        path = tuple(key.split("."))
        own = None if setting.panel is None else setting.panel.default
        if own is not None and path[:-1] not in BEGINS:
            _put(table, path, own)
    return json.dumps(table)


def study_table(table: str, *, is_choice: bool = False) -> TableData:
    """Return the table of a scene's text as its study file has it, without what another setting
    switches off. `is_choice`: whether models are chosen, which uses a schedule. `InputError` where
    the text is none of a table."""
    found = deepcopy(parsed(table))
    if found is None:
        raise pe.InputError("scene", "study", "a table as JSON", "other text")
    optimize = found.setdefault("optimize", {})
    if not is_choice:
        found.pop("selection", None)
    method = optimize.setdefault("method", search.DEFAULT_METHOD)
    if not is_choice and method != search.SCHEDULED_METHOD:
        for key in studies.settings_of(pe.Schedule):
            optimize.pop(key, None)
    tolerance = optimize.get("tolerance", {})
    if not {"position", "angle", "failures"} & tolerance.keys():
        tolerance.pop("worst", None)
    targets = found.get("metric", {})
    if targets.get("targets") != OBJECTS:
        by_ap = optimize.get("objective") == EXPECTED_AP
        found["metric"] = {key: targets[key] for key in {"scenes"} & targets.keys() if by_ap}
    own = found.get("limits", {})
    alone = {
        key for key, limit in own.items() if limit == {"kept": True} or limit == {"kept": False}
    }
    found["limits"] = {key: own[key] for key in own if key not in alone}  # locks without a number
    return found


@lru_cache(maxsize=64)
def _document(table: str, parts: tuple[str, ...], is_choice: bool) -> studies.Document:
    found = study_table(table, is_choice=is_choice)
    some = {key: found[key] for key in parts or found if key in found}
    return studies.read(studies.Document, studies.Node(some, "scene"))


def document_of(settings: PropertyGroup, *parts: str, is_choice: bool = False) -> studies.Document:
    """Return the document of a scene's table; of some parts, for those who need no others.
    `InputError` where a value is wrong."""
    return _document(settings.table, parts, is_choice)


@lru_cache(maxsize=64)
def _signature(table: str) -> tuple[object, ...]:
    if parsed(table) is None:
        return (table,)
    found = json.dumps(study_table(table))
    keys = [each.key for each in studies.setting_keys(of_scene=True) if each.setting.scored]
    values = ((key, value_at(found, tuple(key.split(".")))) for key in keys)
    return (*(each for each in values if each[1] is not None), value_at(found, ("ap",)))


def signature_of(settings: PropertyGroup) -> tuple[object, ...]:
    """Return what a score depends on in a scene's table, including what is wrong."""
    return _signature(settings.table)  # it is asked for whenever a panel is drawn


def has_mounting_errors(settings: PropertyGroup) -> bool:
    """Whether a search evaluates candidates with mounting errors."""
    return bool(BEGINS[TOLERANCE].keys() & value_at(settings.table, TOLERANCE, {}).keys())


def switch_mounting_errors(settings: PropertyGroup, on: bool) -> None:
    """Begin with usual mounting errors, or remove them."""
    if on != has_mounting_errors(settings):
        for key, usual in BEGINS[TOLERANCE].items():
            put(settings, (*TOLERANCE, key), usual if on else None)


def has_axles(settings: PropertyGroup) -> bool:
    """Whether the positions of the axles are known."""
    return bool(value_at(settings.table, REFERENCE))


def switch_axles(settings: PropertyGroup, on: bool) -> None:
    """Begin with usual positions of the axles, or remove them."""
    if on != has_axles(settings):
        put(settings, REFERENCE, dict(BEGINS[REFERENCE]) if on else None)


def has_own_curve(row: PropertyGroup) -> bool:
    """Whether the kind of a row has a curve of its own in the scene's table."""
    return bool(value_at(row.id_data.perception_entropy.table, ("ap", row.name)))


def switch_own_curve(row: PropertyGroup, on: bool) -> None:
    """Begin with the curve of the row's kind, or remove an own one."""
    if on != has_own_curve(row):
        settings = row.id_data.perception_entropy
        put(settings, ("ap", row.name), curve_table(row.name) if on else None)

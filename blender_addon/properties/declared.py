"""Blender properties of settings that the engine declares: name, tooltip, range, unit and menu."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple, cast

from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)
from bpy.types import PropertyGroup

from .. import document
from ..engine import studies
from .callbacks import changed, redraw
from .fields import view

PathOf = Callable[[PropertyGroup], tuple[PropertyGroup, document.Keys]]

DRAWN = "reference."
"""Settings whose keys begin so change the picture in the 3D view, and no score."""
UNITS = {"m": "LENGTH", "m2": "AREA"}


def property_of(setting: studies.Setting, **more: Any) -> Any:
    """Return the property that a setting is stored in; `more` goes before what is declared."""
    panel = setting.panel
    rule = cast(Any, setting.rule)
    assert panel is not None  # asked for those alone that have one
    options: dict[str, Any] = {
        "name": panel.label,
        "description": setting.tooltip,
        "default": studies.panel_default(setting),
        "soft_max": panel.soft_max,
        "precision": panel.precision,
        "step": panel.step,
        "update": changed if setting.scored else None,
    }
    kind, own = _kind_of(setting, rule, panel)
    options |= own | more
    return kind(**{key: value for key, value in options.items() if value is not None})


def view_of(
    setting: studies.Setting, path_of: PathOf, *, is_explicit: bool = False, **more: Any
) -> Any:
    """Return the property of a setting that is a view of a table: it stores nothing.

    `path_of`: From a group of properties to the group with the table, and the value's keys in it.
    `is_explicit`: Whether the table has the value, too, where it is the default of a study file.
    """
    in_file = document.in_file(setting)
    _, own = _kind_of(setting, setting.rule, cast(studies.Panel, setting.panel))

    def read(group: PropertyGroup) -> Any:
        owner, path = path_of(group)
        return document.property_value(setting, document.value_at(owner.table, path, in_file))

    def write(group: PropertyGroup, value: Any) -> None:
        owner, path = path_of(group)
        found = document.value_of_property(setting, value)
        document.put(owner, path, None if found == in_file and not is_explicit else found)

    callbacks = view(
        read,
        write,
        own.get("items", ()),
        several=isinstance(setting.rule, studies.Several),
        low=own.get("min"),
        high=own.get("max"),
    )
    return property_of(setting, **more | callbacks)


def _kind_of(
    setting: studies.Setting, rule: Any, panel: studies.Panel
) -> tuple[Any, dict[str, Any]]:
    """Return the kind of property, and what its rule says of it."""
    if isinstance(rule, studies.Toggle) or studies.is_switch(setting):
        return BoolProperty, {"default": bool(studies.panel_default(setting))}
    if isinstance(rule, studies.OneOf):
        default = {"default": panel.absent[0]} if panel.absent else {}
        return EnumProperty, {"items": studies.menu_of(setting), **default}
    if isinstance(rule, studies.Several):
        items = [
            (text, label, about, "NONE", 1 << number)
            for number, (text, label, about) in enumerate(studies.menu_of(setting))
        ]
        return EnumProperty, {"items": items, "options": {"ENUM_FLAG"}, "default": None}
    if isinstance(rule, studies.Name):
        return StringProperty, {"maxlen": rule.max_length}
    if isinstance(rule, studies.Texts):
        about = f"{setting.text}: names separated by commas"
        return StringProperty, {"default": "", "description": about}
    if isinstance(rule, studies.Pair):
        return FloatVectorProperty, {"size": 2, "unit": UNITS.get(rule.rule.unit)}
    low = panel.none if setting.is_optional else rule.minimum
    high = rule.maximum if panel.max is None else panel.max
    low = low if panel.min is None else panel.min
    if isinstance(rule, studies.Whole):
        high = document.LARGEST_INT if high is None else min(high, document.LARGEST_INT)
        return IntProperty, {"min": low, "max": high}
    low, high = (end if math.isfinite(end) else None for end in (low, high))
    return FloatProperty, {"min": low, "max": high, "unit": UNITS.get(rule.unit)}


def group_of(
    cls: Any, *, prefix: str = "", own: dict[str, dict[str, Any]] | None = None, **more: Any
) -> Any:
    """Return a mixin of a property group: all settings of a dataclass that the panel shows.

    `prefix`: Before the properties' names.
    `own`: As of `property_of`, for single settings by their names.
    `**more`: As of `property_of`, for each of them.
    """
    return mixin(
        cls.__name__,
        {
            f"{prefix}{each.panel.property or each.name}": property_of(
                each, **more | (own or {}).get(each.name, {})
            )
            for each in studies.settings_of(cls).values()
            if each.panel is not None
        },
    )


def own_path(*path: str) -> PathOf:
    """Return what finds a value in a group's own table."""
    return lambda group: (group, path)


def table_group(
    cls: Any,
    *,
    prefix: str = "",
    path_of: Any = own_path,
    own: dict[str, dict[str, Any]] | None = None,
    **more: Any,
) -> Any:
    """Return a mixin of a property group: views of a table, of all settings of a dataclass that the
    panel shows. `prefix` is before the properties' names, `path_of` makes that of `view_of` from a
    setting's key, `own` and `more` as of `group_of`."""
    return mixin(
        cls.__name__,
        {
            f"{prefix}{each.panel.property or each.name}": view_of(
                each, path_of(studies.key_of(each.name)), **more | (own or {}).get(each.name, {})
            )
            for each in studies.settings_of(cls).values()
            if each.panel is not None
        },
    )


def scene_group() -> Any:
    """Return a mixin of the scene's settings: all that the engine declares for the whole study."""
    return mixin(
        "Study",
        {
            each.panel.property: view_of(
                each,
                own_path(*key.split(".")),
                update=redraw if key.startswith(DRAWN) else changed if each.scored else None,
            )
            for key, each, *_ in studies.setting_keys(of_scene=True)
            if each.panel is not None
        },
    )


def mixin(name: str, properties: dict[str, Any]) -> Any:
    """Return a class with properties, which a registered property group may inherit."""
    content = {"__doc__": f"Declared settings: {name}.", "__module__": __name__}
    return type(f"{name}Settings", (), {**content, "__annotations__": properties})


class DeclaredRow(NamedTuple):
    """A field of the panel: its property, the form it has, and when it is drawn. `beside` is the
    word beside the field while it is 0, `when` as of `studies.Panel`."""

    name: str
    is_pair: bool = False
    is_list: bool = False
    beside: str = ""
    when: str = ""


def rows_of(cls: Any) -> dict[str, DeclaredRow]:
    """Return the fields of a dataclass's settings, by property."""
    rows = (_row_of(each) for each in studies.settings_of(cls).values() if each.panel is not None)
    return {row.name: row for row in rows}


def declared_rows(part: str) -> tuple[DeclaredRow, ...]:
    """Return the fields that the engine declares for a part of the panel, in their order."""
    return tuple(_row_of(setting) for setting in studies.settings_of_part(part))


def _row_of(setting: studies.Setting) -> DeclaredRow:
    panel = setting.panel
    rule = setting.rule
    assert panel is not None
    is_pair = isinstance(rule, studies.Pair)
    is_list = isinstance(rule, studies.Several)
    name = panel.property or setting.name
    return DeclaredRow(name, is_pair, is_list, panel.beside, when=panel.when)


ROWS = {
    row.name: row for _, each, *_ in studies.setting_keys() if each.panel for row in [_row_of(each)]
}
"""By property; those of several groups that have one name have one form."""

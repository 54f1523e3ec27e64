"""A requirement as the panel edits it: views of its table, which is stored as JSON text."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from .. import bridge, signals
from ..engine import requirements
from .callbacks import changed

OTHER_BODIES = "other"
BODIES = (
    *(
        (name, name.replace("_", " ").capitalize(), body.source, number)
        for number, (name, body) in enumerate(requirements.BODIES.items())
    ),
    (OTHER_BODIES, "Several or Own", "As the study file says", len(requirements.BODIES)),
)
"""Test bodies of the menu."""
Getter = Callable[[bpy.types.PropertyGroup], Any]
Setter = Callable[[bpy.types.PropertyGroup, Any], None]


def _edit(row: bpy.types.PropertyGroup, *keys: str, value: Any) -> None:
    """Write a value into a row's table, at keys one below the other."""

    def change(table: dict[str, Any]) -> None:
        for key in keys[:-1]:
            table = table.setdefault(key, {})
        table[keys[-1]] = value

    bridge.edit_row(row, change)
    signals.study_changed.emit()


def _number(section: str, key: str, default: float, *, whole: bool = False) -> dict[str, Any]:
    """Return the callbacks of a number in a section of the table."""

    def get(row: bpy.types.PropertyGroup) -> float:
        value = bridge.full_table(row).get(section, {}).get(key)
        return default if value is None else value

    def put(row: bpy.types.PropertyGroup, value: float) -> None:
        _edit(row, section, key, value=int(value) if whole else round(value, 6))

    return {"get": get, "set": put}


def _switch(section: str, key: str) -> dict[str, Any]:
    """Return the callbacks of a switch in a section of the table."""

    def get(row: bpy.types.PropertyGroup) -> bool:
        return bool(bridge.full_table(row).get(section, {}).get(key))

    def put(row: bpy.types.PropertyGroup, value: bool) -> None:
        _edit(row, section, key, value=bool(value))

    return {"get": get, "set": put}


def _edge(axis: str, end: int) -> dict[str, Any]:
    """Return the callbacks of an end of a rectangular zone: "front + 0.8", or a number."""

    def get(row: bpy.types.PropertyGroup) -> str:
        ends = bridge.full_table(row).get("zone", {}).get(axis)
        return "" if ends is None else str(ends[end])

    def put(row: bpy.types.PropertyGroup, value: str) -> None:
        ends = list(bridge.full_table(row).get("zone", {}).get(axis) or ("0", "0"))
        ends[end] = _place(value)
        _edit(row, "zone", axis, value=ends)

    return {"get": get, "set": put}


def _place(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def _body(row: bpy.types.PropertyGroup) -> int:
    value = bridge.full_table(row).get("body")
    names = [item[0] for item in BODIES]
    alone = value[0] if isinstance(value, list) and len(value) == 1 else value
    return names.index(alone if isinstance(alone, str) and alone in names else OTHER_BODIES)


def _set_body(row: bpy.types.PropertyGroup, number: int) -> None:
    name = BODIES[number][0]
    if name != OTHER_BODIES:
        _edit(row, "body", value=name)


class PE_Requirement(bpy.types.PropertyGroup):
    """A requirement, and its last verdict."""

    enabled: BoolProperty(
        name="Checked", description="Hold the rig to this requirement", default=True, update=changed
    )
    table: StringProperty(name="Table", description="The requirement as JSON", update=changed)
    problem: StringProperty(name="Problem", description="Why a change was not made")
    body: EnumProperty(
        items=BODIES,
        name="Body",
        description="What stands at each sample of the zone",
        get=_body,
        set=_set_body,
    )
    x_from: StringProperty(
        name="X From",
        description="A number [m], or a plane with an offset outwards: front + 0.8, rear_axle",
        **_edge("x", 0),
    )
    x_to: StringProperty(name="To", description="As X From", **_edge("x", 1))
    y_from: StringProperty(
        name="Y From",
        description="A number [m], or a plane with an offset outwards: left + 1, near, right",
        **_edge("y", 0),
    )
    y_to: StringProperty(name="To", description="As Y From", **_edge("y", 1))
    step: FloatProperty(
        name="Step",
        description="Largest distance of two samples",
        min=0.02,
        soft_max=2.0,
        unit="LENGTH",
        **_number("zone", "step", requirements.Zone.__dataclass_fields__["step"].default),
    )
    sensors: IntProperty(
        name="Sensors",
        description="How many sensors have to see each body",
        min=1,
        soft_max=6,
        **_number("criterion", "sensors", 1, whole=True),
    )
    kinds: IntProperty(
        name="Kinds",
        description="Of how many kinds these sensors have to be",
        min=1,
        soft_max=3,
        **_number("criterion", "kinds", 1, whole=True),
    )
    one_lost: BoolProperty(
        name="One Sensor Lost",
        description="It has to be met without any one of the sensors, too",
        **_switch("under", "one_lost"),
    )
    mounting: BoolProperty(
        name="Mounting Errors",
        description="It has to be met with the mounting errors of the search, too",
        **_switch("under", "mounting"),
    )
    met: IntProperty(name="Met", description="-1 unknown, 0 not met, 1 met", default=-1)
    verdict: StringProperty(name="Verdict", description="The last verdict, in words")
    margin_text: StringProperty(name="Margin", description="How far the zone could grow or shrink")
    has_worst: BoolProperty(name="Has Worst", description="Whether a worst place is known")
    worst: FloatVectorProperty(
        name="Worst Place", description="Where the fewest sensors see", size=2, unit="LENGTH"
    )

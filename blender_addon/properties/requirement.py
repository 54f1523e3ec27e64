"""A requirement as the panel edits it: views of its table, which is stored as JSON text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from bpy.props import FloatProperty, StringProperty
from bpy.types import Context, PropertyGroup

from .. import bridge, signals
from ..engine import kinds, requirements, studies
from . import requirement_fields as fields
from .callbacks import changed
from .declared import mixin, property_of
from .fields import menu, number, numbers, switch, text

BODIES = (
    *(
        (name, name.replace("_", " ").capitalize(), b.source)
        for name, b in requirements.BODIES.items()
    ),
    (fields.SEVERAL, "Several", "Each of them has to be seen, one at a time"),
    (fields.OWN, "Own Body", "A box or a cylinder of a size of your own, or a mesh of a file"),
)
"""Test bodies of the menu."""
SHAPES = (
    ("area", "Rectangle", "From and to along x and y"),
    ("polygon", "Polygon", "An area with three corners or more"),
    ("ring", "Ring", "All ground at a distance from the outline of the vehicle's body"),
    ("path", "Path", "A line along which a body moves"),
    ("spots", "Spots", "Single places"),
)
ASKS = (
    ("bodies", "Test Bodies", "A body stands at each sample of the zone, and has to be seen"),
    ("ground", "Blind Ground", "Blind ground in the zone is limited"),
)
AXES = (
    (fields.AS_IN_FILE, "As in the File", "As the file states it, or as is usual for its format"),
    *((axis, axis.upper(), f"The file's {axis.upper()}") for axis in fields.AXIS_NAMES),
)
SECTIONS = {
    "zone": requirements.Zone,
    "criterion": requirements.Criterion,
    "under": requirements.Under,
}
ZERO_COUNTS = ("blind_m2",)
"""Settings that are asked for at 0, too."""
PLACE = "a number [m], or a plane with an offset outwards: front + 0.8, near, rear_axle, 25 %"
HIGH: dict[str, Any] = {"min": 0.0, "unit": "LENGTH"}
EditedRow = PropertyGroup
Getter = Callable[[EditedRow], Any]
Change = Callable[[dict[str, Any], Any], None]


def _view(get: Callable[[dict[str, Any]], Any], put: Change) -> dict[str, Any]:
    """Return the callbacks of a property: read from a row's full table, and changed in it."""

    def getter(row: EditedRow) -> Any:
        return get(bridge.full_table(row))

    def setter(row: EditedRow, value: Any) -> None:
        bridge.edit_row(row, lambda table: put(table, value))
        signals.study_changed.emit()

    return {"get": getter, "set": setter}


def _choice(
    items: tuple[tuple[str, str, str], ...], get: Callable[..., str], put: Change
) -> dict[str, Any]:
    """Return items and callbacks of a menu: Blender hands over the numbers of its entries."""
    names = [item[0] for item in items]
    view = _view(lambda t: names.index(get(t)), lambda t, number: put(t, names[number]))
    return {"items": items, **view}


def _declared() -> Any:
    """Return a mixin with views of all that is declared for a zone, a criterion and conditions."""
    return mixin(
        "Requirement",
        {
            setting.panel.property: property_of(setting, **_declared_view(section, setting))
            for section, cls in SECTIONS.items()
            for setting in studies.settings_of(cls).values()
            if setting.panel is not None
        },
    )


def _declared_view(section: str, setting: studies.Setting) -> dict[str, Any]:
    """Return the callbacks of a declared setting; its default removes the key."""
    name, default = setting.name, setting.default

    def get(table: dict[str, Any]) -> Any:
        value = table.get(section, {}).get(name, default)
        return bridge.property_value(setting, value)

    def put(table: dict[str, Any], value: Any) -> None:
        found = bridge.value_of_property(setting, value)
        own = table.setdefault(section, {})
        own.pop(name, None)
        if name in ZERO_COUNTS or found != default:
            own[name] = value if found is None else studies.value_in_file(setting, found)

    is_menu = isinstance(setting.rule, studies.OneOf)
    return _choice(studies.menu_of(setting), get, put) if is_menu else _view(get, put)


def _ends(name: str, labels: tuple[str, str], usual: tuple[Any, Any], **options: Any) -> Any:
    """Return a mixin with views of both ends of a range of the zone."""
    kind = StringProperty if isinstance(usual[0], str) else FloatProperty
    texts = zip(("from", "to"), (f"{labels[0]} From", "To"), ("From: ", "To: "), strict=True)
    return mixin(
        name,
        {
            f"{name}_{end}": kind(
                name=label, description=before + labels[1], **options, **_end(name, number, usual)
            )
            for number, (end, label, before) in enumerate(texts)
        },
    )


def _end(key: str, end: int, usual: tuple[Any, Any]) -> dict[str, Any]:
    """Return the callbacks of one of the two ends of a range of the zone."""

    def put(table: dict[str, Any], value: Any) -> None:
        ends = list(table.setdefault("zone", {}).get(key) or usual)
        ends[end] = fields.place_of(value) if isinstance(value, str) else round(value, 6)
        table["zone"][key] = ends

    def get(table: dict[str, Any]) -> Any:
        ends = table.get("zone", {}).get(key)
        missing = "" if isinstance(usual[end], str) else usual[end]
        return (
            missing if ends is None else str(ends[end]) if isinstance(missing, str) else ends[end]
        )

    return _view(get, put)


def _shown_file(table: dict[str, Any]) -> str:
    """Return the mesh file as Blender writes paths: //child.glb is beside the Blender file."""
    file = fields.mesh_file(table)
    return file if not file or Path(file).is_absolute() else f"//{file}"


def _set_file(table: dict[str, Any], path: str) -> None:
    """Set the mesh file by a path of Blender: a study names relative files without //."""
    fields.set_mesh_file(table, path.strip().replace("\\", "/").removeprefix("//"))


def _kind_items(_self: EditedRow, _context: Context | None) -> list[tuple[str, str, str, str, int]]:
    return _kinds


_kinds = [
    (name, kind.label, f"Sensors of the kind {kind.label} count", "NONE", 1 << number)
    for number, (name, kind) in enumerate(kinds.KINDS.items())
]


def _kind_flags(table: dict[str, Any]) -> int:
    chosen = table.get("criterion", {}).get("of", ())
    return sum(item[4] for item in _kinds if item[0] in chosen)


def _set_kind_flags(table: dict[str, Any], flags: int) -> None:
    chosen = [item[0] for item in _kinds if item[4] & flags]
    table.setdefault("criterion", {})["of"] = chosen
    if not chosen:
        del table["criterion"]["of"]


RING = "distance from the outline of the vehicle's body"
HEIGHT = "height of the foot of the body; sampled at the step"
Declared: Any = _declared()
X: Any = _ends("x", ("X", PLACE), ("0", "1"))
Y: Any = _ends("y", ("Y", PLACE), ("0", "1"))
Ring: Any = _ends("ring", ("Ring", RING), (0.0, 1.0), **HIGH)
Height: Any = _ends("z", ("Height", HEIGHT), (0.0, 0.0), **HIGH)


class PE_Requirement(Declared, X, Y, Ring, Height, PropertyGroup):
    """A requirement, and its last verdict."""

    enabled: switch("Checked", "Hold the rig to this requirement", True, update=changed)
    table: text("Table", "The requirement as JSON", update=changed)
    problem: text("Problem", "Why a change was not made")
    asks: menu(
        "Asks For",
        "What is asked for in the zone",
        **_choice(ASKS, fields.asked_for, fields.ask_for),
    )
    body: menu(
        "Body",
        "What stands at each sample of the zone",
        **_choice(BODIES, fields.body_choice, fields.choose_body),
    )
    bodies: text(
        "Bodies",
        "Names of test bodies: child, adult, cyclist",
        **_view(fields.bodies_text, fields.set_bodies),
    )
    body_size: numbers(
        "Size",
        "Length along the heading, width and height",
        3,
        min=0.001,
        unit="LENGTH",
        **_view(fields.own_size, fields.set_own_size),
    )
    body_round: switch(
        "Round",
        "An upright cylinder as wide as the body is long",
        **_view(fields.own_is_round, fields.set_own_round),
    )
    body_low: number(
        "Lower Edge",
        "Height of the lower edge above the ground",
        min=0.0,
        unit="LENGTH",
        **_view(*fields.own_number("low", 0.0)),
    )
    body_mesh: text(
        "Mesh File",
        "A closed mesh (.glb, .stl, .obj, .ply, .npz) in place of a box; empty: none",
        **_view(_shown_file, _set_file),
    )
    body_up: menu(
        "Up",
        "The file's axis that points up",
        **_choice(AXES, *fields.own_text("up", fields.AS_IN_FILE)),
    )
    body_forward: menu(
        "Forward",
        "The file's axis that points along the heading of the body",
        **_choice(AXES, *fields.own_text("forward", fields.AS_IN_FILE)),
    )
    body_scale: number(
        "Scale",
        "Factor for lengths, applied after the file's own unit",
        min=1e-6,
        max=1e6,
        precision=4,
        **_view(*fields.own_number("scale", 1.0)),
    )
    body_class: text(
        "Class",
        "Class of objects whose AP curve holds for the body; empty: none",
        **_view(*fields.own_text("class", "")),
    )
    body_name: text(
        "Body Name",
        "What the body is called in a verdict",
        **_view(*fields.own_text("name", fields.OWN)),
    )
    headings: text(
        "Headings",
        "Headings at which bodies stand, in degrees: 0, 90; empty: those of the body",
        **_view(fields.headings_text, fields.set_headings),
    )
    shape: menu("Zone", "Shape of the zone", **_choice(SHAPES, fields.shape_of, fields.reshape))
    corners: text(
        "Corners",
        "x, y of each corner or spot, separated by semicolons: front + 1, left; "
        "front + 5, left + 1",
        **_view(fields.corners_text, fields.set_corners),
    )
    eyes: text(
        "Driver's Eyes X",
        "x of the driver's eyes [m], for the plane eyes; empty: not known",
        **_view(fields.eyes_text, fields.set_eyes),
    )
    of: menu(
        "Only",
        "Only these kinds of sensors count; none chosen: all",
        _kind_items,
        options={"ENUM_FLAG"},
        **_view(_kind_flags, _set_kind_flags),
    )
    verdict: text("Verdict", "The last verdict as JSON, or why there is none")

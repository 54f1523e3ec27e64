"""What is stored on the scene: the study's settings, and a small summary of the last result."""

import zlib
from functools import partial
from typing import Any

import bpy
from bpy.types import Collection, PropertyGroup

from .. import document
from ..choices import PANELS, PRIORS
from ..engine import search, studies
from .callbacks import changed, kinds_to_add, redraw, select_object_by_index, selected_object_index
from .declared import mixin, scene_group
from .fields import menu, number, pointer, rows, switch, text, view, whole
from .list_rows import (
    PE_CurveSettings,
    PE_FocusSettings,
    PE_MountSettings,
    PE_OwnSensorSettings,
    PE_Scenario,
    PE_State,
    PE_Variant,
    PE_Weather,
)
from .requirement import PE_Requirement
from .view import PE_LiveSettings, PE_ViewSettings

METHODS = tuple(
    (name, method.label, method.about, 1 + zlib.crc32(name.encode()) % 2**30)
    for name, method in search.METHODS.items()
)
"""Of searches, with a number that stays a method's whatever others there are."""
METHOD = ("optimize", "method")

# Before 4.5 every path could be relative to the .blend file; since then a property has to say so.
PATH_OPTIONS = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()


StudyFields: Any = scene_group()
LISTS = (
    ("focus", "focus_index", "Regions and classes with another weight", PE_FocusSettings),
    ("own_sensors", "own_index", "Sensor models that only this file has", PE_OwnSensorSettings),
    ("mounts", "mount_index", "Surfaces or slots for sensors", PE_MountSettings),
    ("requirements", "requirement_index", "Zones where bodies have to be seen", PE_Requirement),
    ("states", "state_index", "States of the vehicle: frames of the scene", PE_State),
    ("weathers", "weather_index", "Weathers in which the rig is scored, too", PE_Weather),
    ("scenarios", "scenario_index", "What moves, and when it is confirmed", PE_Scenario),
    ("variants", "variant_index", "Saved sets of sensors for this vehicle", PE_Variant),
)
"""Lists of rows: the properties of the rows and of the selected row's place, what they are, and a
row's group."""
INDEX_OF = {name: index for name, index, *_ in LISTS}
"""The property of the selected row's place, by that of the rows."""
UNITS = {"m": "LENGTH", "m2": "AREA"}
KEEPS = "Optimize will not make it worse than its limit, or than now if there is no limit"
HOLDS = "Optimize keeps to the limit; a limit on what it improves ends it"
LARGEST_LIMIT = 1e6


def _lists() -> Any:
    """Return a mixin with the lists."""
    properties = {}
    for name, index, about, group in LISTS:
        label = name.replace("_", " ").title()
        properties[name] = rows(label, about, group)
        drawn = redraw if name == "requirements" else None  # the view shows the selected one
        properties[index] = whole(f"{label}: Selected", "Row of the list", min=0, update=drawn)
    return mixin("Lists", properties)


ListFields: Any = _lists()


def _limits() -> Any:
    """Return a mixin with the limits: a lock and, of all but requirements, a number a figure."""
    properties = {}
    for key in search.LIMITED:
        row = search.FIGURES[key]
        is_seen = key in search.KEPT or key == search.REQUIREMENTS
        properties[document.keep_property(key)] = switch(
            f"Keep {row.label}",
            f"{KEEPS if is_seen else HOLDS}. {row.about}",
            **view(partial(_is_kept, key), partial(_keep, key)),
        )
        if row.rule is not None:
            properties[document.limit_property(key)] = _limit_number(key, row)
    return mixin("Limit", properties)


def _is_kept(key: str, settings: PropertyGroup) -> bool:
    return document.limit_of(settings, key)[1]


def _keep(key: str, settings: PropertyGroup, locked: bool) -> None:
    number, _ = document.limit_of(settings, key)
    document.put_limit(settings, key, number, locked)


def _number(key: str, settings: PropertyGroup) -> float:
    number, _ = document.limit_of(settings, key)
    return document.NONE if number is None else number


def _set_number(key: str, settings: PropertyGroup, number: float) -> None:
    _, locked = document.limit_of(settings, key)
    number = document.as_typed(number) if isinstance(number, float) else number
    document.put_limit(settings, key, None if number <= document.NONE else number, locked)


def _limit_number(key: str, row: search.Figure) -> Any:
    about = f"{row.about}: at {'least' if row.higher else 'most'}; {document.NONE}: no limit"
    rule: Any = row.rule
    least = document.NONE
    assert rule is not None, "a figure with a limit's number has its rule"
    is_whole = isinstance(rule, studies.Whole)
    high = rule.maximum if is_whole else min(rule.maximum, LARGEST_LIMIT)
    callbacks = view(partial(_number, key), partial(_set_number, key), low=least, high=high)
    own = {"min": least, "max": high, **callbacks}
    if is_whole:
        return whole(row.label, about, least, **own)
    unit = UNITS.get(row.unit, "NONE")
    return number(row.label, about, least, precision=row.decimals, unit=unit, **own)


LimitFields: Any = _limits()


class PE_SceneSettings(StudyFields, ListFields, LimitFields, document.ResultViews, PropertyGroup):
    """The study's settings, views of its table, and the last result."""

    table: text("Study", "The settings as a study file has them, as JSON", document.new_table())
    kind_to_add: menu("Kind", "Kind of sensor that Add and Place put on the vehicle", kinds_to_add)
    vehicle: pointer(
        "Vehicle",
        "Collection of the vehicle's meshes: x forward, y left, z up, in metres, "
        "with the origin on the ground",
        Collection,
        update=changed,
    )
    prior: menu("Prior", "Where objects are expected", PRIORS, update=changed)
    boxes: text(
        "Boxes",
        "File of labelled boxes: KITTI's labels, nuScenes' JSON or CSV",
        subtype="FILE_PATH",
        options=PATH_OPTIONS,
        update=changed,
    )
    curves: rows("AP Curves", "AP by measurement, for each kind of sensor", PE_CurveSettings)
    selected_sensor: whole(
        "Selected Sensor",
        "Place of the selected sensor among the scene's objects",
        get=selected_object_index,
        set=select_object_by_index,
    )
    drawn_frame: whole(
        "Drawn at Frame",
        "Frame at which the vehicle is as it is drawn: scores and files are of it",
        1,
        min=0,
    )
    method: menu(
        "Method",
        "Method of the search",
        METHODS,
        default=search.DEFAULT_METHOD,
        **view(
            lambda own: document.value_at(own.table, METHOD, search.DEFAULT_METHOD),
            lambda own, name: document.put(own, METHOD, name),
            METHODS,
        ),
    )
    start_variants: switch(
        "From Variants", "Searches also start from all other variants; all starts share the budget"
    )
    mounting_errors: switch(
        "Mounting Errors",
        "Evaluate each candidate by its mean over small mounting errors, so the result "
        "is not sensitive to them. A candidate takes about eight times as long",
        **view(document.has_mounting_errors, document.switch_mounting_errors),
    )

    axles_known: switch(
        "Axles",
        "Set the positions of the axles: the rear axle is the origin of Autoware, "
        "nuScenes, ASAM OSI and DriveWorks",
        update=redraw,
        **view(document.has_axles, document.switch_axles),
    )

    panels: menu("Panels", "Which panels the tab has, and in which words", PANELS)
    live: pointer("Live", "The score that is updated while a sensor moves", PE_LiveSettings)

    show_overlay: switch(
        "Show Perception", "Show in the 3D view what the sensors see and miss", True, update=redraw
    )
    view: pointer("View", "Overlay of the 3D view", PE_ViewSettings)
    before_look: text(
        "Before Looking", "Camera and size of pictures before a sensor was looked through, as JSON"
    )

    warnings_json: text("Checks", "Warnings, as JSON")
    known_rigs_json: text("Known Rigs", "Their entropies on this vehicle, as JSON")
    front_json: text("Front", "The last Pareto front, as JSON")
    result_json: text("Result", "The last result in full, as result.json holds it")
    result_signature: text(
        "Signature", "Identifies the scored scene, to find out whether the result is still valid"
    )
    result_stale: switch("Stale", "The scene has changed since the result was made")

    variant_key: whole("Active Variant", "Key of the scene's active variant; 0: none")
    variant_changed: switch("Changed", "The scene differs from its active variant")

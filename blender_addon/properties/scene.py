"""What is stored on the scene: the study's settings, and a small summary of the last result."""

from __future__ import annotations

import zlib
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .. import bridge
from ..choices import PRIORS
from ..engine import search
from .callbacks import (
    changed,
    kinds_to_add,
    redraw,
    requirement_chosen,
    select_object_by_index,
    selected_object_index,
)
from .condition import PE_State, PE_Weather
from .declared import scene_group
from .list_rows import PE_CurveSettings, PE_FocusSettings, PE_MountSettings, PE_OwnSensorSettings
from .requirement import PE_Requirement
from .results import PE_Variant
from .view import PE_LiveSettings, PE_ViewSettings

METHODS = tuple(
    (name, method.label, method.about, 1 + zlib.crc32(name.encode()) % 2**30)
    for name, method in {**search.METHODS, **search.PARTS}.items()
)
"""Of searches; a file holds a number that stays a method's whatever others there are. Parts of the
portfolio come from studies that name them; the panel offers none."""

DEFAULT_BEAM_LIMIT = 5_000

DEFAULT_BEAM_LENGTH_M = 8.0

# Before 4.5 every path could be relative to the .blend file; since then a property has to say so.
PATH_OPTIONS = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()


StudyFields: Any = scene_group()
ResultFields: Any = bridge.stored_fields(bridge.StoredResult, "result_shown")
CheckFields: Any = bridge.stored_fields(bridge.StoredChecks, "checks_shown")
FrontFields: Any = bridge.stored_fields(bridge.StoredFront, "front_shown")


class PE_SceneSettings(
    StudyFields, ResultFields, CheckFields, FrontFields, bpy.types.PropertyGroup
):
    """The study's settings, and the last result."""

    version: IntProperty(
        name="Version",
        description="Version of the stored settings; 0: older than versions, or not saved yet",
        min=0,
    )
    kind_to_add: EnumProperty(
        items=kinds_to_add,
        name="Kind",
        description="Kind of sensor that Add and Place put on the vehicle",
    )
    vehicle: PointerProperty(
        type=bpy.types.Collection,
        name="Vehicle",
        description="Collection of the vehicle's meshes: x forward, y left, z up, in metres, "
        "with the origin on the ground",
        update=changed,
    )
    prior: EnumProperty(
        items=PRIORS,
        name="Prior",
        description="Where objects are expected",
        update=changed,
    )
    boxes: StringProperty(
        name="Boxes",
        description="File of labelled boxes: KITTI's labels, nuScenes' JSON or CSV",
        subtype="FILE_PATH",
        options=PATH_OPTIONS,
        update=changed,
    )
    focus: CollectionProperty(
        type=PE_FocusSettings,
        name="Focus",
        description="Regions and classes with a higher or lower weight than in the prior",
    )
    focus_index: IntProperty(
        name="Selected Focus", description="Row of the list whose settings are shown", min=0
    )
    curves: CollectionProperty(
        type=PE_CurveSettings,
        name="AP Curves",
        description="AP by measurement, for each kind of sensor",
    )
    own_sensors: CollectionProperty(
        type=PE_OwnSensorSettings,
        name="Own Sensors",
        description="Sensor models that only this file has",
    )
    own_index: IntProperty(
        name="Selected Own Sensor", description="Row of the list whose figures are shown", min=0
    )
    mounts: CollectionProperty(
        type=PE_MountSettings, name="Mounts", description="Surfaces or slots for sensors"
    )
    selected_sensor: IntProperty(
        name="Selected Sensor",
        description="Place of the selected sensor among the scene's objects",
        get=selected_object_index,
        set=select_object_by_index,
    )
    mount_index: IntProperty(
        name="Selected Mount", description="Row of the list whose settings are shown", min=0
    )
    requirements: CollectionProperty(
        type=PE_Requirement,
        name="Requirements",
        description="Zones in which test bodies have to be seen",
    )
    requirement_index: IntProperty(
        name="Requirement",
        description="The 3D view goes to the worst place of the requirement",
        min=0,
        update=requirement_chosen,
    )
    states: CollectionProperty(
        type=PE_State, name="States", description="States of the vehicle: frames of the scene"
    )
    state_index: IntProperty(name="State", description="Row of the list", min=0)
    drawn_frame: IntProperty(
        name="Drawn at Frame",
        description="Frame at which the vehicle is as it is drawn: scores and files are of it",
        default=1,
        min=0,
    )
    weathers: CollectionProperty(
        type=PE_Weather, name="Weathers", description="Weathers in which the rig is scored, too"
    )
    weather_index: IntProperty(name="Weather", description="Row of the list", min=0)
    method: EnumProperty(
        items=METHODS,
        name="Method",
        description="Method of the search",
        default=search.DEFAULT_METHOD,
    )
    start_variants: BoolProperty(
        name="From Variants",
        description="Searches also start from all other variants; all starts share the budget",
    )
    start_poses: StringProperty(
        name="Further Starts",
        description="Placements of an imported study that searches also start from, as JSON",
        options={"HIDDEN"},
    )
    mounting_errors: BoolProperty(
        name="Mounting Errors",
        description="Evaluate each candidate by its mean over small mounting errors, so the result "
        "is not sensitive to them. A candidate takes about eight times as long",
    )

    passthrough: StringProperty(
        name="Kept of the Imported File",
        description="Content of an imported file besides the rig: an export to the same format "
        "writes it again",
        options={"HIDDEN"},
    )

    axles_known: BoolProperty(
        name="Axles",
        description="Set the positions of the axles: the rear axle is the origin of Autoware, "
        "nuScenes, ASAM OSI and DriveWorks",
        update=redraw,
    )

    live: PointerProperty(
        type=PE_LiveSettings,
        name="Live",
        description="The score that is updated while a sensor moves",
    )

    show_overlay: BoolProperty(
        name="Show Perception",
        description="Show in the 3D view what the sensors see and miss",
        default=True,
        update=redraw,
    )
    beam_limit: IntProperty(
        name="Maximum Beams",
        description="Maximum number of drawn beams, evenly chosen; more beams make the view slow",
        default=DEFAULT_BEAM_LIMIT,
        min=1,
        soft_max=200_000,
        update=redraw,
    )
    beam_length: FloatProperty(
        name="Beam Length",
        description="Drawn length of beams that hit nothing",
        default=DEFAULT_BEAM_LENGTH_M,
        min=0.1,
        soft_max=200.0,
        subtype="DISTANCE",
        unit="LENGTH",
        update=redraw,
    )

    view: PointerProperty(type=PE_ViewSettings, name="View", description="Overlay of the 3D view")
    before_look: StringProperty(
        name="Before Looking",
        description="Camera and size of pictures before a sensor was looked through, as JSON",
    )

    views_before_look: StringProperty(
        name="Views Before Looking",
        description="3D views as they were before a sensor was looked through, as JSON",
    )

    result_shown: StringProperty(name="Shown Result", description="Figures of the panel, as JSON")
    checks_shown: StringProperty(name="Checks", description="Warnings, as JSON")
    front_shown: StringProperty(name="Front", description="The last Pareto front, as JSON")
    has_result: BoolProperty(name="Has Result", description="A score is stored")
    result_json: StringProperty(
        name="Result", description="The last result in full, as result.json holds it"
    )
    result_signature: StringProperty(
        name="Signature",
        description="Identifies the scored scene, to find out whether the result is still valid",
    )
    result_stale: BoolProperty(
        name="Stale", description="The scene has changed since the result was made"
    )

    variants: CollectionProperty(
        type=PE_Variant, name="Variants", description="Saved sets of sensors for this vehicle"
    )
    variant_index: IntProperty(
        name="Selected Variant", description="Selected row of the list", min=0
    )
    variant_key: IntProperty(
        name="Active Variant", description="Key of the scene's active variant; 0: none"
    )
    variant_changed: BoolProperty(
        name="Changed", description="The scene differs from its active variant"
    )

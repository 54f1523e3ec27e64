"""What is stored on the scene: the study's settings, and a small summary of the last result."""

from __future__ import annotations

import math
import zlib
from typing import Any, cast

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..choices import PRIORS, TARGETS
from ..engine import pe, search, studies
from .callbacks import changed, redraw
from .list_rows import PE_CurveSettings, PE_FocusSettings, PE_MountSettings, PE_OwnSensorSettings
from .results import PE_FrontRow, PE_ResultPart, PE_Variant, PE_Warning
from .view import PE_LiveSettings, PE_ViewSettings

LARGEST_INT = 2**31 - 1
"""The largest whole number that a property can hold."""
DRAWN = "reference."
"""Settings whose keys begin so change the picture in the 3D view, and no score."""


def property_of(key: str, setting: studies.Setting) -> Any:
    """Return the property that a setting is stored in; its values are those of the panel."""
    panel, rule = setting.panel, cast(Any, setting.rule)
    assert panel is not None  # asked for those alone that have one
    options: dict[str, Any] = {
        "name": panel.label,
        "description": setting.tooltip,
        "default": studies.panel_default(setting),
        "soft_max": panel.soft_max,
        "precision": panel.precision,
        "step": panel.step,
        "update": changed if setting.scored else redraw if key.startswith(DRAWN) else None,
    }
    if isinstance(rule, studies.Toggle):
        return _made(BoolProperty, options)
    if isinstance(rule, studies.Pair):
        return _made(FloatVectorProperty, {**options, "size": 2, "unit": _unit(rule.rule)})
    low, high = (
        0 if setting.is_optional else rule.minimum if panel.min is None else panel.min,
        rule.maximum if panel.max is None else panel.max,
    )
    if isinstance(rule, studies.Whole):
        high = LARGEST_INT if high is None else min(high, LARGEST_INT)
        return _made(IntProperty, {**options, "min": low, "max": high})
    ends = {"min": low, "max": high if math.isfinite(high) else None}
    return _made(FloatProperty, {**options, **ends, "unit": _unit(rule)})


def _unit(rule: Any) -> str:
    return "LENGTH" if rule.unit == "m" else "NONE"


def _made(kind: Any, options: dict[str, Any]) -> Any:
    return kind(**{key: value for key, value in options.items() if value is not None})


StudySettings: Any = type(
    "StudySettings",
    (),
    {
        "__doc__": "A part of the scene's settings: all that the engine declares.",
        "__module__": __name__,
        "__annotations__": {
            setting.panel.property: property_of(key, setting)
            for key, setting in studies.setting_keys()
            if setting.panel is not None and not isinstance(setting.rule, studies.OneOf)
        },
    },
)


METHODS = tuple(
    (name, method.label, method.about, 1 + zlib.crc32(name.encode()) % 2**30)
    for name, method in search.METHODS.items()
)
"""Of searches; a file holds a number that stays a method's whatever others there are."""

DEFAULT_BEAM_LIMIT = 5_000

DEFAULT_BEAM_LENGTH_M = 8.0

# Before 4.5 every path could be relative to the .blend file; since then a property has to say so.
PATH_OPTIONS = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()


class PE_SceneSettings(StudySettings, bpy.types.PropertyGroup):
    """The study's settings, and the last result."""

    version: IntProperty(
        name="Version",
        description="Of what is stored here; 0 is before there were versions, or not saved yet",
        min=0,
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
        description="Where objects are to be expected",
        update=changed,
    )
    boxes: StringProperty(
        name="Boxes",
        description="File of labelled boxes: KITTI's labels, nuScenes' JSON or CSV",
        subtype="FILE_PATH",
        options=PATH_OPTIONS,
        update=changed,
    )
    targets: EnumProperty(
        items=TARGETS,
        name="Targets",
        description=studies.settings_of(pe.TargetRule)["targets"].text,
        update=changed,
    )
    focus: CollectionProperty(
        type=PE_FocusSettings,
        name="Focus",
        description="What counts more than the prior says, or less",
    )
    focus_index: IntProperty(
        name="Selected Focus", description="Row of the list whose settings are shown", min=0
    )
    curves: CollectionProperty(
        type=PE_CurveSettings, name="AP Curves", description="What measurements are worth, by kind"
    )
    own_sensors: CollectionProperty(
        type=PE_OwnSensorSettings, name="Own Sensors", description="Models of this file's own"
    )
    own_index: IntProperty(
        name="Selected Own Sensor", description="Row of the list whose figures are shown", min=0
    )
    mounts: CollectionProperty(
        type=PE_MountSettings, name="Mounts", description="Where sensors may sit"
    )
    mount_index: IntProperty(
        name="Selected Mount", description="Row of the list whose settings are shown", min=0
    )
    method: EnumProperty(
        items=METHODS,
        name="Method",
        description="How the search looks for better placements",
        default=search.DEFAULT_METHOD,
    )
    mounting_errors: BoolProperty(
        name="Mounting Errors",
        description="Judge each candidate by its mean over small errors of mounting, so that what "
        "is found can be bolted on. A candidate takes about eight times as long",
    )
    currency: StringProperty(
        name="Currency", description="What prices are told in", default="", maxlen=12
    )

    passthrough: StringProperty(
        name="Kept of the Imported File",
        description="What the file of an imported rig had besides the rig: an export to its own "
        "format has it again",
        options={"HIDDEN"},
    )

    axles_known: BoolProperty(
        name="Axles",
        description="Say where the axles are: the origin of Autoware, nuScenes, ASAM OSI and "
        "DriveWorks is the rear one",
        update=redraw,
    )

    live: PointerProperty(
        type=PE_LiveSettings, name="Live", description="The score that follows the hand"
    )

    show_overlay: BoolProperty(
        name="Show Perception",
        description="Show in the 3D view what the sensors see and miss",
        default=True,
        update=redraw,
    )
    beam_limit: IntProperty(
        name="Most Beams",
        description="Draw no more beams than this, evenly chosen; more make the view slow",
        default=DEFAULT_BEAM_LIMIT,
        min=1,
        soft_max=200_000,
        update=redraw,
    )
    beam_length: FloatProperty(
        name="Beam Length",
        description="How far beams are drawn that meet nothing",
        default=DEFAULT_BEAM_LENGTH_M,
        min=0.1,
        soft_max=200.0,
        subtype="DISTANCE",
        unit="LENGTH",
        update=redraw,
    )

    view: PointerProperty(
        type=PE_ViewSettings, name="View", description="What the 3D view shows of perception"
    )
    before_look: StringProperty(
        name="Before Looking",
        description="Camera and size of pictures before a sensor was looked through, as JSON",
    )

    views_before_look: StringProperty(
        name="Views Before Looking",
        description="3D views as they were before a sensor was looked through, as JSON",
    )

    has_result: BoolProperty(name="Has Result", description="A score is stored")
    result_kind: StringProperty(name="Kind", description="score or optimize")
    result_entropy: FloatProperty(
        name="Perception Entropy", description="In nats; lower is better. Rounded for display"
    )
    result_before: FloatProperty(
        name="Before", description="Perception entropy of the placement the search started from"
    )
    result_coverage: FloatProperty(
        name="Coverage", description="Share of the prior that some sensor sees, 0 to 1"
    )
    result_stderr: FloatProperty(
        name="Standard Error", description="Of the perception entropy; 0 when all voxels count"
    )
    result_json: StringProperty(
        name="Result", description="The last result in full, as result.json holds it"
    )
    result_signature: StringProperty(
        name="Signature", description="What was scored, to tell whether it still stands"
    )
    result_parts: CollectionProperty(
        type=PE_ResultPart, name="Parts", description="The last result by zone and by class"
    )
    result_stale: BoolProperty(
        name="Stale", description="The scene has changed since the result was made"
    )

    result_words: StringProperty(
        name="In Words", description="The last result in words, a line each"
    )
    result_missing: StringProperty(
        name="Missing", description="What was missing when it was scored, a line each"
    )
    vehicle_line: StringProperty(
        name="Vehicle in a Line", description="Its size, which way it faces, triangles and parts"
    )
    result_warnings: CollectionProperty(
        type=PE_Warning, name="Warnings", description="What the last score found odd"
    )
    result_ap: StringProperty(
        name="Expected AP", description="Of all objects, by their weights, and its standard error"
    )
    result_mounted_off: StringProperty(
        name="Mounted Off",
        description="What mounting errors add to the entropy on average, before and after",
    )
    result_sensor_lost: StringProperty(
        name="Sensor Lost",
        description="What the loss of one sensor adds to the entropy on average, before and after",
    )
    result_fragile: StringProperty(
        name="Fragile", description="Why what was found cannot be mounted exactly enough, if so"
    )
    front: CollectionProperty(
        type=PE_FrontRow, name="Front", description="Designs that no other beats, cheapest first"
    )
    front_told: StringProperty(name="Told", description="How many designs were looked at, and how")

    variants: CollectionProperty(
        type=PE_Variant, name="Variants", description="Ideas for this vehicle, to come back to"
    )
    variant_index: IntProperty(
        name="Selected Variant", description="Row of the list that is selected", min=0
    )
    variant_key: IntProperty(
        name="Active Variant", description="Key of the variant that stands in the scene; 0: none"
    )
    variant_changed: BoolProperty(
        name="Changed", description="The scene differs from the variant that was put there"
    )

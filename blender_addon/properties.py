"""What the add-on stores in a .blend file: on the scene, and on every object.

Here is what the user typed, and small summaries of the last result. Arrays live elsewhere.
"""

from __future__ import annotations

import bpy
from bpy.props import (
    BoolProperty,
    BoolVectorProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import changes
from .choices import PRIORS, REGION_ITEMS
from .engine import catalog, kinds, pe, search

DEFAULT_CANDIDATES = 150
DEFAULT_BEAM_LIMIT = 5_000
DEFAULT_BEAM_LENGTH_M = 8.0
DEFAULT_MODEL = "Pandar64"
DEFAULT_FOCUS = 2.0
DEFAULT_REGION = "front"
RANGE_DECIMALS = 3
# Before 4.5 every path could be relative to the .blend file; since then a property has to say so.
PATH_OPTIONS = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()
AXIS_LABELS = ("X", "Y", "Z", "Roll", "Pitch", "Yaw")
"""Of `search.AXES`."""
FREE_BY_DEFAULT = tuple(axis in search.PAPER_FREE for axis in search.AXES)

OBJECT_CLASSES = tuple(
    (name, name.capitalize(), f"Weigh {name}s") for name in pe.Prior.road().class_names
)


def redraw(_settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """Update callback of what only changes the picture."""
    changes.picture.tell()


def changed(_settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """Update callback of what changes the score."""
    changes.study.tell()


def model_suggestions(
    _settings: bpy.types.PropertyGroup, _context: bpy.types.Context, _typed: str
) -> list[tuple[str, str]]:
    """Return the catalogue's names with what they are; Blender filters by what was typed."""
    labels = {n: kind.label for kind in kinds.KINDS.values() for n in catalog.names(kind.name)}
    return [(name, labels[name]) for name in catalog.names() if name in labels]


class PE_FocusSettings(bpy.types.PropertyGroup):
    """A focus weight: what counts more than the prior says, or less. Its name is the user's."""

    factor: FloatProperty(
        name="Factor",
        description="How many times as much it counts: 2 doubles it, 0 leaves it out. Where "
        "several regions overlap, their factors multiply",
        default=DEFAULT_FOCUS,
        min=0.0,
        soft_max=10.0,
        update=changed,
    )
    region: EnumProperty(
        items=REGION_ITEMS,
        name="Region",
        description="Which part of the ground",
        default=DEFAULT_REGION,
        update=changed,
    )
    x_range: FloatVectorProperty(
        name="X",
        description="From and to, ahead of the origin; negative is behind it",
        size=2,
        default=pe.PerceptionSpace().x,
        unit="LENGTH",
        precision=RANGE_DECIMALS,
        update=changed,
    )
    y_range: FloatVectorProperty(
        name="Y",
        description="From and to, on the left of the origin; negative is on its right",
        size=2,
        default=pe.PerceptionSpace().y,
        unit="LENGTH",
        precision=RANGE_DECIMALS,
        update=changed,
    )
    classes: EnumProperty(
        items=OBJECT_CLASSES,
        name="Classes",
        description="Which kinds of objects. Shift-click for several",
        options={"ENUM_FLAG"},
        default={name for name, *_ in OBJECT_CLASSES},
        update=changed,
    )


class PE_SceneSettings(bpy.types.PropertyGroup):
    """The study's settings, and the last result."""

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
    focus: CollectionProperty(
        type=PE_FocusSettings,
        name="Focus",
        description="What counts more than the prior says, or less",
    )
    focus_index: IntProperty(
        name="Selected Focus", description="Row of the list whose settings are shown", min=0
    )
    score_samples: IntProperty(
        name="Score Voxels",
        description="Voxels a score looks at; 0: all, 64 million",
        default=0,
        min=0,
        update=changed,
    )
    candidates: IntProperty(
        name="Candidates",
        description="Placements tried in each of the seven rounds of a search. The paper tries "
        "1000",
        default=DEFAULT_CANDIDATES,
        min=1,
        soft_max=1000,
    )
    search_samples: IntProperty(
        name="Search Voxels",
        description="Voxels a candidate is judged on; 0: all, 64 million",
        default=pe.Search().samples,
        min=0,
    )
    seed: IntProperty(
        name="Seed",
        description="The same seed finds the same placement",
        default=0,
        min=0,
    )

    show_overlay: BoolProperty(
        name="Show Beams",
        description="Draw beams and frustums of the sensors in the 3D view",
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
    result_stale: BoolProperty(
        name="Stale", description="The scene has changed since the result was made"
    )


class PE_ObjectSettings(bpy.types.PropertyGroup):
    """What makes an object a sensor, and its part in the last result."""

    is_sensor: BoolProperty(
        name="Is a Sensor",
        description="This object is a sensor: its x axis looks ahead, z is up",
        update=changed,
    )
    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        default=DEFAULT_MODEL,
        search=model_suggestions,
        search_options=set(),
        update=changed,
    )
    fusion: StringProperty(
        name="Fusion",
        description="Sensors of one group count their beams or pixels together. When empty, all "
        "LiDARs are one group and each camera stands alone",
        update=changed,
    )
    free: BoolVectorProperty(
        name="Free Axes",
        description="What the search may change",
        size=len(search.AXES),
        default=FREE_BY_DEFAULT,
    )
    show: BoolProperty(
        name="Show Beams",
        description="Draw this sensor's beams or frustum in the 3D view",
        default=True,
        update=redraw,
    )
    placed: FloatVectorProperty(
        name="Placed",
        description="Placement last written by a search: x, y, z [m], roll, pitch, yaw [deg]",
        size=len(search.AXES),
        options={"HIDDEN"},
    )

    has_result: BoolProperty(name="Has Result", description="The last result knows this sensor")
    entropy: FloatProperty(
        name="Alone", description="Perception entropy if this were the only sensor [nats]"
    )
    coverage: FloatProperty(
        name="Coverage", description="Share of the prior that this sensor sees, 0 to 1"
    )
    beams: IntProperty(name="Beams", description="Beams of one revolution; 0 for a camera")
    stopped: IntProperty(name="Stopped", description="Beams that the vehicle itself stops")
    stopped_text: StringProperty(
        name="Stopped By", description="Which parts of the vehicle stop how many beams"
    )

    see_through: BoolProperty(
        name="Cameras See Through",
        description="Glass: cameras see through this object; LiDAR beams are stopped all the same",
        update=changed,
    )


CLASSES = (PE_FocusSettings, PE_SceneSettings, PE_ObjectSettings)


def add_pointers() -> None:
    """Hang the settings on scenes and objects."""
    bpy.types.Scene.perception_entropy = PointerProperty(type=PE_SceneSettings)
    bpy.types.Object.perception_entropy = PointerProperty(type=PE_ObjectSettings)


def remove_pointers() -> None:
    """Take them off again; what files hold stays in them."""
    del bpy.types.Object.perception_entropy
    del bpy.types.Scene.perception_entropy

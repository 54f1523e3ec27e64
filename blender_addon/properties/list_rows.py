"""Rows of lists that a user edits: focus weights, AP curves, own sensors, offered models, mounts.

Lists belong to the scene, those of offered models to a sensor.
"""

from __future__ import annotations

from typing import Any

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

from ..choices import BY_GROUP, BY_MATERIAL, BY_PARTS, ON_SLOTS, ON_SURFACE, REGION_ITEMS, free_name
from ..engine import pe
from ..sensor_kinds import own_kinds
from .callbacks import changed, model_suggestions, redraw
from .declared import group_of

DEFAULT_REGION = "front"

OBJECT_CLASSES = tuple(
    (name, name.capitalize(), f"Weigh {name}s") for name in pe.Prior.road().class_names
)


FocusFields: Any = group_of(pe.Focus)
ApCurveFields: Any = group_of(pe.ApCurve)
OptionFields: Any = group_of(pe.Option)
SurfaceMountFields: Any = group_of(pe.SurfaceMount)


class PE_FocusSettings(FocusFields, bpy.types.PropertyGroup):
    """A focus weight: a region and classes that count more or less than the prior says."""

    region: EnumProperty(
        items=REGION_ITEMS,
        name="Region",
        description="Region of the ground",
        default=DEFAULT_REGION,
        update=changed,
    )
    classes: EnumProperty(
        items=OBJECT_CLASSES,
        name="Classes",
        description="Classes of objects. Shift-click for several",
        options={"ENUM_FLAG"},
        default={name for name, *_ in OBJECT_CLASSES},
        update=changed,
    )


class PE_CurveSettings(ApCurveFields, bpy.types.PropertyGroup):
    """The AP curve of a kind of sensor: AP = a ln m + b. The row has the name of the kind."""

    own: BoolProperty(
        name="Own",
        description="Use these numbers, for example from pe fit, instead of the default curve",
        update=changed,
    )


class PE_OwnSensorSettings(bpy.types.PropertyGroup):
    """A sensor of the user's own; the row has the name of its model."""

    kind: EnumProperty(
        items=own_kinds, name="Kind", description="Kind of the sensor", update=changed
    )
    channels: IntProperty(
        name="Channels",
        description="Number of channels, evenly spread over the field of view",
        default=32,
        min=1,
        max=2048,
        update=changed,
    )
    elevations: FloatVectorProperty(
        name="Elevation °",
        description="Lowest and highest channel in degrees above the horizon",
        size=2,
        default=(-25.0, 15.0),
        min=-90.0,
        max=90.0,
        update=changed,
    )
    azimuths: FloatVectorProperty(
        name="Azimuth °",
        description="Begin and end in degrees; positive is left",
        size=2,
        default=(-180.0, 180.0),
        min=-360.0,
        max=360.0,
        update=changed,
    )
    azimuth_step: FloatProperty(
        name="Azimuth Step °",
        description="Angle between two beams of a channel in degrees",
        default=0.2,
        min=0.001,
        max=360.0,
        precision=3,
        update=changed,
    )
    max_range: FloatProperty(
        name="Range",
        description="Maximum distance at which a beam counts",
        default=200.0,
        min=0.01,
        unit="LENGTH",
        update=changed,
    )
    min_range: FloatProperty(
        name="From",
        description="Minimum distance at which a beam counts",
        default=0.0,
        min=0.0,
        unit="LENGTH",
        update=changed,
    )
    width: IntProperty(
        name="Width", description="Horizontal number of pixels", default=1920, min=1, update=changed
    )
    height: IntProperty(
        name="Height", description="Vertical number of pixels", default=1080, min=1, update=changed
    )
    hfov: FloatProperty(
        name="Field of View °",
        description="Horizontal field of view in degrees",
        default=90.0,
        min=0.001,
        max=179.9,
        update=changed,
    )
    lens: StringProperty(
        name="Lens",
        description="Instead of the field of view, with the keys of a study: fx = 930, cx = 965, cy"
        ' = 530, distortion = { model = "brown-conrady", k1 = -0.16 }. Also min_range_m'
        " and max_range_m",
        update=changed,
    )
    keys: StringProperty(
        name="Keys",
        description="For a kind without fields in the panel: the keys of its table in a study",
        update=changed,
    )
    problem: StringProperty(
        name="Problem", description="Why the sensor cannot be used; empty if it can"
    )
    known_as: StringProperty(name="Known As", description="Last known name")


class PE_SensorOption(OptionFields, bpy.types.PropertyGroup):
    """A model that may be chosen, and its price."""

    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        search=model_suggestions,
        search_options={"SUGGESTION"},
    )


MAX_NAME_LENGTH = 60

KINDS = (
    (ON_SURFACE, "Surface", "The sensor moves on faces of the vehicle"),
    (ON_SLOTS, "Slots", "The sensor takes the place of one of a collection's empties"),
)

FACES = (
    (BY_PARTS, "Parts", "Objects of the vehicle, all of their faces"),
    (BY_MATERIAL, "Material", "All faces of the vehicle that have a material"),
    (BY_GROUP, "Painted", "Faces of the vehicle's meshes whose corners all weigh more than a half "
     "in a vertex group"),
)  # fmt: skip


def _keep_apart(mount: PE_MountSettings, _context: bpy.types.Context) -> None:
    """Update callback of a mount's name: names are unique, and sensors follow a new name."""
    scene = mount.id_data
    rows = scene.perception_entropy.mounts
    taken = {row.name for row in rows if row != mount}
    name = free_name(mount.name.strip() or "Mount", taken)
    if name != mount.name:
        mount.name = name  # which calls this again
        return
    for obj in scene.objects:
        if mount.known_as and obj.perception_entropy.mount == mount.known_as:
            obj.perception_entropy.mount = name
    mount.known_as = name


def groups_of_vehicle(
    mount: PE_MountSettings, _context: bpy.types.Context, _typed: str
) -> list[str]:
    """Return the names of all vertex groups of the vehicle's meshes."""
    vehicle = mount.id_data.perception_entropy.vehicle
    objects = () if vehicle is None else vehicle.all_objects
    return sorted({group.name for obj in objects for group in obj.vertex_groups})


class PE_MountPart(bpy.types.PropertyGroup):
    """An object of the vehicle whose faces belong to a mount."""

    part: PointerProperty(
        type=bpy.types.Object, name="Part", description="Object of the vehicle", update=redraw
    )


class PE_MountSettings(SurfaceMountFields, bpy.types.PropertyGroup):
    """A mount: surfaces or slots for sensors."""

    name: StringProperty(
        name="Name",
        description="Name of the mount. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_keep_apart,
    )
    known_as: StringProperty(name="Known As", description="Last known name")
    kind: EnumProperty(items=KINDS, name="Kind", description="Surface or slots", update=redraw)
    faces: EnumProperty(
        items=FACES,
        name="Faces",
        description="How the faces of the vehicle are chosen",
        update=redraw,
    )
    parts: CollectionProperty(
        type=PE_MountPart, name="Parts", description="Objects whose faces belong to the mount"
    )
    material: PointerProperty(
        type=bpy.types.Material,
        name="Material",
        description="Faces of the vehicle with this material",
        update=redraw,
    )
    group: StringProperty(
        name="Vertex Group",
        description="Faces with a weight above 0.5 at all corners, painted in Weight Paint",
        search=groups_of_vehicle,
        search_options={"SUGGESTION"},
        update=redraw,
    )
    slots: PointerProperty(
        type=bpy.types.Collection,
        name="Slots",
        description="Each empty of the collection is a slot with a position and angles",
        update=redraw,
    )

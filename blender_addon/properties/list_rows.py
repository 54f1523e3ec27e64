"""Rows of lists that a user edits: focus weights, AP curves, own sensors, offered models, mounts.

Lists belong to the scene, those of offered models to a sensor.
"""

from __future__ import annotations

from typing import Any

from bpy.types import Collection, Context, Material, Object, PropertyGroup

from ..choices import BY_GROUP, BY_MATERIAL, BY_PARTS, ON_SLOTS, ON_SURFACE, REGION_ITEMS, free_name
from ..engine import pe
from ..sensor_kinds import own_kinds
from .callbacks import changed, model_suggestions, redraw
from .declared import group_of
from .fields import menu, number, numbers, pointer, rows, switch, text, whole

DEFAULT_REGION = "front"

OBJECT_CLASSES = tuple(
    (name, name.capitalize(), f"Weigh {name}s") for name in pe.Prior.road().class_names
)


FocusFields: Any = group_of(pe.Focus)
ApCurveFields: Any = group_of(pe.ApCurve)
OptionFields: Any = group_of(pe.Option)
SurfaceMountFields: Any = group_of(pe.SurfaceMount)


class PE_FocusSettings(FocusFields, PropertyGroup):
    """A focus weight: a region and classes that count more or less than the prior says."""

    region: menu(
        "Region", "Region of the ground", REGION_ITEMS, default=DEFAULT_REGION, update=changed
    )
    classes: menu(
        "Classes",
        "Classes of objects. Shift-click for several",
        OBJECT_CLASSES,
        options={"ENUM_FLAG"},
        default={name for name, *_ in OBJECT_CLASSES},
        update=changed,
    )


class PE_CurveSettings(ApCurveFields, PropertyGroup):
    """The AP curve of a kind of sensor: AP = a ln m + b. The row has the name of the kind."""

    own: switch(
        "Own",
        "Use these numbers, for example from pe fit, instead of the default curve",
        update=changed,
    )


class PE_OwnSensorSettings(PropertyGroup):
    """A sensor of the user's own; the row has the name of its model."""

    kind: menu("Kind", "Kind of the sensor", own_kinds, update=changed)
    channels: whole(
        "Channels",
        "Number of channels, evenly spread over the field of view",
        32,
        min=1,
        max=2048,
        update=changed,
    )
    elevations: numbers(
        "Elevation °",
        "Lowest and highest channel in degrees above the horizon",
        2,
        default=(-25.0, 15.0),
        min=-90.0,
        max=90.0,
        update=changed,
    )
    azimuths: numbers(
        "Azimuth °",
        "Begin and end in degrees; positive is left",
        2,
        default=(-180.0, 180.0),
        min=-360.0,
        max=360.0,
        update=changed,
    )
    azimuth_step: number(
        "Azimuth Step °",
        "Angle between two beams of a channel in degrees",
        0.2,
        min=0.001,
        max=360.0,
        precision=3,
        update=changed,
    )
    max_range: number(
        "Range",
        "Maximum distance at which a beam counts",
        200.0,
        min=0.01,
        unit="LENGTH",
        update=changed,
    )
    min_range: number(
        "From",
        "Minimum distance at which a beam counts",
        0.0,
        min=0.0,
        unit="LENGTH",
        update=changed,
    )
    width: whole("Width", "Horizontal number of pixels", 1920, min=1, update=changed)
    height: whole("Height", "Vertical number of pixels", 1080, min=1, update=changed)
    hfov: number(
        "Field of View °",
        "Horizontal field of view in degrees",
        90.0,
        min=0.001,
        max=179.9,
        update=changed,
    )
    lens: text(
        "Lens",
        "Instead of the field of view, with the keys of a study: fx = 930, cx = 965, cy"
        ' = 530, distortion = { model = "brown-conrady", k1 = -0.16 }. Also min_range_m'
        " and max_range_m",
        update=changed,
    )
    keys: text(
        "Keys",
        "For a kind without fields in the panel: the keys of its table in a study",
        update=changed,
    )
    problem: text("Problem", "Why the sensor cannot be used; empty if it can")
    known_as: text("Known As", "Last known name")


class PE_SensorOption(OptionFields, PropertyGroup):
    """A model that may be chosen, and its price."""

    model: text(
        "Model",
        "Name of the sensor in the catalogue",
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


def _keep_apart(mount: PE_MountSettings, _context: Context) -> None:
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


def groups_of_vehicle(mount: PE_MountSettings, _context: Context, _typed: str) -> list[str]:
    """Return the names of all vertex groups of the vehicle's meshes."""
    vehicle = mount.id_data.perception_entropy.vehicle
    objects = () if vehicle is None else vehicle.all_objects
    return sorted({group.name for obj in objects for group in obj.vertex_groups})


class PE_MountPart(PropertyGroup):
    """An object of the vehicle whose faces belong to a mount."""

    part: pointer("Part", "Object of the vehicle", Object, update=redraw)


class PE_MountSettings(SurfaceMountFields, PropertyGroup):
    """A mount: surfaces or slots for sensors."""

    name: text(
        "Name",
        "Name of the mount. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_keep_apart,
    )
    known_as: text("Known As", "Last known name")
    kind: menu("Kind", "Surface or slots", KINDS, update=redraw)
    faces: menu("Faces", "How the faces of the vehicle are chosen", FACES, update=redraw)
    parts: rows("Parts", "Objects whose faces belong to the mount", PE_MountPart)
    material: pointer(
        "Material", "Faces of the vehicle with this material", Material, update=redraw
    )
    group: text(
        "Vertex Group",
        "Faces with a weight above 0.5 at all corners, painted in Weight Paint",
        search=groups_of_vehicle,
        search_options={"SUGGESTION"},
        update=redraw,
    )
    slots: pointer(
        "Slots",
        "Each empty of the collection is a slot with a position and angles",
        Collection,
        update=redraw,
    )

"""Rows of lists that a user edits: focus weights, AP curves, own sensors, mounts, variants ...

Lists belong to the scene, those of offered models to a sensor.
"""

import json
from typing import Any

from bpy.types import Collection, Context, Object, PropertyGroup

from .. import document
from ..choices import BY_GROUP, BY_MESH, BY_PARTS, ON_SLOTS, ON_SURFACE, REGION_ITEMS, free_name
from ..engine import geometry, kinds, motion, pe
from ..sensor_kinds import OwnCamera, OwnLidar, OwnTable, own_kinds
from .callbacks import changed, model_suggestions, redraw
from .declared import PathOf, group_of, table_group
from .fields import menu, pointer, rows, switch, text, view, whole

DEFAULT_REGION = "front"
MAX_NAME_LENGTH = 60
NO_FRAME = -1

OBJECT_CLASSES = tuple(
    (name, name.capitalize(), f"Weigh {name}s") for name in pe.Prior.road().class_names
)


FocusFields: Any = group_of(pe.Focus)
OptionFields: Any = table_group(pe.Option)
SurfaceMountFields: Any = table_group(pe.SurfaceMount)
KINDS = (
    (ON_SURFACE, "Surface", "The sensor moves on faces of the vehicle"),
    (ON_SLOTS, "Slots", "The sensor takes the place of one of a collection's empties"),
)
FACES = (
    (BY_PARTS, "Parts", "Objects of the vehicle, all of their faces"),
    (BY_GROUP, "Painted", "Faces of the vehicle's meshes whose corners all weigh more than a half "
     "in a vertex group"),
    (BY_MESH, "Mesh", "Faces of a mesh beside the vehicle, such as a free region"),
)  # fmt: skip


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


def _curve_path(key: str) -> PathOf:
    """Return what finds a number of the curve of a row's kind in the scene's table."""

    def path_of(row: PropertyGroup) -> tuple[PropertyGroup, document.Keys]:
        return row.id_data.perception_entropy, ("ap", row.name, key)

    return path_of


ApCurveFields: Any = table_group(pe.ApCurve, path_of=_curve_path, is_explicit=True)


class PE_CurveSettings(ApCurveFields, PropertyGroup):
    """The AP curve of a kind of sensor: AP = a ln m + b. The row has the name of the kind; its
    numbers are in the scene's table."""

    own: switch(
        "Own",
        "Use these numbers, for example of your detector, instead of the default curve",
        update=changed,
        **view(document.has_own_curve, document.switch_own_curve),
    )


class Tabled:
    """A row whose properties are views of its table: that of a study file, without a name."""

    table: text("Table", "The row as a study file has it, as JSON", update=changed)


OwnLidarFields: Any = table_group(
    OwnLidar,
    own={"elevations": {"min": -90.0, "max": 90.0}, "azimuths": {"min": -360.0, "max": 360.0}},
)
OwnCameraFields: Any = table_group(OwnCamera)
OwnTableFields: Any = table_group(OwnTable)


class PE_OwnSensorSettings(OwnLidarFields, OwnCameraFields, OwnTableFields, Tabled, PropertyGroup):
    """A sensor of the user's own; the row has the name of its model."""

    kind: menu("Kind", "Kind of the sensor", own_kinds, update=changed)
    problem: text("Problem", "Why the sensor cannot be used; empty if it can")
    known_as: text("Known As", "Last known name")


class PE_SensorOption(OptionFields, Tabled, PropertyGroup):
    """A model that may be chosen, and its price."""

    model: text(
        "Model",
        "Name of the sensor in the catalogue",
        search=model_suggestions,
        search_options={"SUGGESTION"},
        **view(
            lambda row: document.value_at(row.table, ("model",), ""),
            lambda row, name: document.put(row, ("model",), name or None),
        ),
    )


def _free_name(row: PropertyGroup, rows: Any, usual: str) -> bool:
    """Give a row of a list a name that no other row has; return whether it had one already."""
    name = free_name(row.name.strip() or usual, {other.name for other in rows if other != row})
    if name == row.name:
        return True
    row.name = name  # which calls its callback again
    return False


def _mount_renamed(mount: "PE_MountSettings", _context: Context) -> None:
    """Update callback of a mount's name: names are unique, and sensors follow a new name."""
    scene = mount.id_data
    if not _free_name(mount, scene.perception_entropy.mounts, "Mount"):
        return
    for obj in scene.objects:
        if mount.known_as and obj.perception_entropy.mount == mount.known_as:
            obj.perception_entropy.mount = mount.name
    mount.known_as = mount.name


def _variant_renamed(variant: "PE_Variant", _context: Context) -> None:
    """Update callback of a variant's name: names are unique and not empty."""
    _free_name(variant, variant.id_data.perception_entropy.variants, "Variant")


def groups_of_vehicle(mount: "PE_MountSettings", _context: Context, _typed: str) -> list[str]:
    """Return the names of all vertex groups of the vehicle's meshes."""
    vehicle = mount.id_data.perception_entropy.vehicle
    objects = () if vehicle is None else vehicle.all_objects
    return sorted({group.name for obj in objects for group in obj.vertex_groups})


class PE_MountPart(PropertyGroup):
    """An object of the vehicle whose faces belong to a mount."""

    part: pointer("Part", "Object of the vehicle", Object, update=redraw)


class PE_MountSettings(SurfaceMountFields, Tabled, PropertyGroup):
    """A mount: surfaces or slots for sensors."""

    name: text(
        "Name",
        "Name of the mount. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_mount_renamed,
    )
    known_as: text("Known As", "Last known name")
    kind: menu("Kind", "Surface or slots", KINDS, update=redraw)
    faces: menu("Faces", "How the faces of the vehicle are chosen", FACES, update=redraw)
    parts: rows("Parts", "Objects whose faces belong to the mount", PE_MountPart)
    group: text(
        "Vertex Group",
        "Faces with a weight above 0.5 at all corners, painted in Weight Paint",
        search=groups_of_vehicle,
        search_options={"SUGGESTION"},
        update=redraw,
    )
    area: pointer("Mesh", "Mesh object whose faces are the mount", Object, update=redraw)
    slots: pointer(
        "Slots",
        "Each empty of the collection is a slot with a position and angles",
        Collection,
        update=redraw,
    )


class Switched:
    """A row that can be switched off."""

    enabled: switch("Used", "Count this row", True, update=changed)


StateFields: Any = table_group(geometry.State)
WeatherFields: Any = table_group(kinds.Weather)


class PE_State(StateFields, Switched, Tabled, PropertyGroup):
    """A state of the vehicle: a frame of the scene, and the motions that were read there."""

    frame: whole(
        "Frame",
        "Frame of the scene that shows this state",
        NO_FRAME,
        min=NO_FRAME,
        **view(
            lambda row: document.value_at(row.table, ("frame",), NO_FRAME),
            lambda row, frame: document.put(row, ("frame",), None if frame < 0 else frame),
        ),
    )


class PE_Weather(WeatherFields, Switched, Tabled, PropertyGroup):
    """A weather. At most one of rain, snow and fog is above 0."""


ScenarioFields: Any = table_group(motion.Scenario, is_explicit=True)


class PE_Scenario(ScenarioFields, Switched, Tabled, PropertyGroup):
    """A scenario of what moves round the vehicle; the row has its name. Its table has all fields,
    as those that are absent are the preset's."""

    result: text("Result", "When its tracks are confirmed, as JSON")


class PE_Variant(PropertyGroup):
    """A variant: the records of all sensors, and the result of scoring them."""

    name: text(
        "Name",
        "Name of the variant. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_variant_renamed,
    )
    key: whole("Key", "Identifies the variant, also after a change of its name")
    note: text("Note", "Note about the variant")
    sensors: text("Sensors", "All sensors, as JSON")
    score_json: text("Score", "The full score: zones, classes, sensors")
    figures_json: text("Figures", "Blind ground, reach, expected AP, and what they are of")
    signature: text("Signature", "Vehicle, prior and settings of the score")
    stale: switch("Stale", "Vehicle, prior or settings have changed since the variant was scored")

    @property
    def has_result(self) -> bool:
        """Whether the variant has a score."""
        return bool(self.score_json)

    @property
    def entropy(self) -> float:
        """Perception entropy of the score [nats]."""
        return float(json.loads(self.score_json)["entropy"])

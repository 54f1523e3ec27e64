"""Where a search may put sensors: mounts, what moves together, and what is kept to."""

from __future__ import annotations

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

from ..choices import BY_GROUP, BY_MATERIAL, BY_PARTS, ON_SLOTS, ON_SURFACE, free_name
from .callbacks import redraw

LONGEST_NAME = 60
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
ORIENTATIONS = (
    ("upright", "Upright", "Angles are to the ground, however the surface slants"),
    ("normal", "Follows Normal", "Angles are to a base plate that lies on the surface"),
    ("facing", "Looks Out", "Angles are to the surface's normal, as of a camera in a bumper"),
)


def _keep_apart(mount: PE_MountSettings, _context: bpy.types.Context) -> None:
    """Update callback of a mount's name: none is empty, no two are alike, and sensors follow."""
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


def mounts_of_scene(
    _settings: bpy.types.PropertyGroup, context: bpy.types.Context, _typed: str
) -> list[str]:
    """Return the names of the scene's mounts."""
    return [row.name for row in context.scene.perception_entropy.mounts]


def racks_of_scene(
    _settings: bpy.types.PropertyGroup, context: bpy.types.Context, _typed: str
) -> list[str]:
    """Return the names of the racks that sensors of the scene are on."""
    return sorted({obj.perception_entropy.rack for obj in context.scene.objects} - {""})


class PE_MountPart(bpy.types.PropertyGroup):
    """An object of the vehicle whose faces belong to a mount."""

    part: PointerProperty(
        type=bpy.types.Object, name="Part", description="Object of the vehicle", update=redraw
    )


class PE_MountSettings(bpy.types.PropertyGroup):
    """A mount: where sensors may sit."""

    name: StringProperty(
        name="Name",
        description="Name of the mount. Double-click to change it",
        maxlen=LONGEST_NAME,
        update=_keep_apart,
    )
    known_as: StringProperty(name="Known As", description="Its name when last looked at")
    kind: EnumProperty(items=KINDS, name="Kind", description="What it is", update=redraw)
    faces: EnumProperty(
        items=FACES, name="Faces", description="Which faces of the vehicle", update=redraw
    )
    parts: CollectionProperty(type=PE_MountPart, name="Parts", description="Whose faces it is")
    material: PointerProperty(
        type=bpy.types.Material,
        name="Material",
        description="Faces of the vehicle that have it",
        update=redraw,
    )
    group: StringProperty(
        name="Vertex Group",
        description="Painted in Weight Paint: faces whose corners all weigh more than a half",
        search=groups_of_vehicle,
        search_options={"SUGGESTION"},
        update=redraw,
    )
    standoff: FloatProperty(
        name="Stand-off",
        description="From the surface to the middle of the housing's base; a base plate of 40 mm "
        "is 0.04",
        default=0.0,
        min=0.0,
        max=10.0,
        precision=3,
        unit="LENGTH",
    )
    orientation: EnumProperty(
        items=ORIENTATIONS, name="Orientation", description="What the sensor's angles are to"
    )
    slots: PointerProperty(
        type=bpy.types.Collection,
        name="Slots",
        description="Each empty of the collection is a slot, with its place and angles",
        update=redraw,
    )


class MountingSettings:
    """A part of the scene's settings."""

    mounts: CollectionProperty(
        type=PE_MountSettings, name="Mounts", description="Where sensors may sit"
    )
    mount_index: IntProperty(
        name="Selected Mount", description="Row of the list whose settings are shown", min=0
    )
    max_height: FloatProperty(
        name="Max Height",
        description="No housing's top is above this; 0: no limit",
        min=0.0,
        soft_max=5.0,
        precision=3,
        unit="LENGTH",
    )
    max_width: FloatProperty(
        name="Max Width",
        description="Overall: no housing is farther than half of it from the middle; 0: no limit",
        min=0.0,
        soft_max=4.0,
        precision=3,
        unit="LENGTH",
    )
    min_distance: FloatProperty(
        name="Least Distance",
        description="Between any two sensors' origins",
        min=0.0,
        soft_max=2.0,
        precision=3,
        unit="LENGTH",
    )
    clear_housings: BoolProperty(
        name="Clear Housings",
        description="No housing reaches into the body or into another one. Of sensors on a surface "
        "this always holds",
    )


class MountedSettings:
    """A part of an object's settings."""

    mount: StringProperty(
        name="Mount",
        description="Where the search may put this sensor; empty: in a box of coordinates",
        search=mounts_of_scene,
        search_options={"SUGGESTION"},
        update=redraw,
    )
    rack: StringProperty(
        name="Rack",
        description="Sensors on one rack move as one in a search; the first by name leads",
        search=racks_of_scene,
        search_options={"SUGGESTION"},
    )
    is_rack: BoolProperty(
        name="Is a Rack",
        description="Sensors that are parented to this object move as one in a search",
    )
    is_no_go: BoolProperty(
        name="No-Go Area",
        description="No part of a sensor may be in the box round this object",
        update=redraw,
    )

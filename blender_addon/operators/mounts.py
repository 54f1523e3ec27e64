"""Mounts: rows of the panel's list, their faces, and sensors that are put on them."""

from typing import Any

import bpy
import numpy as np
from bpy.props import EnumProperty

from .. import document, signals
from ..choices import BY_GROUP, BY_PARTS
from ..engine import catalog, search
from .add_sensor import select_only
from .declared import Refused, chosen_sensor, operator
from .edit_sensors import NAME
from .rows import new_row, row_list, unless_selected

IN_A_BOX = "BOX"  # The entry for no mount in the menu of a sensor's mounts
NO_GO_SIZE_M = 0.25  # Half a side of a no-go area that encloses no part
PART_MARGIN_M = 0.02
MIN_SIDE_M = 0.01
"""Margin of a no-go area round parts, and its smallest side."""
_listed: list[tuple[str, str, str]] = []
"""What the menu lists: Blender reads the texts after the function that made them returned."""


def take_sensors_off(scene: bpy.types.Scene, mount: bpy.types.PropertyGroup) -> None:
    """Take sensors off a mount that is about to be removed."""
    for obj in document.sensor_objects(scene):
        if obj.perception_entropy.mount == mount.name:
            obj.perception_entropy.mount = ""
    signals.view_changed.emit()


def add_mount(context: bpy.types.Context, _kind: str) -> None:
    """Add a surface for sensors: of the vehicle's selected objects, or the group being painted"""
    painted = painted_group(context)
    parts = [] if painted else selected_parts(context)
    name = painted or (parts[0].name if len(parts) == 1 else "Mount")
    row = new_row(context.scene, "mounts", name)
    row.faces, row.group = (BY_GROUP, painted) if painted else (BY_PARTS, "")
    _set_parts(row, parts)


row_list(
    "mounts",
    "mount",
    add=add_mount,
    removing=take_sensors_off,
    loss="; a search then moves its sensors in boxes again",
)


@operator("Take Selected", unless=unless_selected("mounts"), signal=signals.view_changed)
def mount_parts(context: bpy.types.Context) -> None:
    """Use all faces of the vehicle's selected objects for this mount"""
    settings = context.scene.perception_entropy
    parts = selected_parts(context)
    if not parts:
        raise Refused("Select objects of the vehicle's collection first")
    _set_parts(settings.mounts[settings.mount_index], parts)


def _menu_items(_operator: object, context: Any) -> list[tuple[str, str, str]]:
    """Return the scene's mounts as Blender wants a menu."""
    rows = context.scene.perception_entropy.mounts
    free = (IN_A_BOX, "Box of Coordinates", "The search moves it within its bounds")
    _listed[:] = [free, *((row.name, row.name, "Put it on this mount") for row in rows)]
    return _listed


@operator(
    "Mount Sensor",
    signal=signals.study_changed,
    mount=EnumProperty(name="Mount", description="Mount of the sensor", items=_menu_items),
    name=NAME,
)
def mount_sensor(context: bpy.types.Context, mount: str, name: str) -> None:
    """Choose the mount of this sensor, and move it to the nearest point of that mount"""
    obj = chosen_sensor(context, name)
    if mount != IN_A_BOX:
        put_on_mount(context.scene, context.evaluated_depsgraph_get(), obj, mount)
    obj.perception_entropy.mount = "" if mount == IN_A_BOX else mount


@operator("Add No-Go Area")
def add_no_go(context: bpy.types.Context) -> None:
    """Add a box that no part of a sensor may be in: round the vehicle's parts that are selected,
    else at the 3D cursor, or on the roof where the cursor is at the origin"""
    obj = bpy.data.objects.new("no_go", None)
    obj.empty_display_type = "CUBE"
    obj.empty_display_size = NO_GO_SIZE_M
    low, high = no_go_extent(context)
    obj.location = (low + high) / 2.0
    obj.scale = np.maximum(high - low, MIN_SIDE_M) / (2.0 * NO_GO_SIZE_M)
    document.shown_collection(context.scene).objects.link(obj)
    obj.perception_entropy.is_no_go = True
    select_only(context, obj)


def no_go_extent(context: bpy.types.Context) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and the highest corner (3,) [m] that a new no-go area has."""
    if parts := selected_parts(context):
        points = np.concatenate([_corners(part) for part in parts])
        return points.min(axis=0) - PART_MARGIN_M, points.max(axis=0) + PART_MARGIN_M
    half = np.full(3, NO_GO_SIZE_M)
    middle = np.array(context.scene.cursor.location)
    if not middle.any():  # the default position of the cursor is inside the car
        vehicle = context.scene.perception_entropy.vehicle
        meshes = [o for o in (vehicle.all_objects if vehicle else ()) if o.type == "MESH"]
        points = np.concatenate([np.zeros((1, 3)), *map(_corners, meshes)])
        middle[2] = points[:, 2].max() + NO_GO_SIZE_M
    return middle - half, middle + half


def _corners(obj: bpy.types.Object) -> np.ndarray:
    """(8, 3) corners of an object's box in the ground frame [m]."""
    ground_from_object = np.array(obj.matrix_world, dtype=float)
    corners = np.array(obj.bound_box, dtype=float)
    return corners @ ground_from_object[:3, :3].T + ground_from_object[:3, 3]


def put_on_mount(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, obj: bpy.types.Object, name: str
) -> None:
    """Put a sensor on a mount, at the nearest point to where it is. `InputError` when the mount has
    no faces or slots, or its pose is fixed."""
    row = scene.perception_entropy.mounts[name]
    mount = document.mount_of_row(scene, depsgraph, row)
    vehicle = document.vehicle_of_scene(scene, depsgraph)
    sensor = document.sensor_from_object(obj, depsgraph)
    housing = catalog.housing(sensor.model.name)
    document.place_poses(scene, {obj.name: search.snap_to_mount(sensor, mount, vehicle, housing)})


def selected_parts(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the vehicle's objects that are selected, by name."""
    vehicle = context.scene.perception_entropy.vehicle
    members = set() if vehicle is None else set(vehicle.all_objects)
    parts = (o for o in context.selected_objects if o.type == "MESH" and o in members)
    return sorted(parts, key=lambda o: o.name)


def painted_group(context: bpy.types.Context) -> str:
    """Return the vertex group that is being painted; empty in other modes."""
    obj = context.active_object
    if obj is None or obj.mode != "WEIGHT_PAINT" or obj.vertex_groups.active is None:
        return ""
    return obj.vertex_groups.active.name


def _set_parts(row: bpy.types.PropertyGroup, parts: list[bpy.types.Object]) -> None:
    row.parts.clear()
    for part in parts:
        row.parts.add().part = part

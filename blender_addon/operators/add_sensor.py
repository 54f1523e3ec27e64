"""Add a sensor: an empty that carries its settings, at a place that makes sense."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.props import StringProperty
from mathutils import Vector

from .. import bridge
from ..engine import catalog, pe
from ..properties import DEFAULT_MODEL, model_suggestions

COLLECTION = "Sensors"
LIDAR_MODEL, CAMERA_MODEL = DEFAULT_MODEL, "Camera 90 deg"

LIDAR_ABOVE_ROOF_M = 0.3
CAMERA_ABOVE_ROOF_M = 0.05
ROOF_DEPTH_M = 0.1
"""What lies this near to the vehicle's highest point is its roof."""
WITHOUT_VEHICLE_M = {"lidar": (0.0, 0.0, 1.8), "camera": (0.0, 0.0, 1.5)}

DISPLAY = {"lidar": ("SPHERE", 0.12), "camera": ("ARROWS", 0.25)}
NAMES = {"lidar": "LiDAR", "camera": "Camera"}


class PE_OT_add_sensor(bpy.types.Operator):
    """Add a sensor at the 3D cursor, or on the roof while the cursor is at the origin"""

    bl_idname = "pe.add_sensor"
    bl_label = "Add Sensor"
    bl_options = {"REGISTER", "UNDO"}

    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        default=DEFAULT_MODEL,
        search=model_suggestions,
        search_options=set(),
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Sensors are added in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            kind = "lidar" if isinstance(catalog.load(self.model), pe.Lidar) else "camera"
            choose_vehicle(context.scene)
            location = sensible_place(context, kind)
        except pe.InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        obj = new_sensor(context, NAMES[kind], self.model, kind)
        obj.location = location
        select_only(context, obj)
        return {"FINISHED"}


def choose_vehicle(scene: bpy.types.Scene) -> None:
    """Take the only collection with meshes for the vehicle, if none has been chosen."""
    settings = scene.perception_entropy
    if settings.vehicle is None:
        solid = [
            child
            for child in scene.collection.children
            if any(obj.type == "MESH" for obj in child.all_objects)
        ]
        if len(solid) == 1:
            settings.vehicle = solid[0]


def sensible_place(context: bpy.types.Context, kind: str) -> Vector:
    """Return the 3D cursor, or while that is at the origin a place on the vehicle's roof."""
    cursor = context.scene.cursor.location
    collection = context.scene.perception_entropy.vehicle
    if cursor.length > 0.0:
        return cursor.copy()
    if collection is None:
        return Vector(WITHOUT_VEHICLE_M[kind])
    vehicle = bridge.vehicle_from_collection(collection, context.evaluated_depsgraph_get())
    return Vector(on_roof(vehicle, kind))


def on_roof(vehicle: pe.Vehicle, kind: str) -> tuple[float, float, float]:
    """Return a place above the middle of the roof for a LiDAR, at its front edge for a camera."""
    corners = vehicle.triangles.reshape(-1, 3)
    top = corners[:, 2].max()
    roof = corners[corners[:, 2] > top - ROOF_DEPTH_M]
    low, high = roof.min(axis=0), roof.max(axis=0)
    middle = (low + high) / 2.0
    if kind == "lidar":
        place = (middle[0], middle[1], top + LIDAR_ABOVE_ROOF_M)
    else:
        place = (high[0], middle[1], top + CAMERA_ABOVE_ROOF_M)
    x, y, z = np.round(place, 2).tolist()
    return x, y, z


def new_sensor(context: bpy.types.Context, name: str, model: str, kind: str) -> bpy.types.Object:
    """Make a sensor in the scene's collection of sensors."""
    obj = bpy.data.objects.new(name, None)
    obj.empty_display_type, obj.empty_display_size = DISPLAY[kind]
    sensors_collection(context.scene).objects.link(obj)
    if obj.name not in context.view_layer.objects:  # that collection is excluded from the view
        context.scene.collection.objects.link(obj)
    obj.perception_entropy.model = model
    obj.perception_entropy.is_sensor = True
    return obj


def sensors_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    """Return the scene's collection of sensors; make it if there is none."""
    for child in scene.collection.children_recursive:
        if child.name == COLLECTION:
            return child
    made = bpy.data.collections.new(COLLECTION)
    scene.collection.children.link(made)
    return made


def select_only(context: bpy.types.Context, obj: bpy.types.Object) -> None:
    """Make an object the active one, and the only one that is selected."""
    for other in context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj


CLASSES = (PE_OT_add_sensor,)

"""Blender's own cameras and empties as sensors, and sensors as cameras and empties."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import bridge
from ..engine import catalog, exchange
from .file_sensors import stand_sensors
from .reports import REFUSALS, refuse, tell

LIDAR = "lidar"


def lidar_models(_own: object, _context: object, typed: str) -> list[str]:
    """Return the catalogue's LiDARs whose names hold what is typed; all where none does."""
    return catalog.matching(typed, LIDAR) or catalog.names(LIDAR)


class PE_OT_sensors_from_objects(bpy.types.Operator):
    """Put Blender's cameras and empties in place of the sensors that stand here, as a variant.

    A camera's lens, shift, clipping and picture size are its sensor's; an empty looks along x"""

    bl_idname = "pe.sensors_from_objects"
    bl_label = "Sensors from Cameras and Empties"
    bl_options = {"REGISTER", "UNDO"}

    selected: BoolProperty(
        name="Selected Only", description="Of all cameras and empties, or those selected"
    )
    model: StringProperty(
        name="Empties' Model",
        description="For empties that say no model (custom property `model`)",
        default=exchange.STAND_INS[LIDAR],
        search=lidar_models,
        search_options=set(),
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.selected = bool(bridge.plain_objects(context.selected_objects))
        return context.window_manager.invoke_props_dialog(self, width=420)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Sensors are made in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        objects = context.selected_objects if self.selected else scene.objects
        try:
            found, lines = bridge.sensors_of_objects(scene, objects, {}, self.model)
            return stand_sensors(
                self, scene, "From Objects", found, lines, "From Blender's cameras and empties"
            )
        except REFUSALS as error:
            return refuse(self, error)


class PE_OT_sensors_to_objects(bpy.types.Operator):
    """Add a camera for each camera sensor and an empty for each other one, in a collection"""

    bl_idname = "pe.sensors_to_objects"
    bl_label = "Cameras and Empties from Sensors"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        try:
            rig = bridge.rig_from_objects(bridge.sensor_objects(scene), depsgraph)
            made, lines = bridge.put_objects(scene, rig)
        except REFUSALS as error:
            return refuse(self, error)
        for line in lines:
            tell(self, "WARNING", line)
        tell(self, "INFO", f"Added {len(made)} to {made[0].users_collection[0].name}")
        return {"FINISHED"}


CLASSES = (PE_OT_sensors_from_objects, PE_OT_sensors_to_objects)

"""Select a sensor from the panel's list."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty

from .. import roster
from .add_sensor import select_only
from .reports import tell


def listed_sensors(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """All sensors of a scene by name, for a list of them."""
    return roster.sensors(scene)


class PE_OT_select_sensor(bpy.types.Operator):
    """Select this sensor and show its settings"""

    bl_idname = "pe.select_sensor"
    bl_label = "Select Sensor"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor's object")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT"

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.view_layer.objects.get(self.name)
        if obj is None or not obj.visible_get():
            tell(self, "WARNING", f"{self.name} is hidden")
            return {"CANCELLED"}
        select_only(context, obj)
        return {"FINISHED"}


CLASSES = (PE_OT_select_sensor,)

"""Select a sensor or a part from the panel; have a sensor count, or not."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty

from .. import changes, roster
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


class PE_OT_select_part(bpy.types.Operator):
    """Select this part of the vehicle"""

    bl_idname = "pe.select_part"
    bl_label = "Select Part"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(name="Name", description="Name of the part's object")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT"

    def execute(self, context: bpy.types.Context) -> set[str]:
        # A linked part goes by its name and its file's, which is no key of the view's objects.
        found = (o for o in context.view_layer.objects if self.name in (o.name_full, o.name))
        obj = next(found, None)
        if obj is None or not obj.visible_get():
            tell(self, "WARNING", f"{self.name} is hidden, or it is gone")
            return {"CANCELLED"}
        select_only(context, obj)
        return {"FINISHED"}


class PE_OT_toggle_sensor(bpy.types.Operator):
    """Whether this sensor counts: a hidden one is not scored. The Outliner's eye does the same"""

    bl_idname = "pe.toggle_sensor"
    bl_label = "Show or Hide Sensor"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor's object")

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.scene.objects.get(self.name)
        if obj is None or obj.name not in context.view_layer.objects:
            tell(self, "WARNING", f"{self.name} is in a collection that is left out of the view")
            return {"CANCELLED"}
        hide = obj.visible_get()
        if not hide:
            obj.hide_viewport = False
        obj.hide_set(hide)
        changes.study.tell()
        if hide == obj.visible_get():
            tell(self, "WARNING", f"{self.name} is hidden by its collection, or by local view")
        return {"FINISHED"}


CLASSES = (PE_OT_select_sensor, PE_OT_select_part, PE_OT_toggle_sensor)

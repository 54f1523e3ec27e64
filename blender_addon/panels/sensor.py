"""Settings of the sensor that is selected."""

from __future__ import annotations

import bpy

from ..properties import AXIS_LABELS
from .layout import Tab


class PE_PT_sensor(Tab, bpy.types.Panel):
    """Settings of the sensor that is selected"""

    bl_idname = "PE_PT_sensor"
    bl_label = "Sensor"
    bl_parent_id = "PE_PT_main"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return obj is not None and obj.perception_entropy.is_sensor

    def draw(self, context: bpy.types.Context) -> None:
        obj = context.active_object
        settings = obj.perception_entropy
        layout = self.layout
        layout.prop(settings, "model")
        layout.prop(settings, "fusion")
        layout.label(text=f"The search may change, for {obj.name}:")
        row = layout.row(align=True)
        for index, label in enumerate(AXIS_LABELS):
            row.prop(settings, "free", index=index, text=label, toggle=True)


CLASSES = (PE_PT_sensor,)

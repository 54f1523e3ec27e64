"""Settings of the part of the vehicle that is selected."""

from __future__ import annotations

import bpy

from .layout import Tab


class PE_PT_part(Tab, bpy.types.Panel):
    """Settings of the part of the vehicle that is selected"""

    bl_idname = "PE_PT_part"
    bl_label = "Vehicle Part"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return obj is not None and obj.type != "EMPTY" and not obj.perception_entropy.is_sensor

    def draw(self, context: bpy.types.Context) -> None:
        obj = context.active_object
        self.layout.label(text=obj.name, icon="OBJECT_DATA")
        self.layout.prop(obj.perception_entropy, "see_through")


CLASSES = (PE_PT_part,)

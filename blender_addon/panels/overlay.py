"""What is drawn in the 3D view."""

from __future__ import annotations

import bpy

from .layout import Tab, draw_properties


class PE_PT_overlay(Tab, bpy.types.Panel):
    """What is drawn in the 3D view"""

    bl_idname = "PE_PT_overlay"
    bl_label = "Overlay"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.scene.perception_entropy, "show_overlay", text="")

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        self.layout.active = settings.show_overlay
        draw_properties(self.layout, settings, ("beam_limit", "beam_length"))


CLASSES = (PE_PT_overlay,)

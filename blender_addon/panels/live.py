"""The live score's settings: what it is compared with."""

from __future__ import annotations

import bpy

from ..choices import BEFORE_MOVE, PINNED
from ..operators import live_lines, reference_label
from .layout import Tab, columns
from .words import draw_sentence


class PE_MT_live_against(bpy.types.Menu):
    """What the live score is compared with"""

    bl_idname = "PE_MT_live_against"
    bl_label = "Compare Live With"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("pe.live_against", text="Before the Last Move").key = BEFORE_MOVE
        layout.operator("pe.live_against", text="Pin These Sensors", icon="PINNED").key = PINNED
        variants = context.scene.perception_entropy.variants
        if variants:
            layout.separator()
        for row in variants:
            layout.operator("pe.live_against", text=row.name, translate=False).key = row.key


class PE_PT_live(Tab, bpy.types.Panel):
    """What the score that follows the hand is compared with, and what it tells besides"""

    bl_idname = "PE_PT_live"
    bl_label = "Live"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.scene.perception_entropy.live.on

    def draw(self, context: bpy.types.Context) -> None:
        name, menu = columns(self.layout, 0.4)
        name.label(text="Compared With")
        chosen = reference_label(context.scene)
        menu.menu(PE_MT_live_against.bl_idname, text=chosen, translate=False)
        live = context.scene.perception_entropy.live
        name, field = columns(self.layout, 0.4)
        name.label(text="Beside")
        field.prop(live, "anchor", text="")
        self.layout.prop(live, "figures")
        for line in live_lines(context.scene):
            draw_sentence(self.layout, context, line)


CLASSES = (PE_MT_live_against, PE_PT_live)

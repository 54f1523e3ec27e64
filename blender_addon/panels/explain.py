"""What a score means in words: of the rig, of the sensor that is selected, of a place."""

from __future__ import annotations

import bpy

from ..operators import answer
from .layout import Tab
from .sensor_table import draw_sensor_table
from .words import BUTTON_PX, draw_sentence


class PE_PT_explain(Tab, bpy.types.Panel):
    """What the score means in words, and what is seen of a place"""

    bl_idname = "PE_PT_explain"
    bl_label = "Explain"

    def draw(self, context: bpy.types.Context) -> None:
        settings, obj = context.scene.perception_entropy, context.active_object
        layout = self.layout
        layout.operator("pe.ask_place", icon="EYEDROPPER")
        draw_answer(layout, context)
        if settings.has_result and settings.result_words:
            lines = layout.column(align=True)
            lines.active = not settings.result_stale
            for line in settings.result_words.splitlines():
                draw_sentence(lines, context, line[:1].upper() + line[1:], icon="DOT")
        if settings.has_result:
            draw_sensor_table(layout, context)
        if obj is not None and obj.perception_entropy.is_sensor:
            draw_sensor_words(layout, context, obj)


def draw_sensor_words(
    layout: bpy.types.UILayout, context: bpy.types.Context, obj: bpy.types.Object
) -> None:
    """Draw what the last result says of one sensor in sentences."""
    settings = obj.perception_entropy
    if not settings.has_result:
        return
    box = layout.box().column(align=True)
    box.label(text=obj.name, icon="EMPTY_DATA", translate=False)
    alone = f"sees {settings.coverage:.1%} of where objects are"
    for line in (alone, *settings.words.splitlines()):
        draw_sentence(box, context, line[:1].upper() + line[1:], icon="DOT")


def draw_answer(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw what there is to tell of the place that was asked about last."""
    found = answer(context.scene)
    if found is None:
        return
    box = layout.box()
    row = box.row()
    lines = row.column(align=True)
    for line in found:
        draw_sentence(lines, context, line, beside_px=BUTTON_PX)
    row.operator("pe.dismiss_place", text="", icon="X", emboss=False)


CLASSES = (PE_PT_explain,)

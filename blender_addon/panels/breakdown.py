"""The last result by zone and by class: where the rig sees well, and what."""

from __future__ import annotations

import bpy

from .layout import Tab

NAME_SHARE = 0.5


class PE_PT_breakdown(Tab, bpy.types.Panel):
    """Entropy and coverage by zone of the ground, and by class of object"""

    bl_idname = "PE_PT_breakdown"
    bl_label = "By Zone and Class"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = context.scene.perception_entropy
        return settings.has_result and len(settings.result_parts) > 0

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        column = self.layout.box().column(align=True)
        column.active = not settings.result_stale
        for is_class, title in ((False, "Zone"), (True, "Class")):
            draw_row(column, title, "nats", "seen", header=True)
            for part in settings.result_parts:
                if part.is_class == is_class:
                    draw_row(column, part.name, f"{part.entropy:.2f}", f"{part.coverage:.1%}")
            if not is_class:
                column.separator()


def draw_row(
    layout: bpy.types.UILayout, name: str, entropy: str, seen: str, *, header: bool = False
) -> None:
    """Draw a row of the table; figures stand to the right."""
    split = layout.split(factor=NAME_SHARE)
    split.active = not header
    split.label(text=name, translate=False)
    figures = split.row()
    for text in (entropy, seen):
        cell = figures.row()
        cell.alignment = "RIGHT"
        cell.label(text=text, translate=False)


CLASSES = (PE_PT_breakdown,)

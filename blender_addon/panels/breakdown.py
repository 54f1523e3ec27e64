"""The last result by zone and by class: where the rig sees well, and what."""

from __future__ import annotations

import bpy

from .layout import Tab, draw_whether_stale

NAME_SHARE, NARROW_SHARE = 0.5, 0.3


class PE_PT_breakdown(Tab, bpy.types.Panel):
    """Entropy and coverage by zone of the ground, and by class of object"""

    bl_idname = "PE_PT_breakdown"
    bl_label = "By Zone and Class"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = context.scene.perception_entropy
        return settings.has_result and len(settings.result_parts) > 0

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        draw_whether_stale(self.layout, settings)
        column = self.layout.box().column(align=True)
        column.active = not settings.result_stale
        for is_class, title in ((False, "Zone"), (True, "Class")):
            found = is_class and bool(settings.result_ap)
            more = ("AP", "ahead") if found else ()
            draw_row(column, title, "nats", "seen", *more, header=True)
            for part in settings.result_parts:
                if part.is_class == is_class:
                    more = (part.ap, part.reach) if found else ()
                    digits = 0 if found else 1  # four figures have to fit
                    nats = f"{part.entropy:.{digits + 1}f}"
                    draw_row(column, part.name, nats, f"{part.coverage:.{digits}%}", *more)
            if not is_class:
                column.separator()


def draw_row(layout: bpy.types.UILayout, name: str, *figures: str, header: bool = False) -> None:
    """Draw a row of the table; figures stand to the right."""
    split = layout.split(factor=NAME_SHARE if len(figures) == 2 else NARROW_SHARE)
    split.active = not header
    split.label(text=name, translate=False)
    row = split.row()
    for text in figures:
        cell = row.row()
        cell.alignment = "RIGHT"
        cell.label(text=text, translate=False)


CLASSES = (PE_PT_breakdown,)

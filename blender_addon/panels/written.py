"""What the last export wrote, always in the same place, with the way there."""

from __future__ import annotations

import bpy

from ..operators import exporting
from .words import BUTTON_PX, draw_sentence


def draw_written(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw which files were written, what to know of them, and a button for their folder."""
    written = exporting.last
    if written is None:
        return
    box = layout.box().column(align=True)
    row = box.row()
    draw_sentence(row.column(align=True), context, written.text, "CHECKMARK", BUTTON_PX)
    row.operator("pe.dismiss_written", text="", icon="X", emboss=False)
    for line in written.lines:
        draw_sentence(box, context, line, icon="ERROR")
    box.operator("pe.open_folder", icon="FILE_FOLDER")

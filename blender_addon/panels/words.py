"""Sentences in a panel: broken into lines, and warnings with what can be pressed for them."""

from __future__ import annotations

import textwrap

import bpy

from ..operators import FIX_LABELS, warnings_are_behind

LETTER_PX = 6.2
"""About how wide a letter is, at a scale of 1."""
BESIDE_PX = 70
"""What borders and an icon take from a line."""
FEWEST = 20


def letters(context: bpy.types.Context) -> int:
    """Return about how many letters a line of the sidebar has room for."""
    scale = context.preferences.system.ui_scale or 1.0  # 0 without a window
    return max(FEWEST, int((context.region.width / scale - BESIDE_PX) / LETTER_PX))


def draw_sentence(
    layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str = "NONE"
) -> None:
    """Draw a sentence in as many lines as it takes; the icon stands before the first.

    One that is set in says more of the one before, and has none.
    """
    if text.startswith(" "):
        text, icon = text.strip(), "BLANK1"
    column = layout.column(align=True)
    column.scale_y = 0.8
    rest = "NONE" if icon == "NONE" else "BLANK1"
    for k, line in enumerate(textwrap.wrap(text, letters(context)) or [""]):
        column.label(text=line, icon=rest if k else icon, translate=False)


def draw_warning(
    layout: bpy.types.UILayout, context: bpy.types.Context, warning: bpy.types.PropertyGroup
) -> None:
    """Draw a warning, the part that causes it as a button, and what would mend it.

    After a move it is dim, and says so, until the sensors have been looked over again.
    """
    text = warning.text[:1].upper() + warning.text[1:]
    if warnings_are_behind():
        layout = layout.column(align=True)
        layout.active = False
        text = f"Before this move: {text[:1].lower()}{text[1:]}"
    draw_sentence(layout, context, text, icon="ERROR")
    if not (warning.fix in FIX_LABELS or warning.part):
        return
    row = layout.row(align=True)
    row.label(text="", icon="BLANK1")
    if warning.part:
        part = row.operator("pe.select_part", text=warning.part, icon="RESTRICT_SELECT_OFF")
        part.name = warning.part
    if warning.fix in FIX_LABELS:
        mend = row.operator("pe.mend", text=FIX_LABELS[warning.fix], icon="TOOL_SETTINGS")
        mend.fix, mend.subject, mend.amount = warning.fix, warning.subject, warning.amount

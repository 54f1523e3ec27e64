"""Sentences in a panel: broken into lines, and warnings with what can be pressed for them."""

from __future__ import annotations

from bisect import bisect_left
from functools import lru_cache

import blf
import bpy

from ..operators import FIX_LABELS, warnings_are_behind

LETTER_PX = 6.2
"""About how wide a letter is, at a scale of 1."""
BESIDE_PX, ICON_PX = 72, 20
"""What borders and the tab's name take from a line, and what an icon takes, at a scale of 1."""
BUTTON_PX = 26
"""What a small button beside a sentence takes from it, at a scale of 1."""
FEWEST = 10
NARROWEST_PX = 40
"""A sidebar can be made narrower than any word."""
FONT = 0


def letters(context: bpy.types.Context) -> int:
    """Return about how many letters a line of the sidebar has room for."""
    room = context.region.width / _scale(context) - BESIDE_PX - ICON_PX
    return max(FEWEST, int(room / LETTER_PX))


def wrapped(context: bpy.types.Context, text: str, beside_px: float = 0.0) -> tuple[str, ...]:
    """Return a sentence in lines that fit the sidebar, measured in its font."""
    scale = _scale(context)
    room = context.region.width - (BESIDE_PX + beside_px) * scale
    points = context.preferences.ui_styles[0].widget.points
    return lines_of(text, max(room, NARROWEST_PX * scale), points * scale)


@lru_cache(maxsize=512)
def lines_of(text: str, room_px: float, size_px: float) -> tuple[str, ...]:
    """Break a text so that no line of that size is wider than the room; a longer word is cut up."""
    blf.size(FONT, size_px)
    lines, line = [], ""
    for word in text.split():
        longer = f"{line} {word}".strip()
        if line and _width(longer) > room_px:
            lines.append(line)
            longer = word
        *full, line = _pieces(longer, room_px)
        lines += full
    return (*lines, line)


def _pieces(text: str, room_px: float) -> list[str]:
    """Cut a text where it gets too wide; what fits stays whole."""
    pieces = []
    while len(text) > 1 and _width(text) > room_px:
        fits = bisect_left(range(1, len(text)), True, key=lambda k: _width(text[:k]) > room_px)
        pieces.append(text[: max(fits, 1)])
        text = text[max(fits, 1) :]
    return [*pieces, text]


def _width(text: str) -> float:
    return blf.dimensions(FONT, text)[0]


def _scale(context: bpy.types.Context) -> float:
    return context.preferences.system.ui_scale or 1.0  # 0 without a window


def draw_sentence(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    text: str,
    icon: str = "NONE",
    beside_px: float = 0.0,
) -> None:
    """Draw a sentence in as many lines as it takes; the icon stands before the first.

    One that is set in says more of the one before, and has none. What stands beside the sentence
    takes `beside_px` from its room, at a scale of 1.
    """
    if text.startswith(" "):
        text, icon = text.strip(), "BLANK1"
    column = layout.column(align=True)
    column.scale_y = 0.8
    rest = "NONE" if icon == "NONE" else "BLANK1"
    beside_px += 0.0 if icon == "NONE" else ICON_PX
    for k, line in enumerate(wrapped(context, text, beside_px)):
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

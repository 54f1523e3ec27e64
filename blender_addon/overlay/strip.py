"""The strip of a drive-by along the lower edge of the 3D view: AP over time, moments, a cursor."""

import bpy

from .. import viewport
from ..engine import graphics
from ..viewport import FAINT, INK, PLATE, SMALL, PlateBox
from .batches import Batches

ROW = 14.0
HEAD = 20.0
FOOT = 34.0
PAD = 8.0
STALE: graphics.Rgba = (1.0, 0.75, 0.3, 1.0)
MIN_CELLS_PX = 120.0

_cells: list[Batches] = []
"""The batch of the strip that was drawn last."""


def draw_strip(
    context: bpy.types.Context, strip: graphics.TimeStrip, seconds: float, note: str
) -> PlateBox:
    """Draw a strip with its cursor after so many seconds; return the box of its plate. `note` says
    why it is not that of the scene; empty: it is."""
    scale = viewport.ui_scale()
    pad = PAD * scale
    small = SMALL * scale
    left = viewport.beside_toolbar(context)
    bottom = viewport.above_hud(context, over=())
    right = viewport.sidebar_left(context) - viewport.MARGIN * scale
    height = (HEAD + FOOT + ROW * len(strip.names)) * scale
    plate = left, bottom, right, bottom + height
    viewport.fill_box(plate, PLATE)
    title = f"{strip.title} ({note})" if note else strip.title
    top = bottom + height - HEAD * scale
    viewport.draw_text(title, left + pad, top + 0.3 * small, small, color=STALE if note else INK)
    names = max(viewport.text_size(name, small)[0] for name in strip.names)
    x = left + names + 2.0 * pad
    y = bottom + FOOT * scale
    end = right - pad
    for number, name in enumerate(strip.names):
        base = top - (number + 0.8) * ROW * scale
        viewport.draw_text(name, x - pad, base, small, color=FAINT, left_of_x=1.0)
    if end - x < MIN_CELLS_PX:  # a narrow view: the names alone
        return plate
    if not _cells or _cells[0].shape is not strip.cells:
        _cells[:] = [Batches.of(strip.cells)]
    with viewport.blended(), viewport.in_box((x, y, end, top)):
        _cells[0].draw_areas()

    def at(time_s: float) -> float:
        return x + strip.share(time_s) * (end - x)

    line = max(1.0, scale)
    for k, mark in enumerate(strip.marks):
        place = at(mark.time_s)
        viewport.fill_box((place - line, y - 4.0 * scale, place + line, top), mark.color)
        share = viewport.text_size(mark.text, small)[0] / 2.0
        ends = 0.0 if place - share < x else 1.0 if place + share > end else 0.5
        base = y - small - (4.0 + 13.0 * (k % 2)) * scale
        viewport.draw_text(mark.text, place, base, small, color=mark.color, left_of_x=ends)
    now = strip.first_s + seconds
    place = at(now)
    viewport.fill_box((place - line, y, place + line, top), INK)
    viewport.draw_text(f"{now:+.1f} s", end, top + 0.3 * small, small, color=INK, left_of_x=1.0)
    return plate


def clear() -> None:
    """Keep nothing on the graphics card."""
    _cells.clear()

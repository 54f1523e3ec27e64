"""The strip of a drive-by along the lower edge of the 3D view: AP over time, moments, a cursor."""

from ..engine import graphics
from ..view import plates, viewport
from ..view.plates import Plate, PlateSize, Room
from ..view.viewport import FAINT, INK, PLATE, SMALL, PlateBox
from .batches import Batches

ROW = 14.0
HEAD = 20.0
FOOT = 34.0
PAD = 8.0
STALE: graphics.Rgba = (1.0, 0.75, 0.3, 1.0)
MIN_CELLS_PX = 120.0
TIME = "+00.0 s"

_cells: list[Batches] = []
"""The batch of the strip that was drawn last."""


def strip_plate(strip: graphics.TimeStrip, room: Room, *, seconds: float, note: str) -> Plate:
    """Return the plate of a strip with its cursor after so many seconds; folded, it is its title
    and the time. `note` says why it is not that of the scene; empty: it is."""
    scale = room.scale
    small = SMALL * scale
    title = f"{strip.title} ({note})" if note else strip.title
    now = strip.first_s + seconds
    head = viewport.fitted(f"{now:+.1f} s  {title}", small, room.width - 2.0 * PAD * scale)
    height = HEAD + FOOT + ROW * len(strip.names)
    whole = PlateSize(room.width, height * scale)
    width = viewport.text_size(head, small)[0] + 2.0 * PAD * scale
    names = max(viewport.text_size(name, small)[0] for name in strip.names)
    is_wide = room.width - names - 3.0 * PAD * scale >= MIN_CELLS_PX
    folded = PlateSize(width, HEAD * scale)

    def draw(box: PlateBox, step: int) -> None:
        viewport.fill_box(box, PLATE)
        color = STALE if note else INK
        base = box[3] - HEAD * scale + 0.3 * small
        if is_wide and step == 0:
            left_of_time = box[2] - box[0] - 3.0 * PAD * scale - viewport.text_size(TIME, small)[0]
            text = viewport.fitted(title, small, left_of_time)
            viewport.draw_text(text, box[0] + PAD * scale, base, small, color=color)
            draw_strip(strip, box, now, scale)
        else:
            viewport.draw_text(head, box[0] + PAD * scale, base, small, color=color)

    return Plate(plates.DRIVE_BY, (whole, folded) if is_wide else (folded,), draw)


def draw_strip(strip: graphics.TimeStrip, box: PlateBox, now: float, scale: float) -> None:
    """Draw the rows of a strip, its moments and its cursor into the box of its plate."""
    left, bottom, right, _ = box
    pad = PAD * scale
    small = SMALL * scale
    top = box[3] - HEAD * scale
    names = max(viewport.text_size(name, small)[0] for name in strip.names)
    x = left + names + 2.0 * pad
    y = bottom + FOOT * scale
    end = right - pad
    for number, name in enumerate(strip.names):
        base = top - (number + 0.8) * ROW * scale
        viewport.draw_text(name, x - pad, base, small, color=FAINT, left_of_x=1.0)
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
    place = at(now)
    viewport.fill_box((place - line, y, place + line, top), INK)
    viewport.draw_text(f"{now:+.1f} s", end, top + 0.3 * small, small, color=INK, left_of_x=1.0)


def clear() -> None:
    """Keep nothing on the graphics card."""
    _cells.clear()

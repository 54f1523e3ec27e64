"""The read-out of the live score in the lower left corner of the 3D view: it draws stored text.

It is drawn clear of the toolbar and of the panel of the last operation; Blender's own text is at
the top.
"""

import textwrap
from typing import NamedTuple

import bpy

from .. import engine_process, viewport
from ..panel_text import is_simple, plain, typeset
from ..viewport import FAINT, INK, PLATE, SMALL, Rgba
from .readout_text import BETTER, WORSE, ReadoutLine, TextPiece, readout_of, state_of
from .shown import ShownScore, for_drawing
from .state import live_state

LARGE = 17.0
"""Size of the headline, in pixels of an interface at scale 1; so are all lengths below."""
ROW = 17.0
PAD = 10.0
ZONE_ROWS = 2
"""Rows that are reserved for zones, so that the plate does not jump with every move."""
WORD_GAP = 0.3
MIN_WIDTH = 236.0
MAX_COLUMNS = 64
MAX_SHARE = 1.0 / 3.0
"""Of the width between toolbar and sidebar that the plate takes at most, beyond `MIN_WIDTH`."""
ALERT: Rgba = (1.0, 0.84, 0.35, 1.0)
SENSE_COLORS: dict[int, Rgba] = {BETTER: (0.42, 0.75, 1.0, 1.0), WORSE: (1.0, 0.62, 0.25, 1.0)}
ARROWS = {BETTER: "\N{DOWNWARDS ARROW}", WORSE: "\N{UPWARDS ARROW}"}
PLATE_NAME = "live"


class TextRow(NamedTuple):
    """Text in a row: its size, pieces with their colours, and the gap between them, in sizes."""

    size: float
    words: tuple[tuple[str, Rgba], ...]
    gap: float = 1.0


_handlers = viewport.DrawHandlers()


def register() -> None:
    """Start drawing."""
    _handlers.show((draw, "POST_PIXEL"))


def unregister() -> None:
    """Stop drawing."""
    _handlers.hide()
    viewport.release_plate(PLATE_NAME)
    viewport.redraw_editors()


def draw() -> None:
    """Draw into the current 3D view, if it shows overlays; Blender calls this at each redraw."""
    context = bpy.context
    space = context.space_data
    scene = context.scene
    overlays = space is None or space.type != "VIEW_3D" or space.overlay.show_overlays
    box = None
    if scene.perception_entropy.live.on and overlays and viewport.is_lower_left(context):
        shown = for_drawing(scene)
        is_late = engine_process.busy(engine_process.OVERLAY)
        rows = rows_of(shown, live_state(scene.name).note, view_outdated=is_late)
        if is_simple(scene):
            rows = [row._replace(words=tuple((plain(t), c) for t, c in row.words)) for row in rows]
        scale = viewport.ui_scale()
        left = viewport.beside_toolbar(context)
        widest = max(MIN_WIDTH * scale, MAX_SHARE * (viewport.sidebar_left(context) - left))
        box = draw_rows(wrapped(rows, widest, scale), left, viewport.above_hud(context), scale)
    viewport.reserve_plate(context.region.as_pointer(), PLATE_NAME, box)


def row_of(line: ReadoutLine, color: Rgba = INK) -> TextRow:
    """Return a line as a row: gains and losses in their colours."""
    words = tuple((text, SENSE_COLORS.get(sense, color)) for text, sense in line)
    return TextRow(SMALL, words, WORD_GAP)


def rows_of(
    shown: ShownScore | None, note: str = "", *, view_outdated: bool = False
) -> list[TextRow]:
    """Return rows from the top down: the score, and why there is no newer one. `view_outdated`:
    beams and maps are still those of before the last move."""
    rows = [] if shown is None else _rows_of_score(shown, view_outdated and shown.exact)
    if note:
        rows += [
            TextRow(SMALL, ((line, ALERT),)) for line in textwrap.wrap(typeset(note), MAX_COLUMNS)
        ]
    return rows or [TextRow(SMALL, (("Live: scoring ...", FAINT),))]


def _rows_of_score(shown: ShownScore, view_outdated: bool) -> list[TextRow]:
    text = readout_of(shown)
    arrow = ARROWS.get(text.sense, "")
    color = SENSE_COLORS.get(text.sense, FAINT)
    change = ((f"{arrow} {text.change}".strip(), color),) if text.change else ()
    lacking = ZONE_ROWS + 1 - len(text.lines)
    reserved = ((TextPiece(""),),) * lacking if shown.pair is not None else ()
    error = state_of(shown, view_outdated=view_outdated)
    coverage, *zones = (row_of(line) for line in (*text.lines, *reserved))
    return [
        TextRow(LARGE, ((text.headline, INK), *change)),
        TextRow(SMALL, tuple((part, FAINT) for part in (error, text.against) if part)),
        coverage,
        *zones,
    ]


def wrapped(rows: list[TextRow], widest: float, scale: float) -> list[TextRow]:
    """Return rows that are no wider than `widest` [px]: what is too wide goes on in a row below. A
    single word may be wider."""
    return [part for row in rows for part in _parts_of(row, widest, scale)]


def _parts_of(row: TextRow, widest: float, scale: float) -> list[TextRow]:
    parts = [row._replace(words=())]
    for text, color in row.words:
        is_begun = False
        for word in text.split(" "):
            now = parts[-1].words
            joined = (*now[:-1], (f"{now[-1][0]} {word}", color)) if is_begun else now
            longer = row._replace(words=joined if is_begun else (*now, (word, color)))
            if now and _width(longer, scale) > widest:
                parts.append(row._replace(words=((word, color),)))
            else:
                parts[-1] = longer
            is_begun = True
    return parts


def draw_rows(rows: list[TextRow], left: float, bottom: float, scale: float) -> viewport.PlateBox:
    """Draw rows on a dark plate with that lower left corner [px]; return its box."""
    width = max(MIN_WIDTH * scale, *(_width(row, scale) for row in rows))
    height = sum(_height(row) for row in rows) * scale
    pad = PAD * scale
    box = left, bottom, left + width + 2.0 * pad, bottom + height + 2.0 * pad
    viewport.fill_box(box, PLATE)
    y = bottom + pad + height
    for row in rows:
        y -= _height(row) * scale
        x = left + pad
        size = row.size * scale
        for text, color in row.words:
            x += viewport.draw_text(text, x, y + 0.3 * size, size, color=color) + row.gap * size
    return box


def _width(row: TextRow, scale: float) -> float:
    size = row.size * scale
    gaps = (len(row.words) - 1) * row.gap * size
    return gaps + sum(viewport.text_size(text, size)[0] for text, _ in row.words)


def _height(row: TextRow) -> float:
    return ROW * max(1.0, row.size / SMALL * 0.92)

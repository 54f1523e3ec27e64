"""The read-out of the live score in the lower left corner of the 3D view: it draws stored text.

It is drawn clear of the toolbar and of the panel of the last operation; Blender's own text is at
the top.
"""

import textwrap
from collections.abc import Iterator
from typing import NamedTuple

import bpy

from ..panel_text import is_simple, plain, typeset
from ..processes import engine_process
from ..view import plates, viewport
from ..view.plates import Plate, PlateSize, Room
from ..view.viewport import FAINT, INK, PLATE, SMALL, PlateBox, Rgba
from .readout_text import BETTER, WORSE, ReadoutLine, TextPiece, readout_of, state_of
from .shown import MOVING, PENDING, ShownScore, for_drawing
from .state import live_state

LARGE = 17.0
"""Size of the headline, in pixels of an interface at scale 1; so are all lengths below."""
ROW = 17.0
PAD = 10.0
ZONE_ROWS = 2
"""Rows that are reserved for zones while something moves, so that the plate does not jump."""
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


def register() -> None:
    """Start drawing."""
    plates.show(PLATE_NAME, plates_of)


def unregister() -> None:
    """Stop drawing."""
    plates.hide(PLATE_NAME)
    viewport.redraw_editors()


def plates_of(context: bpy.types.Context, room: Room) -> Iterator[Plate]:
    """Yield the read-out, if the view shows overlays; folded, it is the score and its change."""
    space = context.space_data
    scene = context.scene
    overlays = space is None or space.type != "VIEW_3D" or space.overlay.show_overlays
    if not (scene.perception_entropy.live.on and overlays and viewport.is_lower_left(context)):
        return
    shown = for_drawing(scene)
    is_late = engine_process.busy(engine_process.OVERLAY)
    rows = rows_of(shown, live_state(scene.name).note, view_outdated=is_late)
    if is_simple(scene):
        rows = [row._replace(words=tuple((plain(t), c) for t, c in row.words)) for row in rows]
    yield plate_of(rows, room)


def plate_of(rows: list[TextRow], room: Room) -> Plate:
    """Return the plate of rows, and of the first one where it is folded."""
    scale = room.scale
    share = MAX_SHARE * (room.width + viewport.MARGIN * scale)
    widest = min(max(MIN_WIDTH * scale, share), room.width - 2.0 * PAD * scale)
    whole = wrapped(rows, widest, scale)
    folded = wrapped(rows[:1], widest, scale)
    sizes = (size_of(whole, MIN_WIDTH, scale), size_of(folded, 0.0, scale))

    def draw(box: PlateBox, step: int) -> None:
        draw_rows((whole, folded)[step], box, scale)

    return Plate(plates.READOUT, sizes, draw)


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
    is_still = shown.pair is None or shown.phase not in (MOVING, PENDING)
    reserved = () if is_still else ((TextPiece(""),),) * lacking
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


def size_of(rows: list[TextRow], least: float, scale: float) -> PlateSize:
    """Return the size of the plate of rows that is so wide at least, at a scale of 1 [px]."""
    width = max(least * scale, *(_width(row, scale) for row in rows))
    height = sum(_height(row) for row in rows) * scale
    return PlateSize(width + 2.0 * PAD * scale, height + 2.0 * PAD * scale)


def draw_rows(rows: list[TextRow], box: PlateBox, scale: float) -> None:
    """Draw rows on a dark plate."""
    left, _, _, top = box
    viewport.fill_box(box, PLATE)
    y = top - PAD * scale
    for row in rows:
        y -= _height(row) * scale
        x = left + PAD * scale
        size = row.size * scale
        for text, color in row.words:
            x += viewport.draw_text(text, x, y + 0.3 * size, size, color=color) + row.gap * size


def _width(row: TextRow, scale: float) -> float:
    size = row.size * scale
    gaps = (len(row.words) - 1) * row.gap * size
    return gaps + sum(viewport.text_size(text, size)[0] for text, _ in row.words)


def _height(row: TextRow) -> float:
    return ROW * max(1.0, row.size / SMALL * 0.92)

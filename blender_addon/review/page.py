"""Where the words stand: headline and legend above, the table of sensors below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..engine import graphics, kinds
from .camera import DESIGN_HEIGHT, Frame
from .caption import Caption
from .lettering import FAINT_INK, Lettering
from .marks import GHOST

if TYPE_CHECKING:
    from ..engine import pe

MARGIN, HEAD_HEIGHT = 44, 120
HEADLINE, HEADLINE_Y, DETAIL_Y = 34, 62, 95
TEXT, ROW, STRIP_PADDING = 18, 27, 30
COLUMNS = (0, 200, 400, 600, 690, 780, 1180)
LETTER_WIDTH = 0.47
"""Mean width of a letter, in its size."""
STRIP: graphics.Rgba = (1.0, 1.0, 1.0, 1.0)

Legend = list[tuple[str, graphics.Rgba, str]]


def frame_of(rows: int, size: tuple[int, int]) -> Frame:
    """Return the picture's part left to the subject, above a table of that many rows."""
    scale = size[1] / DESIGN_HEIGHT
    bottom = size[1] - scale * (_strip_height(rows) + 10)
    return Frame(*size, scale * MARGIN, size[0] - scale * MARGIN, scale * HEAD_HEIGHT, bottom)


def legend_of(rig: pe.Rig, *, stopped: bool, moved: bool) -> Legend:
    """Return text, colour and mark ("line" or "ring") of what is in the picture."""
    present = {sensor.kind for sensor in rig}
    entries: Legend = []
    for kind in kinds.KINDS.values():
        if kind.name in present:
            drawing = graphics.drawing_of(kind.name)
            entries.append(
                (drawing.look.legend or kind.label, drawing.color(graphics.PAPER), "line")
            )
            if drawing.beams and stopped:
                entries.append(("stopped by the vehicle", graphics.PAPER.stopped, "line"))
    if moved:
        entries.append(("where it started", GHOST, "ring"))
    return entries


def write_page(pen: Lettering, words: Caption, legend: Legend) -> None:
    """Write headline, legend and table."""
    scale = pen.view.frame.scale
    pen.write(words.headline, (scale * MARGIN, scale * HEADLINE_Y), scale * HEADLINE)
    pen.write(words.detail, (scale * MARGIN, scale * DETAIL_Y), scale * TEXT, FAINT_INK)
    _write_legend(pen, legend, scale)
    _write_table(pen, words.table, scale)


def _write_table(pen: Lettering, table: tuple[tuple[str, ...], ...], scale: float) -> None:
    frame = pen.view.frame
    top = frame.height - scale * _strip_height(len(table))
    pen.rectangle(0, top, frame.width, frame.height, STRIP)
    ends = (*COLUMNS[1:], frame.width / scale - 2 * MARGIN)
    for number, row in enumerate(table):
        y = top + scale * (STRIP_PADDING + number * ROW)
        ink = {"color": FAINT_INK} if number == 0 else {}
        for text, x, end in zip(row, COLUMNS, ends, strict=False):
            pen.write(_cut(text, end - x), (scale * (MARGIN + x), y), scale * TEXT, **ink)


def _write_legend(pen: Lettering, legend: Legend, scale: float) -> None:
    widest = max((len(text) for text, _, _ in legend), default=0)
    left = pen.view.frame.width - scale * (MARGIN + TEXT * LETTER_WIDTH * widest)
    for number, (text, color, mark) in enumerate(legend):
        y = scale * (56 + number * 26)
        pen.write(text, (left, y), scale * TEXT)
        middle, solid = y - scale * 6, (*color[:3], 1.0)
        if mark == "line":
            ends = (left - scale * 50, middle), (left - scale * 14, middle)
            pen.line(*ends, scale * 4, solid, layer=1)
        else:
            pen.ring((left - scale * 32, middle), scale * 6, solid, layer=1)


def _cut(text: str, width: float) -> str:
    """Return the text, or as much of it as fits a column that wide."""
    fits = int(width / (TEXT * LETTER_WIDTH)) - 1
    return text if len(text) <= fits else text[: fits - 1].rstrip() + "…"


def _strip_height(rows: int) -> float:
    return rows * ROW + STRIP_PADDING

"""Where the words stand: headline and legend above, the table of sensors below, names beside."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..overlay.colors import PAPER, Rgba
from .camera import Frame
from .caption import Caption
from .lettering import FAINT_INK, Lettering
from .stage import BACKGROUND

if TYPE_CHECKING:
    import pe_core as pe

DESIGN_WIDTH, DESIGN_HEIGHT = 1600, 900
MARGIN = 44
HEAD_HEIGHT = 120
ROW, TEXT, HEADLINE = 27, 18, 34
COLUMNS = (0, 190, 390, 590, 680, 770, 1150)
LABEL, LABEL_RISE, LABEL_STEP = 18, 46, 28
LETTER_WIDTH = 0.52
"""Mean width of a letter, in its size."""
STRIP = (1.0, 1.0, 1.0, 1.0)
GHOST: Rgba = (0.45, 0.47, 0.50, 0.55)


def strip_height(rows: int) -> float:
    """Height of the table's strip [px]."""
    return rows * ROW + 30


def frame_of(rows: int, size: tuple[int, int]) -> Frame:
    """Return the picture's part left to the subject, beside a table of that many rows."""
    scale = size[1] / DESIGN_HEIGHT
    bottom = size[1] - scale * (strip_height(rows) + 10)
    return Frame(*size, scale * MARGIN, size[0] - scale * MARGIN, scale * HEAD_HEIGHT, bottom)


def write_page(pen: Lettering, words: Caption, legend: list[tuple[str, Rgba, str]]) -> None:
    """Write everything but the names beside the sensors."""
    frame = pen.view.frame
    scale = frame.height / DESIGN_HEIGHT
    pen.write(words.headline, (scale * MARGIN, scale * 62), scale * HEADLINE)
    pen.write(words.detail, (scale * MARGIN, scale * 95), scale * TEXT, FAINT_INK)
    top = frame.height - scale * strip_height(len(words.table))
    pen.rectangle(0, top, frame.width, frame.height, STRIP)
    for number, row in enumerate(words.table):
        y = top + scale * (30 + number * ROW)
        ink = {"color": FAINT_INK} if number == 0 else {}
        for text, x in zip(row, COLUMNS, strict=False):
            pen.write(text, (scale * (MARGIN + x), y), scale * TEXT, **ink)
    _write_legend(pen, legend, scale)


def _write_legend(pen: Lettering, legend: list[tuple[str, Rgba, str]], scale: float) -> None:
    right = pen.view.frame.width - scale * MARGIN
    widest = max((len(text) for text, _, _ in legend), default=0)
    left = right - scale * TEXT * LETTER_WIDTH * widest
    for number, (text, color, mark) in enumerate(legend):
        y = scale * (56 + number * 26)
        pen.write(text, (left, y), scale * TEXT)
        middle = y - scale * 6
        if mark == "line":
            box = (left - scale * 50, middle - scale * 2, left - scale * 14, middle + scale * 2)
            pen.rectangle(*box, (*color[:3], 1.0))
        else:
            pen.disc((left - scale * 32, middle), scale * 6, (*color[:3], 1.0))


def legend_of(rig: pe.Rig, *, stopped: bool, moved: bool) -> list[tuple[str, Rgba, str]]:
    """Return text, colour and mark of what is in the picture."""
    kinds = {sensor.kind for sensor in rig}
    entries = []
    if "lidar" in kinds:
        entries.append(("LiDAR beam", PAPER.free, "line"))
    if stopped:
        entries.append(("stopped by the vehicle", PAPER.stopped, "line"))
    if "camera" in kinds:
        entries.append(("camera view", PAPER.camera, "line"))
    if moved:
        entries.append(("placement at the start", GHOST, "disc"))
    return entries


def write_names(pen: Lettering, rig: pe.Rig) -> None:
    """Write each sensor's name above it, on a plate, with a line down to it."""
    scale = pen.view.frame.height / DESIGN_HEIGHT
    places = pen.view.pixels(np.array([sensor.pose.position for sensor in rig]))
    taken: list[tuple[float, float, float]] = []
    for (x, y), name in sorted(zip(places.tolist(), [s.name for s in rig], strict=True)):
        half = scale * LABEL * LETTER_WIDTH * len(name) / 2 + scale * 6
        up = y - scale * LABEL_RISE
        while any(abs(x - a) < half + b and abs(up - c) < scale * LABEL_STEP for a, b, c in taken):
            up -= scale * 4
        taken.append((x, half, up))
        pen.rectangle(x - scale * 0.7, up, x + scale * 0.7, y, FAINT_INK)
        pen.rectangle(x - half, up - scale * 18, x + half, up + scale * 6, (*BACKGROUND, 1.0))
        pen.write(name, (x, up), scale * LABEL, align="CENTER")

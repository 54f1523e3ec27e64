"""The read-out in the lower left corner of the 3D view: words that are ready, nothing worked out.

It stands clear of the toolbar, of Blender's own text, which is at the top, and above the panel of
the last operation, for which a row is always left, so that it does not jump with every move.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import NamedTuple

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from .. import changes, corners, redraw, worker
from . import background, latest
from .figure_words import anchor_line, figure_lines
from .shown import ShownScore, shown_score
from .words import BETTER, WORSE, words_of

VIEW = bpy.types.SpaceView3D
FONT = 0
LARGE, SMALL = 17.0, 11.0
"""Sizes of letters, in pixels of an interface at scale 1; so are all lengths below."""
ROW, PAD, MARGIN, HUD_ROW = 17.0, 10.0, 14.0, 30.0
ZONE_ROWS = 2
"""Rows that are kept for zones, so that the plate does not jump with every move."""
LEAST_WIDTH, MOST_COLUMNS = 236.0, 64
Color = tuple[float, float, float, float]
INK: Color = (0.95, 0.95, 0.95, 1.0)
FAINT: Color = (0.74, 0.74, 0.74, 1.0)
ALERT: Color = (1.0, 0.84, 0.35, 1.0)
PLATE: Color = (0.08, 0.08, 0.08, 0.72)
BY_SENSE = {BETTER: (0.42, 0.75, 1.0, 1.0), WORSE: (1.0, 0.62, 0.25, 1.0)}
"""Blue is better, orange worse: told apart by colour-blind eyes too, and the arrow says it."""
ARROWS = {BETTER: "\N{DOWNWARDS ARROW}", WORSE: "\N{UPWARDS ARROW}"}


PLATE_NAME = "live"
"""Of the read-out, among the plates in the corners of a view."""
PICTURE = "overlay "
"""How topics of work begin whose answers are what the 3D view shows of sensors."""


class TextRow(NamedTuple):
    """Words in a row: what, how large, in which colours."""

    size: float
    words: tuple[tuple[str, Color], ...]


_handles: list[object] = []


def register() -> None:
    """Start drawing."""
    if not _handles:
        _handles.append(VIEW.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL"))
        changes.reading.connect(redraw.editors)


def unregister() -> None:
    """Stop drawing."""
    while _handles:
        changes.reading.disconnect(redraw.editors)
        VIEW.draw_handler_remove(_handles.pop(), "WINDOW")
    corners.forget(PLATE_NAME)
    redraw.editors()


def draw() -> None:
    """Draw into the current 3D view, if it shows overlays; Blender calls this at each redraw."""
    context = bpy.context
    space = context.space_data
    wanted = space is None or space.type != "VIEW_3D" or space.overlay.show_overlays
    box = None
    if context.scene.perception_entropy.live.on and wanted and _is_corner(context):
        name = context.scene.name
        score = shown_score(context.scene)
        if score is not None and score.exact and worker.desk.awaits(PICTURE):
            score = score._replace(picture_follows=True)
        reading = latest.reading(name)
        below = [] if reading is None else below_of(name, reading, score)
        lines = lines_of(reading, latest.note(name), score, below)
        box = draw_lines(lines, *_place(context), context.preferences.system.ui_scale)
    corners.reserve(context.region.as_pointer(), PLATE_NAME, box)


def below_of(scene_name: str, reading: latest.Reading, score: ShownScore | None) -> list[TextRow]:
    """Rows of key figures and of a known rig, faint where they are of before a move."""
    figures = background.figures_of(scene_name, reading, score is not None and score.exact)
    anchor = background.anchor_of(scene_name)
    rows = []
    if figures is not None:
        color = INK if figures.current else FAINT
        rows += [TextRow(SMALL, ((text, color),)) for text in figure_lines(figures)]
    if anchor is not None:
        rows.append(TextRow(SMALL, ((anchor_line(anchor, reading.glance), FAINT),)))
    return rows


def lines_of(
    reading: latest.Reading | None,
    note: str,
    score: ShownScore | None,
    below: Sequence[TextRow] = (),
) -> list[TextRow]:
    """Lines from the top down: what is shown of a reading, rows `below` it, what is in the way."""
    found = [] if reading is None or score is None else _lines_of_words(reading, score, below)
    if note:
        found += [TextRow(SMALL, ((row, ALERT),)) for row in textwrap.wrap(note, MOST_COLUMNS)]
    return found or [TextRow(SMALL, (("Live: scoring ...", FAINT),))]


def _lines_of_words(
    reading: latest.Reading, score: ShownScore, below: Sequence[TextRow]
) -> list[TextRow]:
    words = words_of(reading, score)
    arrow, color = ARROWS.get(words.sense, ""), BY_SENSE.get(words.sense, FAINT)
    change = ((f"{arrow} {words.change}".strip(), color),) if words.change else ()
    kept = () if reading.before is None else ("",) * (ZONE_ROWS + 1 - len(words.lines))
    seen, *zones = (TextRow(SMALL, ((text, INK),)) for text in (*words.lines, *kept))
    return [
        TextRow(LARGE, ((words.headline, INK), *change)),
        TextRow(SMALL, tuple((text, FAINT) for text in (words.error, words.against) if text)),
        seen,
        *(row for row in below if row.words[0][0]),
        *zones,
    ]


def draw_lines(lines: list[TextRow], left: float, bottom: float, scale: float) -> corners.Box:
    """Draw lines on a dark plate whose lower left corner is given [px]; return its box."""
    width = max(LEAST_WIDTH * scale, *(_width(line, scale) for line in lines))
    height = sum(_height(line) for line in lines) * scale
    pad = PAD * scale
    _fill(left, bottom, left + width + 2.0 * pad, bottom + height + 2.0 * pad)
    y = bottom + pad + height
    for line in lines:
        y -= _height(line) * scale
        _write(line, left + pad, y + 0.3 * line.size * scale, scale)
    return left, bottom, left + width + 2.0 * pad, bottom + height + 2.0 * pad


def _write(line: TextRow, x: float, y: float, scale: float) -> None:
    blf.size(FONT, line.size * scale)
    for text, color in line.words:
        blf.color(FONT, *color)
        blf.position(FONT, round(x), round(y), 0.0)
        blf.draw(FONT, text)
        x += blf.dimensions(FONT, text)[0] + line.size * scale


def _width(line: TextRow, scale: float) -> float:
    blf.size(FONT, line.size * scale)
    gaps = (len(line.words) - 1) * line.size * scale
    return gaps + sum(blf.dimensions(FONT, text)[0] for text, _ in line.words)


def _height(line: TextRow) -> float:
    return ROW * max(1.0, line.size / SMALL * 0.92)


def _fill(left: float, bottom: float, right: float, top: float) -> None:
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    corners = ((left, bottom, 0.0), (right, bottom, 0.0), (right, top, 0.0), (left, top, 0.0))
    before = gpu.state.blend_get()
    gpu.state.blend_set("ALPHA")
    shader.uniform_float("color", PLATE)
    batch_for_shader(shader, "TRI_FAN", {"pos": corners}).draw(shader)
    gpu.state.blend_set(before)


def _place(context: bpy.types.Context) -> tuple[float, float]:
    """Lower left corner of the plate in the region [px]."""
    scale, region = context.preferences.system.ui_scale, context.region
    left, bottom = 0.0, HUD_ROW * scale
    for each in context.area.regions:
        if each.type == "TOOLS" and each.x < region.x + region.width / 2:
            left = max(left, each.x + each.width - region.x)
        elif each.type == "HUD" and each.height > 1:
            bottom = max(bottom, each.y + each.height - region.y)
    return left + MARGIN * scale, bottom + MARGIN * scale / 2.0


def _is_corner(context: bpy.types.Context) -> bool:
    """Whether the region is the lower left one of its area: of four in a quad view, one."""
    windows = [each for each in context.area.regions if each.type == "WINDOW"]
    return context.region == min(windows, key=lambda each: (each.y, each.x))

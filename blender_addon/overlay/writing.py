"""Words over the 3D view: labels where things are, legends in a corner."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence

import blf
import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader

from .. import corners
from ..engine import graphics
from .batches import shader

FONT = 0
SIZE, STRONG_SIZE = 11.0, 12.5
RISE, PADDING = 10.0, 4.0
MARGIN, GAP = 16.0, 12.0
GIZMOS = 330.0
"""Room for Blender's own gizmos, from the top."""
BESIDE_GIZMOS = 48.0
"""What they take from the right, where a legend is as high up as they are."""
LEAST_WIDTH, BAR, ROW = 150.0, 10.0, 17.0
INK: graphics.Rgba = (0.92, 0.92, 0.92, 1.0)
FAINT_INK: graphics.Rgba = (0.72, 0.72, 0.72, 1.0)
PLATE: graphics.Rgba = (0.10, 0.10, 0.10, 0.78)
LABEL_PLATE: graphics.Rgba = (0.08, 0.08, 0.08, 0.55)

_square: list[gpu.types.GPUBatch] = []
_bars: dict[tuple[graphics.Rgba, ...], gpu.types.GPUBatch] = {}
"""Uploaded once, in the unit square, and drawn at any place and size."""


def write_labels(context: bpy.types.Context, labels: Sequence[graphics.Tag]) -> None:
    """Write labels above their places, but those that would cover another one or a plate."""
    scale, taken = _scale(), list(corners.boxes(context.region.as_pointer()))
    for label in sorted(labels, key=lambda each: not each.strong):
        place = location_3d_to_region_2d(context.region, context.region_data, label.place)
        if place is None:
            continue
        blf.size(FONT, (STRONG_SIZE if label.strong else SIZE) * scale)
        width, height = blf.dimensions(FONT, label.text)
        x, y = place.x - width / 2.0, place.y + RISE * scale
        pad = PADDING * scale
        box = (x - pad, y - pad, x + width + pad, y + height + pad)
        if any(_overlap(box, other) for other in taken):
            continue
        taken.append(box)
        _fill(box, LABEL_PLATE)
        _text(label.text, x, y, label.color)


def write_legends(context: bpy.types.Context, legends: Sequence[graphics.ColorKey]) -> None:
    """Write legends one above the other in the lower right corner, beside the sidebar.

    Where the view is too narrow for them beside the read-out, they stand above it.
    """
    scale = _scale()
    if _is_a_side_view(context):
        return
    right = context.region.width - _sidebar_width(context) - MARGIN * scale
    blf.size(FONT, SIZE * scale)
    width = max((_width(legend, scale) for legend in legends), default=0.0)
    region, sides = context.region.as_pointer(), (right - width, right)
    bottom = corners.bottom_above(region, sides, MARGIN * scale, GAP * scale / 2.0)
    room = context.region.height - GIZMOS * scale - (bottom - MARGIN * scale)
    if legends and room < _height(legends[0], scale):
        sides = (sides[0] - BESIDE_GIZMOS * scale, sides[1] - BESIDE_GIZMOS * scale)
    fitting = _fitting(legends, room, scale)
    for legend in reversed(fitting):
        bottom = _legend(legend, sides, bottom, scale) + GAP * scale / 2.0


def _fitting(
    legends: Sequence[graphics.ColorKey], height: float, scale: float
) -> list[graphics.ColorKey]:
    """As many of the first legends as there is room for, one at least."""
    found: list[graphics.ColorKey] = []
    for legend in legends:
        height -= _height(legend, scale) + GAP * scale / 2.0
        if height >= 0.0 or not found:
            found.append(legend)
    return found


def _height(legend: graphics.ColorKey, scale: float) -> float:
    rows = len(legend.classes) + (2 if legend.scale else 0)
    return (rows + 1) * ROW * scale + PADDING * 2.0 * scale


def _width(legend: graphics.ColorKey, scale: float) -> float:
    """How wide a legend has to be for its words."""
    names = [blf.dimensions(FONT, name)[0] + 2.2 * BAR * scale for _, name in legend.classes]
    widest = max([blf.dimensions(FONT, legend.title)[0], *names])
    return max(LEAST_WIDTH * scale, widest + PADDING * 4.0 * scale)


def _legend(
    legend: graphics.ColorKey, sides: tuple[float, float], bottom: float, scale: float
) -> float:
    """Write one legend between its sides, standing there; return its upper edge."""
    top = bottom + _height(legend, scale)
    pad, (left, right) = PADDING * 2.0 * scale, sides
    _fill((left, bottom, right, top), PLATE)
    blf.size(FONT, SIZE * scale)
    y = top - pad - (ROW - 5.0) * scale
    _text(legend.title, left + pad, y, INK)
    if legend.scale:
        y -= ROW * scale
        _bar(legend.scale, left + pad, y, right - pad, y + BAR * scale)
        y -= ROW * scale
        _ticks(legend.ticks, left + pad, right - pad, y + 3.0 * scale)
    for color, name in legend.classes:
        y -= ROW * scale
        _fill((left + pad, y, left + pad + 1.4 * BAR * scale, y + BAR * scale), color)
        _text(name, left + pad + 2.2 * BAR * scale, y + 1.0 * scale, INK)
    return top


def _bar(
    colors: Sequence[graphics.Rgba], left: float, bottom: float, right: float, top: float
) -> None:
    """A row of colours that run into each other."""
    smooth, row = shader("SMOOTH_COLOR"), tuple(colors)
    if row not in _bars:
        corners = [(i / (len(row) - 1), y, 0.0) for i in range(len(row)) for y in (0.0, 1.0)]
        shades = [color for color in row for _ in range(2)]
        _bars[row] = batch_for_shader(smooth, "TRI_STRIP", {"pos": corners, "color": shades})
    with _blended(), _in_box((left, bottom, right, top)):
        _bars[row].draw(smooth)


def _ticks(ticks: Sequence[str], left: float, right: float, y: float) -> None:
    """Words evenly below a bar, the outer ones within its ends."""
    for number, tick in enumerate(ticks):
        share = number / max(len(ticks) - 1, 1)
        width = blf.dimensions(FONT, tick)[0]
        _text(tick, left + share * (right - left - width), y, FAINT_INK)


def _text(text: str, x: float, y: float, color: graphics.Rgba) -> None:
    blf.color(FONT, *color)
    blf.position(FONT, round(x), round(y), 0.0)
    blf.draw(FONT, text)


def _fill(box: tuple[float, float, float, float], color: graphics.Rgba) -> None:
    plain = shader("UNIFORM_COLOR")
    if not _square:
        corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0))
        _square.append(batch_for_shader(plain, "TRI_FAN", {"pos": corners}))
    plain.uniform_float("color", color)
    with _blended(), _in_box(box):
        _square[0].draw(plain)


@contextlib.contextmanager
def _in_box(box: tuple[float, float, float, float]) -> Iterator[None]:
    """Have what is drawn within the unit square fill a box [px], within."""
    left, bottom, right, top = box
    with gpu.matrix.push_pop():
        gpu.matrix.translate((left, bottom, 0.0))
        gpu.matrix.scale((right - left, top - bottom, 1.0))
        yield


def forget() -> None:
    """Leave nothing on the graphics card."""
    _square.clear()
    _bars.clear()


class _blended:
    """Colours mixed with what is there, within."""

    def __enter__(self) -> None:
        self._before = gpu.state.blend_get()
        gpu.state.blend_set("ALPHA")

    def __exit__(self, *_: object) -> None:
        gpu.state.blend_set(self._before)


def _is_a_side_view(context: bpy.types.Context) -> bool:
    """Whether a view is one of four, and not the one that can be turned."""
    space = context.space_data
    return bool(len(space.region_quadviews)) and context.region_data != space.region_3d


def _overlap(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _scale() -> float:
    return bpy.context.preferences.system.ui_scale


def _sidebar_width(context: bpy.types.Context) -> float:
    """How much of the region's right is under the sidebar."""
    if not context.preferences.system.use_region_overlap:
        return 0.0
    return max((r.width for r in context.area.regions if r.type == "UI" and r.width > 1), default=0)

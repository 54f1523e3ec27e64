"""Text of the overlay: labels at positions in the 3D view, legends in its lower right corner."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d

from .. import viewport
from ..engine import graphics
from ..viewport import SMALL, PlateBox

STRONG_SIZE = 12.5
RISE, PADDING = 10.0, 4.0
MARGIN, GAP = 16.0, 12.0
GIZMOS = 330.0
"""Room for Blender's own gizmos, from the top."""
BESIDE_GIZMOS = 48.0
"""What they take from the right, where a legend is as high up as they are."""
MIN_WIDTH, BAR, ROW = 150.0, 10.0, 17.0
INK: graphics.Rgba = (0.92, 0.92, 0.92, 1.0)
FAINT_INK: graphics.Rgba = (0.72, 0.72, 0.72, 1.0)
PLATE: graphics.Rgba = (0.10, 0.10, 0.10, 0.78)
LABEL_PLATE: graphics.Rgba = (0.08, 0.08, 0.08, 0.55)


def draw_labels(context: bpy.types.Context, labels: Sequence[graphics.Tag]) -> None:
    """Draw labels above their positions, without those that would cover a label or a plate."""
    scale, taken = viewport.ui_scale(), list(viewport.plate_boxes(context.region.as_pointer()))
    pad = PADDING * scale
    for label in sorted(labels, key=lambda tag: not tag.strong):
        place = location_3d_to_region_2d(context.region, context.region_data, label.place)
        if place is None:
            continue
        size = (STRONG_SIZE if label.strong else SMALL) * scale
        width, height = viewport.text_size(label.text, size)
        x, y = place.x - width / 2.0, place.y + RISE * scale
        box = (x - pad, y - pad, x + width + pad, y + height + pad)
        if any(graphics.boxes_overlap(box, other) for other in taken):
            continue
        taken.append(box)
        viewport.fill_box(box, LABEL_PLATE)
        viewport.draw_text(label.text, x, y, size, label.color)


def draw_legends(context: bpy.types.Context, legends: Sequence[graphics.ColorKey]) -> None:
    """Draw legends one above the other in the lower right corner, beside the sidebar.

    Where the view is too narrow for them beside the read-out, they are put above it.
    """
    scale = viewport.ui_scale()
    if _is_fixed_quad_view(context):
        return
    right = context.region.width - _sidebar_width(context) - MARGIN * scale
    width = max((_width(legend, scale) for legend in legends), default=0.0)
    region, sides = context.region.as_pointer(), (right - width, right)
    bottom = viewport.free_bottom(region, sides, MARGIN * scale, GAP * scale / 2.0)
    room = context.region.height - GIZMOS * scale - (bottom - MARGIN * scale)
    if legends and room < _height(legends[0], scale):
        sides = (sides[0] - BESIDE_GIZMOS * scale, sides[1] - BESIDE_GIZMOS * scale)
    for legend in reversed(_fitting(legends, room, scale)):
        top = bottom + _height(legend, scale)
        _draw_legend(legend, (sides[0], bottom, sides[1], top), scale)
        bottom = top + GAP * scale / 2.0


def _fitting(
    legends: Sequence[graphics.ColorKey], height: float, scale: float
) -> list[graphics.ColorKey]:
    """Return as many of the first legends as there is room for, at least one."""
    fitting: list[graphics.ColorKey] = []
    for legend in legends:
        height -= _height(legend, scale) + GAP * scale / 2.0
        if height >= 0.0 or not fitting:
            fitting.append(legend)
    return fitting


def _height(legend: graphics.ColorKey, scale: float) -> float:
    rows = len(legend.classes) + (2 if legend.scale else 0)
    return (rows + 1) * ROW * scale + PADDING * 2.0 * scale


def _width(legend: graphics.ColorKey, scale: float) -> float:
    """Return the width that a legend's text needs [px]."""
    size, swatch = SMALL * scale, 2.2 * BAR * scale
    names = [viewport.text_size(name, size)[0] + swatch for _, name in legend.classes]
    widest = max([viewport.text_size(legend.title, size)[0], *names])
    return max(MIN_WIDTH * scale, widest + PADDING * 4.0 * scale)


def _draw_legend(legend: graphics.ColorKey, box: PlateBox, scale: float) -> None:
    left, _, right, top = box
    pad, size = PADDING * 2.0 * scale, SMALL * scale
    viewport.fill_box(box, PLATE)
    y = top - pad - (ROW - 5.0) * scale
    viewport.draw_text(legend.title, left + pad, y, size, INK)
    if legend.scale:
        y -= ROW * scale
        viewport.fill_gradient((left + pad, y, right - pad, y + BAR * scale), legend.scale)
        y -= ROW * scale
        _draw_ticks(legend.ticks, (left + pad, right - pad), y + 3.0 * scale, size)
    for color, name in legend.classes:
        y -= ROW * scale
        viewport.fill_box((left + pad, y, left + pad + 1.4 * BAR * scale, y + BAR * scale), color)
        viewport.draw_text(name, left + pad + 2.2 * BAR * scale, y + 1.0 * scale, size, INK)


def _draw_ticks(ticks: Sequence[str], sides: tuple[float, float], y: float, size: float) -> None:
    """Draw evenly spaced texts below a gradient, none beyond its ends."""
    left, right = sides
    for number, tick in enumerate(ticks):
        share = number / max(len(ticks) - 1, 1)
        x = left + share * (right - left)
        viewport.draw_text(tick, x, y, size, FAINT_INK, left_of_x=share)


def _is_fixed_quad_view(context: bpy.types.Context) -> bool:
    """Whether a view is one of four, and not the one that can be turned."""
    space = context.space_data
    return bool(len(space.region_quadviews)) and context.region_data != space.region_3d


def _sidebar_width(context: bpy.types.Context) -> float:
    """Return the width of the region's right part below the sidebar [px]."""
    if not context.preferences.system.use_region_overlap:
        return 0.0
    return max((r.width for r in context.area.regions if r.type == "UI" and r.width > 1), default=0)

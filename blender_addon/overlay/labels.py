"""Text of the overlay: labels at positions in the 3D view, and legends."""

from collections.abc import Sequence

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d

from ..engine import graphics
from ..view import plates, viewport
from ..view.plates import Plate, PlateSize, Room
from ..view.viewport import FAINT, INK, PLATE, SMALL, PlateBox

STRONG_SIZE = 12.5
RISE = 10.0
PADDING = 4.0
MIN_WIDTH = 150.0
TITLE_ROWS = 1.5  # Height of a plate that is folded into its title
BAR = 10.0
ROW = 17.0
VALUES = 0.8
"""Size of the values below a scale, as a share of its words."""


def draw_labels(
    context: bpy.types.Context, labels: Sequence[graphics.Tag], taken: Sequence[PlateBox]
) -> None:
    """Draw labels above their positions, beside the toolbar, without those that would cover a label
    or a box that is taken."""
    scale = viewport.ui_scale()
    left = viewport.toolbar_right(context)
    taken = list(taken)
    pad = PADDING * scale
    for label in sorted(labels, key=lambda tag: not tag.strong):
        place = location_3d_to_region_2d(context.region, context.region_data, label.place)
        if place is None or place.x < 0.0:
            continue
        size = (STRONG_SIZE if label.strong else SMALL) * scale
        lines = label.text.split("\n")
        extents = [viewport.text_size(line, size) for line in lines]
        width = max(extent[0] for extent in extents)
        row = 1.35 * size
        x = max(place.x - width / 2.0, left + pad)
        y = place.y + RISE * scale
        height = extents[0][1] + row * (len(lines) - 1)
        for _ in lines:  # a label of several lines is lifted over what it would cover
            box = (x - pad, y - pad, x + width + pad, y + height + pad)
            over = [each for each in taken if graphics.boxes_overlap(box, each)]
            if not over or len(lines) == 1:
                break
            y = max(each[3] for each in over) + pad + 1.0
        if over:
            continue
        taken.append(box)
        viewport.fill_box(box, PLATE)
        for number, line in enumerate(reversed(lines)):
            viewport.draw_text(line, x, y + number * row, size, color=label.color)


def legend_plates(legends: Sequence[graphics.ColorKey], room: Room) -> list[Plate]:
    """Return the plates of legends, as wide as the widest; folded, they are their titles."""
    scale = room.scale
    width = max((_width(legend, scale) for legend in legends), default=0.0)
    return [_legend_plate(legend, width, scale) for legend in legends]


def _legend_plate(legend: graphics.ColorKey, width: float, scale: float) -> Plate:
    title = graphics.ColorKey(legend.title)
    sizes = (
        PlateSize(width, _height(legend, scale)),
        PlateSize(_width(title, scale, least=0.0), TITLE_ROWS * ROW * scale),
    )

    def draw(box: PlateBox, step: int) -> None:
        _draw_legend((legend, title)[step], box, scale)

    return Plate(plates.LEGEND, sizes, draw)


def _height(legend: graphics.ColorKey, scale: float) -> float:
    rows = len(legend.classes) + (2 if legend.scale else 0) + (VALUES if legend.values else 0.0)
    return (rows + 1) * ROW * scale + PADDING * 2.0 * scale


def _width(legend: graphics.ColorKey, scale: float, least: float = MIN_WIDTH) -> float:
    """Return the width that a legend's text needs [px]."""
    size = SMALL * scale
    swatch = 2.2 * BAR * scale
    names = [viewport.text_size(name, size)[0] + swatch for _, name in legend.classes]
    widest = max([viewport.text_size(legend.title, size)[0], *names])
    return max(least * scale, widest + PADDING * 4.0 * scale)


def _draw_legend(legend: graphics.ColorKey, box: PlateBox, scale: float) -> None:
    left, _, right, top = box
    pad = PADDING * 2.0 * scale
    size = SMALL * scale
    viewport.fill_box(box, PLATE)
    y = top - pad - (ROW - 5.0) * scale
    viewport.draw_text(legend.title, left + pad, y, size, color=INK)
    if legend.scale:
        y -= ROW * scale
        viewport.fill_gradient((left + pad, y, right - pad, y + BAR * scale), legend.scale)
        y -= ROW * scale
        _draw_ticks(legend.ticks, (left + pad, right - pad), y + 3.0 * scale, size)
        if legend.values:
            y -= VALUES * ROW * scale
            _draw_ticks(legend.values, (left + pad, right - pad), y + 3.0 * scale, VALUES * size)
    for color, name in legend.classes:
        y -= ROW * scale
        viewport.fill_box((left + pad, y, left + pad + 1.4 * BAR * scale, y + BAR * scale), color)
        viewport.draw_text(name, left + pad + 2.2 * BAR * scale, y + 1.0 * scale, size, color=INK)


def _draw_ticks(ticks: Sequence[str], sides: tuple[float, float], y: float, size: float) -> None:
    """Draw evenly spaced texts below a gradient, none beyond its ends."""
    left, right = sides
    for number, tick in enumerate(ticks):
        share = number / max(len(ticks) - 1, 1)
        x = left + share * (right - left)
        viewport.draw_text(tick, x, y, size, color=FAINT, left_of_x=share)

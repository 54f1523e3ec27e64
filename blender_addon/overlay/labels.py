"""Text of the overlay: labels at positions in the 3D view, and legends beside the vehicle."""

from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

from .. import viewport
from ..engine import Floats, graphics
from ..viewport import SMALL, PlateBox

STRONG_SIZE = 12.5
RISE = 10.0
PADDING = 4.0
MARGIN = 16.0
GAP = 12.0
GIZMOS = 330.0
BESIDE_GIZMOS = 48.0
"""Height and width of Blender's own gizmos, from the upper right corner."""
MIN_WIDTH = 150.0
MAX_SHARE = 0.25  # Of the view that plates cover at most
TITLE_ROWS = 1.5  # Height of a plate that is folded into its title
BAR = 10.0
ROW = 17.0
VALUES = 0.8
"""Size of the values below a scale, as a share of its words."""
INK: graphics.Rgba = (0.92, 0.92, 0.92, 1.0)
FAINT_INK: graphics.Rgba = (0.72, 0.72, 0.72, 1.0)
PLATE: graphics.Rgba = (0.10, 0.10, 0.10, 0.78)
LABEL_PLATE: graphics.Rgba = (0.08, 0.08, 0.08, 0.55)

CornerPair = tuple[Floats, Floats]  # Lowest and highest corner [m]


def draw_labels(
    context: bpy.types.Context, labels: Sequence[graphics.Tag], taken: Sequence[PlateBox] = ()
) -> None:
    """Draw labels above their positions, without those that would cover a label or a plate. `taken`
    are boxes that are covered beside the plates."""
    scale = viewport.ui_scale()
    taken = [*taken, *viewport.plate_boxes(context.region.as_pointer())]
    pad = PADDING * scale
    for label in sorted(labels, key=lambda tag: not tag.strong):
        place = location_3d_to_region_2d(context.region, context.region_data, label.place)
        if place is None:
            continue
        size = (STRONG_SIZE if label.strong else SMALL) * scale
        lines = label.text.split("\n")
        extents = [viewport.text_size(line, size) for line in lines]
        width = max(extent[0] for extent in extents)
        row = 1.35 * size
        x = place.x - width / 2.0
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
        viewport.fill_box(box, LABEL_PLATE)
        for number, line in enumerate(reversed(lines)):
            viewport.draw_text(line, x, y + number * row, size, color=label.color)


def draw_legends(
    context: bpy.types.Context, legends: Sequence[graphics.ColorKey], vehicle: CornerPair | None
) -> list[PlateBox]:
    """Draw legends: in the lower right corner, or where they cover no plate and not the vehicle.
    Return the boxes that are covered: those of the legends, and those of Blender's own."""
    scale = viewport.ui_scale()
    region = context.region
    space = context.space_data
    if len(space.region_quadviews) and context.region_data != space.region_3d:
        return []  # one of four views, and not the one that can be turned
    right = viewport.sidebar_left(context)
    height = float(region.height)
    blenders = [
        (right - BESIDE_GIZMOS * scale, height - GIZMOS * scale, right, height),
        (right, 0.0, float(region.width), height),
    ]
    margin = MARGIN * scale
    room = (
        viewport.beside_toolbar(context),
        margin,
        right - margin,
        height - viewport.HEADER * scale,
    )
    plates = viewport.plate_boxes(region.as_pointer())
    sizes = [(_width(legend, scale), _height(legend, scale)) for legend in legends]
    if sizes:
        widest = max(width for width, _ in sizes)
        sizes = [(widest, height) for _, height in sizes]
    boxes = folded(
        sizes,
        TITLE_ROWS * ROW * scale,
        Surroundings(room, [*blenders, *plates], _box_of(context, vehicle), GAP * scale / 2.0),
        MAX_SHARE * right * height - sum(map(_area, plates)),
    )
    for legend, placed in zip(legends, boxes, strict=True):
        if placed is not None:
            shown = graphics.ColorKey(legend.title) if placed.is_folded else legend
            _draw_legend(shown, placed.box, scale)
    return [*blenders, *(placed.box for placed in boxes if placed is not None)]


class PlacedPlate(NamedTuple):
    """Where a plate is drawn [px], and whether it is folded into its title."""

    box: PlateBox
    is_folded: bool


class Surroundings(NamedTuple):
    """What plates are arranged in [px]: the room, what is there, the vehicle, and the gap."""

    room: PlateBox
    taken: Sequence[PlateBox]
    vehicle: PlateBox | None
    gap: float


def folded(
    sizes: Sequence[tuple[float, float]], title: float, around: Surroundings, area: float
) -> list[PlacedPlate | None]:
    """Return where plates go: as `arranged`, but a plate that does not fit beside the vehicle folds
    into its title, `title` high; the last first, until all together cover no more than `area`
    [px²]. A title that fits nowhere beside the vehicle is left out."""
    heights = [height for _, height in sizes]
    is_folded = [False] * len(sizes)
    for last in range(len(sizes) - 1, -2, -1):
        now = [(width, height) for (width, _), height in zip(sizes, heights, strict=True)]
        boxes = arranged(now, around.room, around.taken, around.vehicle, gap=around.gap)
        covered = sum(_area(box) for box in boxes if box is not None)
        over = [box is None or _overlap(box, around.vehicle) > 0.0 for box in boxes]
        if last < 0 or (covered <= area and not any(over)):
            break
        heights[last] = title
        is_folded[last] = True
    return [
        None if box is None or is_over else PlacedPlate(box, is_title)
        for box, is_over, is_title in zip(boxes, over, is_folded, strict=True)
    ]


def _area(box: PlateBox) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def arranged(
    sizes: Sequence[tuple[float, float]],
    room: PlateBox,
    taken: Sequence[PlateBox],
    vehicle: PlateBox | None,
    gap: float,
) -> list[PlateBox | None]:
    """Return where plates of some sizes go; None for one that fits nowhere.

    Each covers none of the plates that are there and the least of the vehicle in the picture; of
    such places it takes one at the right edge, the lowest, then the one farthest left. Sizes are
    (width, height) [px], the most important plate first; `gap` is left free between plates.
    """
    left, bottom, right, top = room
    covered = list(taken)
    placed = []
    for width, height in sizes:
        corners = [*covered, *([] if vehicle is None else [vehicle])]
        across = {left, right - width, *(b[2] + gap for b in corners)}
        across |= {b[0] - gap - width for b in corners}
        up = {bottom, *(b[3] + gap for b in corners), *(b[1] - gap - height for b in corners)}
        found = [
            (x, y, x + width, y + height)
            for x in across
            for y in up
            if x >= left and y >= bottom and x + width <= right and y + height <= top
        ]
        free = [b for b in found if not any(graphics.boxes_overlap(b, each) for each in covered)]
        at_right = right - width
        box = min(
            free, key=lambda b: (_overlap(b, vehicle), b[0] != at_right, b[1], b[0]), default=None
        )
        placed.append(box)
        covered += [] if box is None else [box]
    return placed


def _overlap(box: PlateBox, vehicle: PlateBox | None) -> float:
    """Return how much of a box lies over the vehicle [px²]."""
    if vehicle is None:
        return 0.0
    width = min(box[2], vehicle[2]) - max(box[0], vehicle[0])
    height = min(box[3], vehicle[3]) - max(box[1], vehicle[1])
    return max(width, 0.0) * max(height, 0.0)


def _box_of(context: bpy.types.Context, vehicle: CornerPair | None) -> PlateBox | None:
    """Return the box of the vehicle in the view; None without one, or where the eye is in it."""
    if vehicle is None:
        return None
    ends = np.array(vehicle)
    corners = [(ends[i, 0], ends[j, 1], ends[k, 2]) for i, j, k in np.ndindex(2, 2, 2)]
    places = [
        location_3d_to_region_2d(context.region, context.region_data, corner) for corner in corners
    ]
    if any(place is None for place in places):
        return None
    x, y = zip(*((place.x, place.y) for place in places), strict=True)
    return min(x), min(y), max(x), max(y)


def _height(legend: graphics.ColorKey, scale: float) -> float:
    rows = len(legend.classes) + (2 if legend.scale else 0) + (VALUES if legend.values else 0.0)
    return (rows + 1) * ROW * scale + PADDING * 2.0 * scale


def _width(legend: graphics.ColorKey, scale: float) -> float:
    """Return the width that a legend's text needs [px]."""
    size = SMALL * scale
    swatch = 2.2 * BAR * scale
    names = [viewport.text_size(name, size)[0] + swatch for _, name in legend.classes]
    widest = max([viewport.text_size(legend.title, size)[0], *names])
    return max(MIN_WIDTH * scale, widest + PADDING * 4.0 * scale)


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
        viewport.draw_text(tick, x, y, size, color=FAINT_INK, left_of_x=share)

"""Two variants in one 3D view: the other one's ground left of a line, the scene's right of it."""

import contextlib
from collections.abc import Iterable, Iterator

import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d

from ..engine import graphics
from ..view import viewport
from .layers import OTHER_RIG

DROP = 130.0
"""Of the names beside the line, from the upper edge [px]."""


def line_px(context: bpy.types.Context) -> float:
    """Return where the line is in a view, from the left [px]."""
    left = viewport.beside_toolbar(context)
    right = viewport.sidebar_left(context)
    return round(left + context.scene.perception_entropy.view.wipe_at * (right - left))


@contextlib.contextmanager
def clipped(region: bpy.types.Region, line: float, name: str) -> Iterator[None]:
    """Draw what is of one variant, by the name of its shape, on its side of the line alone."""
    at = min(max(int(line), 0), region.width)
    sides = (0, at) if name == OTHER_RIG else (at, region.width - at)
    gpu.state.scissor_test_set(True)
    gpu.state.scissor_set(sides[0], 0, sides[1], region.height)
    try:
        yield
    finally:
        gpu.state.scissor_set(0, 0, region.width, region.height)
        gpu.state.scissor_test_set(False)


def on_side(
    context: bpy.types.Context, labels: Iterable[graphics.Tag], line: float, name: str
) -> list[graphics.Tag]:
    """Return the labels of a shape that are on its variant's side of the line."""
    found = []
    for label in labels:
        place = location_3d_to_region_2d(context.region, context.region_data, label.place)
        if place is not None and (place.x < line) == (name == OTHER_RIG):
            found.append(label)
    return found


def draw_line(
    context: bpy.types.Context, line: float, names: tuple[str, str]
) -> list[viewport.PlateBox]:
    """Draw the line, with the variant's name on its left and the scene's on its right; return the
    boxes of the names."""
    scale = viewport.ui_scale()
    height = context.region.height
    size = viewport.SMALL * scale
    gap = 8.0 * scale
    viewport.fill_box((line - scale, 0.0, line + scale, height), viewport.INK)
    boxes = []
    for text, share, end in zip(names, (1.0, 0.0), (line - gap, line + gap), strict=True):
        width, _ = viewport.text_size(text, size)
        left = end - share * width
        y = height - DROP * scale
        box = (left - gap / 2.0, y - gap / 2.0, left + width + gap / 2.0, y + size + gap / 2.0)
        boxes.append(box)
        viewport.fill_box(box, viewport.PLATE)
        viewport.draw_text(text, end, y, size, color=viewport.INK, left_of_x=share)
    return boxes

"""The curve of the search that runs, in the lower left corner of the 3D view.

It stands clear of the toolbar and of the panel of the last operation, and above the live score.
"""

from __future__ import annotations

from typing import NamedTuple

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from .. import corners, redraw
from .curve import SearchCurve, curve_of
from .latest import view

VIEW = bpy.types.SpaceView3D
FONT = 0
SMALL, TITLE = 11.0, 13.0
"""Sizes of letters, in pixels of an interface at scale 1; so are all lengths below."""
WIDTH, HEIGHT = 268.0, 148.0
PAD, LEFT, TOP, BOTTOM = 10.0, 36.0, 26.0, 18.0
"""Round the plate's inside, and what axes and title take of it."""
MARGIN, HUD_ROW = 14.0, 30.0
PLATE_NAME = "search"
"""Of the curve, among the plates in the corners of a view."""
LINE_PX, AXIS_PX, DOT_PX = 2.0, 1.0, 5.0
Color = tuple[float, float, float, float]
INK: Color = (0.95, 0.95, 0.95, 1.0)
FAINT: Color = (0.74, 0.74, 0.74, 1.0)
AXIS: Color = (0.55, 0.55, 0.55, 1.0)
LINE: Color = (0.45, 0.78, 0.96, 1.0)
PLATE: Color = (0.08, 0.08, 0.08, 0.72)


class PlotAxes(NamedTuple):
    """Where the axes are in the region [px]: lower left corner and size."""

    x: float
    y: float
    width: float
    height: float

    def at(self, across: float, up: float) -> tuple[float, float, float]:
        """Return a point of the unit square."""
        return self.x + across * self.width, self.y + up * self.height, 0.0


_handles: list[object] = []


def register() -> None:
    """Start drawing."""
    if not _handles:
        _handles.append(VIEW.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL"))


def unregister() -> None:
    """Stop drawing, and forget what was shown."""
    view.clear()
    while _handles:
        VIEW.draw_handler_remove(_handles.pop(), "WINDOW")
    corners.forget(PLATE_NAME)
    redraw.editors()


def draw() -> None:
    """Draw into the current 3D view; Blender calls this at each redraw."""
    context = bpy.context
    seen = view.get(context.scene.name)
    box = None
    if seen is not None and _is_corner(context):
        scale = context.preferences.system.ui_scale
        left, bottom = _corner(context)
        draw_curve(curve_of(seen), left, bottom, scale)
        box = left, bottom, left + WIDTH * scale, bottom + HEIGHT * scale
    corners.reserve(context.region.as_pointer(), PLATE_NAME, box)


def draw_curve(curve: SearchCurve, left: float, bottom: float, scale: float) -> None:
    """Draw a curve on a dark plate whose lower left corner is given [px]."""
    right, top = left + WIDTH * scale, bottom + HEIGHT * scale
    pad = PAD * scale
    axes = PlotAxes(
        left + pad + LEFT * scale,
        bottom + pad + BOTTOM * scale,
        WIDTH * scale - 2.0 * pad - LEFT * scale,
        HEIGHT * scale - 2.0 * pad - (TOP + BOTTOM) * scale,
    )
    before = gpu.state.blend_get()
    gpu.state.blend_set("ALPHA")
    _fill(((left, bottom, 0), (right, bottom, 0), (right, top, 0), (left, top, 0)), PLATE)
    _line([axes.at(0, 1), axes.at(0, 0), axes.at(1, 0)], AXIS, AXIS_PX * scale)
    _line([axes.at(*point) for point in curve.points], LINE, LINE_PX * scale)
    x, y, _ = axes.at(*curve.points[-1])
    half = DOT_PX * scale / 2.0
    corners = ((-half, -half), (half, -half), (half, half), (-half, half))
    _fill(tuple((x + a, y + b, 0) for a, b in corners), LINE)
    gpu.state.blend_set(before)
    _words(curve, axes, left + pad, top - pad, right - pad, scale)


def _words(
    curve: SearchCurve, axes: PlotAxes, left: float, top: float, right: float, scale: float
) -> None:
    """Write the title and what the axes say."""
    _write(curve.title, left, top - TITLE * scale, TITLE * scale, INK)
    _write(curve.aside, right, top - TITLE * scale, SMALL * scale, FAINT, 1.0)
    small, gap = SMALL * scale, 5.0 * scale
    _write(curve.high, axes.x - gap, axes.y + axes.height - 0.7 * small, small, FAINT, 1.0)
    _write(curve.low, axes.x - gap, axes.y, small, FAINT, 1.0)
    below = axes.y - small - gap
    _write("1", axes.x, below, small, FAINT)
    _write(curve.last, axes.x + axes.width, below, small, FAINT, 1.0)


def _write(text: str, x: float, y: float, size: float, color: Color, before: float = 0.0) -> None:
    """Write words; `before` is the share of them that lies left of x."""
    blf.size(FONT, size)
    blf.color(FONT, *color)
    blf.position(FONT, round(x - before * blf.dimensions(FONT, text)[0]), round(y), 0.0)
    blf.draw(FONT, text)


def _fill(corners: tuple[tuple[float, float, float], ...], color: Color) -> None:
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    shader.uniform_float("color", color)
    batch_for_shader(shader, "TRI_FAN", {"pos": corners}).draw(shader)


def _line(points: list[tuple[float, float, float]], color: Color, width_px: float) -> None:
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    batch = batch_for_shader(shader, "LINE_STRIP", {"pos": points})
    region = bpy.context.region
    shader.bind()
    shader.uniform_float("viewportSize", (region.width, region.height))
    shader.uniform_float("lineWidth", width_px)
    shader.uniform_float("color", color)
    batch.draw(shader)


def _corner(context: bpy.types.Context) -> tuple[float, float]:
    """Lower left corner of the plate in the region [px]."""
    scale, region = context.preferences.system.ui_scale, context.region
    left, bottom = 0.0, HUD_ROW * scale
    for each in context.area.regions:
        if each.type == "TOOLS" and each.x < region.x + region.width / 2:
            left = max(left, each.x + each.width - region.x)
        elif each.type == "HUD" and each.height > 1:
            bottom = max(bottom, each.y + each.height - region.y)
    left, bottom = left + MARGIN * scale, bottom + MARGIN * scale / 2.0
    sides, gap = (left, left + WIDTH * scale), MARGIN * scale / 2.0
    corners.reserve(region.as_pointer(), PLATE_NAME, None)
    return left, corners.bottom_above(region.as_pointer(), sides, bottom, gap)


def _is_corner(context: bpy.types.Context) -> bool:
    """Whether the region is the lower left one of its area: of four in a quad view, one."""
    windows = [each for each in context.area.regions if each.type == "WINDOW"]
    return context.region == min(windows, key=lambda each: (each.y, each.x))

"""What is seen of a sensor before it is placed: the one owner of its draw handles.

What is drawn is handed in as arrays and lines of text; drawing reads no scene and casts nothing.
"""

from __future__ import annotations

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from .. import redraw
from ..engine import graphics

VIEW = bpy.types.SpaceView3D
LINE_PX = 1.5
FONT, TEXT_PX, TEXT_GAP, PAD_PX = 0, 12, 1.5, 6
TEXT_AT = (26, -12)
"""Where text begins beside the mouse [px]."""
TEXT_COLOR, PLATE = (0.95, 0.95, 0.95, 1.0), (0.08, 0.08, 0.08, 0.78)


class Preview:
    """A sensor in the air: lines and faces in all 3D views, text in the one with the mouse."""

    def __init__(self) -> None:
        self._handles: list[object] = []
        self._lines = self._faces = graphics.Primitives.empty()
        self._text: tuple[str, ...] = ()
        self._mouse, self._region = (0, 0), 0

    def begin(self) -> None:
        """Start drawing."""
        if not self._handles:
            for function, when in ((self._draw, "POST_VIEW"), (self._write, "POST_PIXEL")):
                self._handles.append(VIEW.draw_handler_add(function, (), "WINDOW", when))

    def end(self) -> None:
        """Stop drawing; do nothing if it has ended."""
        while self._handles:
            VIEW.draw_handler_remove(self._handles.pop(), "WINDOW")

    def at(self, region: bpy.types.Region, mouse: tuple[int, int]) -> None:
        """Write beside the mouse, in that view."""
        self._mouse, self._region = mouse, region.as_pointer()

    def show(self, lines: graphics.Primitives, faces: graphics.Primitives) -> None:
        """Draw these from now on."""
        self._lines, self._faces = lines, faces

    def write(self, *text: str) -> None:
        """Write these lines from now on."""
        self._text = text

    def redraw(self) -> None:
        """Have every 3D view drawn anew."""
        redraw.editors()

    def _draw(self) -> None:
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("LESS_EQUAL")
        gpu.state.depth_mask_set(False)
        try:
            _draw_batch("SMOOTH_COLOR", "TRIS", self._faces)
            _draw_batch("POLYLINE_SMOOTH_COLOR", "LINES", self._lines)
        finally:
            gpu.state.depth_mask_set(True)
            gpu.state.depth_test_set("NONE")
            gpu.state.blend_set("NONE")

    def _write(self) -> None:
        region = bpy.context.region
        if region is None or region.as_pointer() != self._region:
            return
        scale = bpy.context.preferences.system.ui_scale
        blf.size(FONT, TEXT_PX * scale)
        row = TEXT_PX * scale * TEXT_GAP
        left, top = (at + off * scale for at, off in zip(self._mouse, TEXT_AT, strict=True))
        width = max((blf.dimensions(FONT, line)[0] for line in self._text), default=0.0)
        pad = PAD_PX * scale
        low = top - row * (len(self._text) - 1) - pad
        _fill((left - pad, low), (left + width + pad, top + row))
        blf.color(FONT, *TEXT_COLOR)
        for number, line in enumerate(self._text):
            blf.position(FONT, left, top - number * row, 0)
            blf.draw(FONT, line)


def _fill(low: tuple[float, float], high: tuple[float, float]) -> None:
    """Draw the plate that words stand on."""
    (x0, y0), (x1, y1) = low, high
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    corners = {"pos": ((x0, y0), (x1, y0), (x1, y1), (x0, y1))}
    plate = batch_for_shader(shader, "TRIS", corners, indices=((0, 1, 2), (0, 2, 3)))
    gpu.state.blend_set("ALPHA")
    shader.bind()
    shader.uniform_float("color", PLATE)
    plate.draw(shader)
    gpu.state.blend_set("NONE")


def _draw_batch(name: str, kind: str, primitives: graphics.Primitives) -> None:
    if not len(primitives.points):
        return
    shader = gpu.shader.from_builtin(name)
    if name.startswith("POLYLINE"):
        region = bpy.context.region
        shader.bind()
        shader.uniform_float("viewportSize", (region.width, region.height))
        width = LINE_PX * bpy.context.preferences.system.pixel_size
        shader.uniform_float("lineWidth", width)
    arrays = {"pos": primitives.points, "color": primitives.colors}
    batch_for_shader(shader, kind, arrays).draw(shader)

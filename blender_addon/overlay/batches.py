"""Shapes on the graphics card: uploaded once, drawn as often as the view is."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ..engine import graphics

THIN_PX = 1.0
EDGE_PX, EDGE = 2.0, (0.05, 0.05, 0.05, 0.35)

_shaders: dict[str, gpu.types.GPUShader] = {}


@dataclass(frozen=True, slots=True, eq=False)
class Batches:
    """What one shape became: triangles, lines, and a sheet."""

    shape: graphics.LayerShape
    lines: gpu.types.GPUBatch | None
    through: gpu.types.GPUBatch | None
    thin: gpu.types.GPUBatch | None
    faces: gpu.types.GPUBatch | None
    sheet: gpu.types.GPUBatch | None

    @classmethod
    def of(cls, shape: graphics.LayerShape) -> Batches:
        """Upload a shape."""
        wide = shader("POLYLINE_SMOOTH_COLOR")
        several = (shape.lines, shape.through, shape.thin)
        lines, through, thin = (_batch(wide, "LINES", each) for each in several)
        faces = _batch(shader("SMOOTH_COLOR"), "TRIS", shape.faces)
        sheet = None if shape.sheet is None else _sheet(shape.sheet)
        return cls(shape, lines, through, thin, faces, sheet)

    def draw_areas(self) -> None:
        """Draw sheet and triangles."""
        for each in (self.sheet, self.faces):
            if each is not None:
                each.draw(shader("SMOOTH_COLOR"))

    def draw_lines(self, region: bpy.types.Region, width_px: float, *, edged: bool) -> None:
        """Draw the lines, that wide on the screen, perhaps with a dark edge."""
        if self.through is not None:
            gpu.state.depth_test_set("NONE")
            self.through.draw(_wide("POLYLINE_SMOOTH_COLOR", region, width_px))
            gpu.state.depth_test_set("LESS_EQUAL")
        if self.thin is not None:
            self.thin.draw(_wide("POLYLINE_SMOOTH_COLOR", region, THIN_PX))
        if self.lines is None:
            return
        if edged:
            dark = _wide("POLYLINE_UNIFORM_COLOR", region, width_px + EDGE_PX)
            dark.uniform_float("color", EDGE)
            self.lines.draw(dark)
        self.lines.draw(_wide("POLYLINE_SMOOTH_COLOR", region, width_px))


def _wide(name: str, region: bpy.types.Region, width_px: float) -> gpu.types.GPUShader:
    """Return a shader of lines, ready for some width in a region."""
    found = shader(name)
    found.bind()
    found.uniform_float("viewportSize", (region.width, region.height))
    found.uniform_float("lineWidth", width_px * bpy.context.preferences.system.pixel_size)
    return found


def shader(name: str) -> gpu.types.GPUShader:
    """Return a built-in shader; made when first drawn, as there is no GPU in background."""
    if name not in _shaders:
        _shaders[name] = gpu.shader.from_builtin(name)
    return _shaders[name]


def forget_shaders() -> None:
    """Leave nothing on the graphics card."""
    _shaders.clear()


def _batch(
    of: gpu.types.GPUShader, kind: str, primitives: graphics.Primitives
) -> gpu.types.GPUBatch | None:
    if not len(primitives.points):
        return None
    arrays = {"pos": primitives.points, "color": primitives.colors}
    return batch_for_shader(of, kind, arrays)


def _sheet(sheet: graphics.GroundSheet) -> gpu.types.GPUBatch:
    """Upload a sheet as triangles: a picture's colours are understood differently by versions."""
    points, colors, triangles = sheet.mesh
    arrays = {"pos": points, "color": colors}
    return batch_for_shader(shader("SMOOTH_COLOR"), "TRIS", arrays, indices=triangles)

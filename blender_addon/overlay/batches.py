"""Shapes on the graphics card: what is drawn of a layer, or around a sensor."""

from dataclasses import dataclass

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ..engine import graphics
from ..view.viewport import DrawRegion, line_shader, shader

THIN_PX = 1.0
EDGE_PX = 2.0
EDGE = (0.05, 0.05, 0.05, 0.35)


@dataclass(frozen=True, slots=True, eq=False)
class Batches:
    """The batches of one shape: triangles, lines and a sheet; None for an empty one."""

    shape: graphics.LayerShape
    lines: gpu.types.GPUBatch | None
    through: gpu.types.GPUBatch | None
    thin: gpu.types.GPUBatch | None
    faces: gpu.types.GPUBatch | None
    sheet: gpu.types.GPUBatch | None

    @classmethod
    def of(cls, shape: graphics.LayerShape) -> "Batches":
        """Upload a shape."""
        wide = shader("POLYLINE_SMOOTH_COLOR")
        sorts = (shape.lines, shape.through, shape.thin)
        lines, through, thin = (_batch(wide, "LINES", primitives) for primitives in sorts)
        faces = _batch(shader("SMOOTH_COLOR"), "TRIS", shape.faces)
        sheet = None if shape.sheet is None else _sheet(shape.sheet)
        return cls(shape, lines, through, thin, faces=faces, sheet=sheet)

    def draw_areas(self) -> None:
        """Draw sheet and triangles."""
        for batch in (self.sheet, self.faces):
            if batch is not None:
                batch.draw(shader("SMOOTH_COLOR"))

    def draw_lines(self, region: DrawRegion, width_px: float, *, edged: bool) -> None:
        """Draw the lines in that width on the screen; with a dark edge where `edged`."""
        if self.through is not None:
            gpu.state.depth_test_set("NONE")
            self.through.draw(_line_shader("POLYLINE_SMOOTH_COLOR", region, width_px))
            gpu.state.depth_test_set("LESS_EQUAL")
        if self.thin is not None:
            self.thin.draw(_line_shader("POLYLINE_SMOOTH_COLOR", region, THIN_PX))
        if self.lines is None:
            return
        if edged:
            dark = _line_shader("POLYLINE_UNIFORM_COLOR", region, width_px + EDGE_PX)
            dark.uniform_float("color", EDGE)
            self.lines.draw(dark)
        self.lines.draw(_line_shader("POLYLINE_SMOOTH_COLOR", region, width_px))


def _line_shader(name: str, region: DrawRegion, width_px: float) -> gpu.types.GPUShader:
    return line_shader(name, region, width_px * bpy.context.preferences.system.pixel_size)


def _batch(
    of: gpu.types.GPUShader, kind: str, primitives: graphics.Primitives
) -> gpu.types.GPUBatch | None:
    if not len(primitives.points):
        return None
    arrays = {"pos": primitives.points, "color": primitives.colors}
    return batch_for_shader(of, kind, arrays)


def _sheet(sheet: graphics.GroundSheet) -> gpu.types.GPUBatch:
    """Upload a sheet as triangles: versions of Blender differ in the colours of an image."""
    points, colors, triangles = sheet.mesh
    arrays = {"pos": points, "color": colors}
    return batch_for_shader(shader("SMOOTH_COLOR"), "TRIS", arrays, indices=triangles)

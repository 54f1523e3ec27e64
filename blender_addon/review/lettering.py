"""Text, lines and plates in the plane of the picture, placed in pixels from its top left."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from .camera import View
from .shapes import Faces
from .stage import Stage, material

PLANE_M = 1.0
"""Distance of the texts before the camera: nearer than anything else."""
PLATE_M, LAYER_M = 1.05, 0.005
INK = (0.10, 0.12, 0.14, 1.0)
FAINT_INK = (0.36, 0.39, 0.42, 1.0)
Color = tuple[float, float, float, float]


@dataclass(slots=True)
class Lettering:
    """Writes on a stage as seen in a view."""

    stage: Stage
    view: View
    _materials: dict[Color, bpy.types.Material]

    @classmethod
    def on(cls, stage: Stage, view: View) -> Lettering:
        """Start with no ink made."""
        return cls(stage, view, {})

    def write(
        self, text: str, place: tuple[float, float], size_px: float, color: Color = INK,
        align: str = "LEFT",
    ) -> bpy.types.Object:  # fmt: skip
        """Write one line; `place` is the left, middle or right end of its baseline."""
        curve = bpy.data.curves.new("Review text", "FONT")
        curve.body, curve.align_x = text, align
        curve.size = size_px * self.view.frame.tangent_per_px * PLANE_M
        if color not in self._materials:
            self._materials[color] = material(color)
        curve.materials.append(self._materials[color])
        thing = self.stage.add("Review text", curve)
        matrix = self.view.matrix
        matrix[:3, 3] = self._points([place], PLANE_M)[0]
        thing.matrix_world = Matrix(matrix.tolist())
        return thing

    def rectangle(
        self, left: float, top: float, right: float, bottom: float, color: Color, layer: int = 0
    ) -> None:
        """Fill a rectangle behind the texts; higher layers are in front of lower ones."""
        self._fill([(left, bottom), (right, bottom), (right, top), (left, top)], color, layer)

    def disc(self, center: tuple[float, float], radius_px: float, color: Color, layer: int) -> None:
        """Fill a circle behind the texts."""
        angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        places = np.column_stack([np.cos(angles), -np.sin(angles)]) * radius_px + center
        self._fill(places, color, layer)

    def ring(self, center: tuple[float, float], radius_px: float, color: Color, layer: int) -> None:
        """Draw a circle, white inside."""
        self.disc(center, radius_px, color, layer)
        self.disc(center, radius_px * 0.6, (1.0, 1.0, 1.0, 1.0), layer + 1)

    def line(
        self, start: tuple[float, float], end: tuple[float, float], width_px: float, color: Color,
        layer: int,
    ) -> None:  # fmt: skip
        """Draw a line behind the texts."""
        ends = np.array([start, end], float)
        along = ends[1] - ends[0]
        across = along[::-1] * [1.0, -1.0] * width_px / max(np.hypot(*along), 1e-9) / 2.0
        corners = [ends[0] - across, ends[1] - across, ends[1] + across, ends[0] + across]
        self._fill(corners, color, layer)

    def _fill(self, places: object, color: Color, layer: int) -> None:
        points = self._points(places, PLATE_M - layer * LAYER_M)
        self.stage.add_faces("Review plate", Faces(points[None], np.array([color])), self.view)

    def _points(self, places: object, depth_m: float) -> NDArray[np.float64]:
        """(N, 3) points in the ground frame that are seen at (N, 2) places, at that depth."""
        frame = self.view.frame
        across = np.asarray(places, float) - [frame.width / 2, frame.height / 2]
        local = np.empty((len(across), 3))
        local[:, :2] = across * [1.0, -1.0] * frame.tangent_per_px * depth_m
        local[:, 2] = -depth_m
        return local @ self.view.axes + self.view.position

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
PLATE_M = 1.01
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

    def rectangle(self, left: float, top: float, right: float, bottom: float, color: Color) -> None:
        """Fill a rectangle behind the texts."""
        corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
        points = self._points(corners, PLATE_M)
        self.stage.add_faces("Review plate", Faces(points[None], np.array([color])), self.view)

    def disc(self, center: tuple[float, float], radius_px: float, color: Color) -> None:
        """Fill a circle behind the texts."""
        angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
        places = np.column_stack([np.cos(angles), -np.sin(angles)]) * radius_px + center
        points = self._points(places, PLATE_M)
        self.stage.add_faces("Review disc", Faces(points[None], np.array([color])), self.view)

    def _points(self, places: object, depth_m: float) -> NDArray[np.float64]:
        """(N, 3) points in the ground frame that are seen at (N, 2) places, at that depth."""
        frame = self.view.frame
        across = np.asarray(places, float) - [frame.width / 2, frame.height / 2]
        local = np.empty((len(across), 3))
        local[:, :2] = across * [1.0, -1.0] * frame.tangent_per_px * depth_m
        local[:, 2] = -depth_m
        return local @ self.view.axes + self.view.position

"""Lines and faces as triangles with one colour each: numbers alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics
from .camera import View

Floats = NDArray[np.float64]

FADE_STEPS = 12
"""Pieces of a line whose colour changes along it."""
RING_POINTS = 160


@dataclass(frozen=True, slots=True)
class Faces:
    """Polygons of k corners: `corners` (N, k, 3) [m], `colors` (N, 4) sRGB with alpha."""

    corners: Floats
    colors: Floats


def ribbons(lines: graphics.Primitives, view: View, width_px: float) -> Faces:
    """Lines as strips that face the camera and look equally wide at any distance."""
    ends, colors = _in_steps(lines)
    along = ends[:, 1] - ends[:, 0]
    side = np.cross(along, ends.mean(axis=1) - view.position)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    width = (
        width_px
        * view.frame.scale
        * view.frame.tangent_per_px
        * view.depth(ends.reshape(-1, 3)).reshape(-1, 2)
    )
    half = side[:, None] * width[..., None] / 2.0
    right, left = ends + half, ends - half  # their front, by winding, faces the camera
    return Faces(np.stack([right[:, 0], left[:, 0], left[:, 1], right[:, 1]], axis=1), colors)


def begun_later(lines: graphics.Primitives, distance_m: float) -> graphics.Primitives:
    """Lines that begin that much farther on, at most at their ends."""
    points = lines.points.reshape(-1, 2, 3).astype(float)
    along = points[:, 1] - points[:, 0]
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    points[:, 0] += along * np.minimum(distance_m / length, 1.0)
    return graphics.Primitives(points.reshape(-1, 3).astype(np.float32), lines.colors)


def triangles(faces: graphics.Primitives) -> Faces:
    """Translucent triangles in the colour of their first corner."""
    return Faces(faces.points.reshape(-1, 3, 3).astype(float), faces.colors[::3].astype(float))


def ring(radius_m: float, color: graphics.Rgba) -> graphics.Primitives:
    """Return a circle on the ground about the origin."""
    angles = np.linspace(0.0, 2.0 * np.pi, RING_POINTS + 1)
    circle = radius_m * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    points = np.stack([circle[:-1], circle[1:]], axis=1).reshape(-1, 3)
    return graphics.Primitives(
        points.astype(np.float32), np.tile(np.float32(color), (len(points), 1))
    )


def _in_steps(lines: graphics.Primitives) -> tuple[Floats, Floats]:
    """Cut fading lines into pieces: ends (N, 2, 3) and the mean colour of each (N, 4)."""
    points = lines.points.reshape(-1, 2, 3).astype(float)
    colors = lines.colors.reshape(-1, 2, 4).astype(float)
    fades = (colors[:, 0] != colors[:, 1]).any(axis=1)
    cuts = np.linspace(0.0, 1.0, FADE_STEPS + 1)[:, None, None]
    cut = points[fades, 0] * (1.0 - cuts) + points[fades, 1] * cuts
    pieces = np.stack([cut[:-1], cut[1:]], axis=2).reshape(-1, 2, 3)
    cuts = (cuts[:-1] + cuts[1:]) / 2.0
    tints = (colors[fades, 0] * (1.0 - cuts) + colors[fades, 1] * cuts).reshape(-1, 4)
    return np.concatenate([pieces, points[~fades]]), np.concatenate([tints, colors[~fades, 0]])


def shadow(low: Floats, high: Floats, color: graphics.Rgba, layers: int) -> Faces:
    """Return a soft shadow on the ground under a box: layers of rounded rectangles, growing."""
    angles = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    outline = np.sign(circle) * np.abs(circle) ** 0.45
    center, half = (low + high)[:2] / 2.0, (high - low)[:2] / 2.0
    grown = half - 0.15 + 0.35 * np.linspace(0.0, 1.0, layers)[:, None]
    corners = np.zeros((layers, len(outline), 3))
    corners[:, :, :2] = center + outline * grown[:, None]
    return _all_in(corners, color)


def _all_in(corners: Floats, color: graphics.Rgba) -> Faces:
    return Faces(corners, np.tile(color, (len(corners), 1)))

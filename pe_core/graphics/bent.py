"""The view of a camera with a lens of its own: its true outline, and the ground it looks at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..scene import Sensor
from .colors import Palette
from .models import camera_of
from .primitives import Primitives, polyline

Floats = NDArray[np.float64]

PLACES = 16
"""Along each side of the picture."""
MARK_SIDE = 0.06
"""Half the width of the mark that says up, in lengths of the view."""


def outline(sensor: Sensor, length_m: float) -> Floats:
    """(N, 3) points round a camera's view, `length_m` from it, ground frame [m]."""
    rays = camera_of(sensor).outline(PLACES) @ sensor.pose.ground_from_sensor.T
    return rays * length_m + np.asarray(sensor.pose.position)


def view_lines(sensor: Sensor, length_m: float, palette: Palette) -> Primitives:
    """Edges of a view: from the camera to the corners, the curved outline, and the mark for up."""
    points, place = outline(sensor, length_m), np.asarray(sensor.pose.position)
    spokes = np.stack([np.broadcast_to(place, (4, 3)), points[::PLACES]], axis=1).reshape(-1, 3)
    closed = polyline(np.vstack([points, points[:1]]))
    lines = np.vstack([spokes, closed, _mark(sensor, points[PLACES // 2], length_m)])
    return Primitives.of(lines, palette.camera)


def view_faces(sensor: Sensor, length_m: float, palette: Palette) -> Primitives:
    """Sides of a view: triangles from the camera to its outline."""
    points = outline(sensor, length_m)
    place = np.broadcast_to(np.asarray(sensor.pose.position), points.shape)
    sides = np.stack([place, points, np.roll(points, -1, axis=0)], axis=1)
    return Primitives.of(sides.reshape(-1, 3), palette.camera_face)


def ground_outline(sensor: Sensor, far_m: float) -> Floats:
    """(N, 3) outline of the ground (z = 0) that a camera looks at, as far as `far_m` [m].

    What the vehicle hides is not taken away. Without points when it looks at no ground.
    """
    place = np.asarray(sensor.pose.position)
    rays = camera_of(sensor).outline(PLACES) @ sensor.pose.ground_from_sensor.T
    flat = np.maximum(np.hypot(rays[:, 0], rays[:, 1]), 1e-9)
    steep = place[2] / far_m
    down = np.maximum(-rays[:, 2] / flat, steep)
    if not (-rays[:, 2] / flat > steep).any():
        return np.empty((0, 3))
    points = np.zeros_like(rays)
    points[:, :2] = place[:2] + rays[:, :2] / flat[:, None] * (place[2] / down)[:, None]
    return points


def _mark(sensor: Sensor, top: Floats, length_m: float) -> Floats:
    """(6, 3) ends of the lines of a small triangle over the middle of the upper edge."""
    axes = sensor.pose.ground_from_sensor
    up, left = axes[:, 2], axes[:, 1] * length_m * MARK_SIDE
    tip = top + up * length_m * MARK_SIDE * 2.0
    base = top + up * length_m * MARK_SIDE * 0.5
    corners = np.array([base + left, base - left, tip])
    return corners[[0, 1, 1, 2, 2, 0]]

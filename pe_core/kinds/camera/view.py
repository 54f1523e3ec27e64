"""A camera's field of view in triangles: rings from its axis out to the picture's border."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..view_patch import ViewPatch, grid_faces
from .model import Camera

Floats = NDArray[np.float64]


def picture_patch(camera: Camera, step: float) -> ViewPatch:
    """Return what a picture shows, in triangles of about `step` [rad]."""
    widest = max(camera.hfov, camera.vfov)
    outline = camera.outline(max(math.ceil(widest / step), 2))
    angle = np.arccos(np.clip(outline[:, 0], -1.0, 1.0))
    away = outline[:, 1:] / np.maximum(np.sin(angle), 1e-12)[:, None]
    rings = max(math.ceil(float(angle.max()) / step), 1)
    theta = np.arange(1, rings + 1)[:, None] / rings * angle
    flat = np.sin(theta)[..., None] * away
    directions = np.concatenate([np.cos(theta)[..., None], flat], axis=-1).reshape(-1, 3)
    directions = np.vstack([[[1.0, 0.0, 0.0]], directions])
    # The outline runs clockwise as the camera sees it: its rows go inwards as seen from outside.
    index = 1 + np.arange(rings * len(outline)).reshape(rings, -1)[::-1]
    index = np.vstack([index, np.zeros((1, len(outline)), np.int64)])
    return ViewPatch(directions, grid_faces(index, closed=True))

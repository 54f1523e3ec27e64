"""Which parts of a camera's picture the vehicle may hide: a coarse map, never too small."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry import Pose, rotate
from ..sensors import Camera
from .raycast import CELLS, ranges, windows

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

BORDER = 1.05
"""The map reaches this far beyond the picture's edges, for voxels that only touch the picture."""


class ShadowMap:
    """Bins of a picture, CELLS by CELLS, that a triangle may touch.

    Parameters
    ----------
    camera : Camera
    pose : Pose
    triangles : (F, 3, 3) float
        Corners relative to the camera, ground axes [m].
    """

    def __init__(self, camera: Camera, pose: Pose, triangles: Floats) -> None:
        self._wide = BORDER * camera.width / 2.0 / camera.focal_px
        self._high = BORDER * camera.height / 2.0 / camera.focal_px
        corners = rotate(pose.ground_from_sensor.T, triangles).transpose(2, 1, 0)
        depth, left, up = np.ascontiguousarray(corners)
        _, (i0, i1), (j0, j1) = windows(depth, left / self._wide, up / self._high)
        high = j1 - j0 + 1
        n = (i1 - i0 + 1) * high
        step, rows = ranges(n), np.repeat(high, n)
        row = step // rows
        self._hit = np.zeros(CELLS * CELLS, bool)
        bins = (np.repeat(i0, n) + row) * CELLS + np.repeat(j0, n) + (step - row * rows)
        self._hit[bins] = True
        self.empty = not len(bins)

    def may_hide(self, depth: Singles, left: Singles, up: Singles) -> NDArray[np.bool_]:
        """Whether the vehicle may stand in the way of points in front of the camera, each (V,)."""
        u = left / (depth * np.float32(self._wide))
        v = up / (depth * np.float32(self._high))
        bins = self._bin(u) * CELLS + self._bin(v)
        outside = np.maximum(np.abs(u), np.abs(v)) > 1.0
        return self._hit[bins] | outside

    @staticmethod
    def _bin(u: Singles) -> NDArray[np.int32]:
        return np.clip((u + np.float32(1.0)) * np.float32(CELLS / 2), 0, CELLS - 1).astype(np.int32)

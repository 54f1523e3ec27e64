"""Pixel areas of the voxels of a run of x-planes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry import Pose
from ..sensors import Camera
from ..space import PerceptionSpace
from ..vehicle import SeenMesh
from .camera_area import in_view
from .camera_points import pixel_areas

Floats = NDArray[np.float64]


def pixels_in_planes(
    camera: Camera, pose: Pose, space: PerceptionSpace, planes: slice, seen: SeenMesh | None
) -> NDArray[np.float32]:
    """(n, ny, nz) pixels covered by each voxel of the x-planes; see `pixel_areas`."""
    _, ny, nz = space.shape
    axes = (space.centers(0)[planes], space.centers(1), space.centers(2))
    x, y, z = (w - pose.position[k] for k, w in enumerate(axes))
    depth, left, up = (
        (a[0] * x)[:, None, None] + ((a[1] * y)[:, None] + (a[2] * z))
        for a in pose.ground_from_sensor.T
    )
    area = np.zeros(depth.shape, np.float32)
    index = np.flatnonzero(in_view(camera, depth, left, up, space.interval))
    i, j, k = index // (ny * nz), index // nz % ny, index % nz
    centers = np.stack([axes[0][i], axes[1][j], axes[2][k]], axis=1)
    area.reshape(-1)[index] = pixel_areas(camera, pose, centers, space.interval, seen)
    return area

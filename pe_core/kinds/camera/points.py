"""Pixel areas for many voxels: a closed form where it is good, the exact area where it is not.

Seen from afar a face is a small flat patch: its image has the area ``f^2 |n . r| A / depth^3`` with
n its normal, r the way to its centre and A its area. Over the faces of a cube of side s at r that
makes ``f^2 s^2 (a + 3 s / 2) / (depth^3 - depth s^2 / 2)``, where a is the sum over the axes of
``max(|r_k| - s / 2, 0)``: right to first order in s / depth, and to second a mean over directions.
It misses the clipping at the image's border; voxels there, or nearer than NEAR_SIDES sides, get the
exact area instead.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import Pose
from ...scene.vehicle import SeenMesh
from .area import clipped_pixel_area, frustum_distance, in_sensor_frame, in_view
from .definition import hidden
from .model import Camera
from .ranged import is_ranged, out_of_range
from .ties import MARGIN, aims_at, axes_of, offsets_of

Floats = NDArray[np.float64]

NEAR_SIDES = 15.0
"""Depth in voxel sides below which the exact area is taken: the closed form is then 0.3 % off at
most."""
BALL = np.sqrt(3.0) / 2.0
"""Radius of the ball around a cube, in sides."""


def pixel_areas(
    camera: Camera, pose: Pose, centers: Floats, side: float, seen: SeenMesh | None
) -> Floats:
    """(V,) pixels covered by each voxel; 0 where the vehicle `seen` hides its centre.

    Parameters
    ----------
    camera : Camera
    pose : Pose
    centers : (V, 3) float
        Ground frame [m].
    side : float
        Side of a voxel [m].
    seen : SeenMesh, optional
        The vehicle from the camera's position.
    """
    axes, area = axes_of(pose), np.zeros(len(centers))
    roughly = in_sensor_frame(axes, centers - np.asarray(pose.position))
    index = np.flatnonzero(in_view(camera, *roughly, side))
    offsets = offsets_of(centers[index], pose.position, side)
    found = _areas_in_view(camera, axes, offsets, side)
    if is_ranged(camera):
        found[out_of_range(camera, offsets)] = 0.0
    if seen is not None:
        visible = np.flatnonzero(found)
        found[visible[hidden(seen, aims_at(offsets[visible], side))]] = 0.0
    area[index] = found
    return area


def _areas_in_view(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    depth, left, up = in_sensor_frame(axes, offsets)
    plain = depth > (NEAR_SIDES + MARGIN) * side
    plain &= frustum_distance(camera, depth, left, up) > (BALL + MARGIN) * side
    area = np.empty(len(offsets))
    area[plain] = _flat_area(camera, offsets[plain], depth[plain], side)
    area[~plain] = clipped_pixel_area(camera, axes, offsets[~plain], side)
    return area


def _flat_area(camera: Camera, offsets: Floats, depth: Floats, side: float) -> Floats:
    away = [np.maximum(np.abs(offsets[:, k]) - side / 2.0, 0.0) for k in range(3)]
    cube = (depth * depth - side * side / 2.0) * depth
    return (camera.focal_px * side) ** 2 * (away[0] + away[1] + away[2] + 1.5 * side) / cube

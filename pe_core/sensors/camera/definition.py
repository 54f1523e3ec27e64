"""The measurement of a camera by definition: the area of each voxel's image, if it is in range.

The distance of a voxel's centre decides whether it is in range. A ray to the centre decides whether
it is occluded.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Singles
from ...geometry.poses import dot
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle, VisibleMesh
from .model import Camera
from .pixel_area import bent_pixel_area, clipped_pixel_area
from .tie_rules import aims_at, axes_of, offsets_of

Mask = NDArray[np.bool_]


def is_ranged(camera: Camera) -> bool:
    """Whether a camera has a minimum or maximum range."""
    return camera.min_range > 0.0 or camera.max_range < math.inf


def out_of_range(camera: Camera, offsets: Floats) -> Mask:
    """Whether centres (V, 3), relative to the camera [m], are out of its range."""
    return _beyond(camera, dot(offsets, offsets))


def cut_to_range(camera: Camera, area: Singles, axes: list[Floats], first: tuple[int, int]) -> None:
    """Set the areas (n, rows, nz) of voxels out of range to 0.

    `axes` are the centres' coordinates along each axis, `first` the first plane and row.
    """
    x, y, z = axes
    y = y[first[1] : first[1] + area.shape[1]]
    for plane, here in zip(area, x[first[0] :], strict=False):
        plane[_beyond(camera, (here * here + y * y)[:, None] + z * z)] = 0.0


def _beyond(camera: Camera, square: Floats) -> Mask:
    beyond: Mask = square > camera.max_range**2
    if camera.min_range > 0.0:
        beyond |= square < camera.min_range**2
    return beyond


def count_pixels(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    """Return the pixels (V,) that cubes with centres (V, 3) and a side [m] cover: m of voxels."""
    camera, position = cast(Camera, sensor.model), sensor.pose.position
    offsets = offsets_of(centers, position, side)
    exact = clipped_pixel_area if camera.projection.is_straight else bent_pixel_area
    area = exact(camera, axes_of(sensor.pose), offsets, side)
    if is_ranged(camera):
        area[out_of_range(camera, offsets)] = 0.0
    in_view = np.flatnonzero(area)
    if vehicle is not None and len(in_view):
        seen = vehicle.seen_from(position, camera.sees_through_glass)
        area[in_view[hidden(seen, aims_at(offsets[in_view], side))]] = 0.0
    return area


def hidden(seen: VisibleMesh, aims: Floats) -> NDArray[np.bool_]:
    """Whether the vehicle occludes the points (V, 3) that rays from the camera aim at [m]."""
    distance = np.sqrt(dot(aims, aims))
    hits = seen.first_hit(aims / distance[:, None])
    return hits.distance < distance

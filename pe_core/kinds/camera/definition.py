"""The measurement of a camera as it is defined: the area of each voxel's image, no tricks."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot
from ...scene.sensors import Sensor
from ...scene.vehicle import SeenMesh, Vehicle
from .area import clipped_pixel_area
from .bent_area import bent_pixel_area
from .model import Camera
from .ranged import is_ranged, out_of_range
from .ties import aims_at, axes_of, offsets_of

Floats = NDArray[np.float64]


def count_pixels(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    camera, position = cast(Camera, sensor.model), sensor.pose.position
    offsets = offsets_of(centers, position, side)
    area = image_area(camera, axes_of(sensor.pose), offsets, side)
    if is_ranged(camera):
        area[out_of_range(camera, offsets)] = 0.0
    in_view = np.flatnonzero(area)
    if vehicle is not None and len(in_view):
        seen = vehicle.seen_from(position, camera.sees_through_glass)
        area[in_view[hidden(seen, aims_at(offsets[in_view], side))]] = 0.0
    return area


def image_area(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    """(V,) pixels covered by cubes with centres at offsets, through the camera's own lens."""
    exact = clipped_pixel_area if camera.projection.is_straight else bent_pixel_area
    return exact(camera, axes, offsets, side)


def hidden(seen: SeenMesh, aims: Floats) -> NDArray[np.bool_]:
    """Whether the vehicle stands before what rays from the camera aim at, (V, 3) [m]."""
    distance = np.sqrt(dot(aims, aims))
    hits = seen.first_hit(aims / distance[:, None])
    return hits.distance < distance

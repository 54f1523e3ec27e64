"""The measurement of a camera as it is defined: the area of each voxel's image, no tricks."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from .area import clipped_pixel_area
from .model import Camera

Floats = NDArray[np.float64]


def count_pixels(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    area = clipped_pixel_area(cast(Camera, sensor.model), sensor.pose, centers, side)
    seen = np.flatnonzero(area)
    if vehicle is not None and len(seen):
        area[seen[hidden_by(vehicle, sensor, centers[seen])]] = 0.0
    return area


def hidden_by(vehicle: Vehicle, sensor: Sensor, centers: Floats) -> NDArray[np.bool_]:
    """Whether the vehicle stands between a camera and each of (V, 3) centres."""
    offsets = centers - np.asarray(sensor.pose.position)
    distance = np.sqrt(dot(offsets, offsets))
    directions = offsets / distance[:, None]
    hits = vehicle.first_hit(sensor.pose.position, directions, sensor.model.sees_through_glass)
    return hits.distance < distance

"""A sensor's model as what its kind says it is: who draws has been chosen by the kind."""

from __future__ import annotations

from typing import cast

from ..kinds import Camera, Lidar
from ..scene import Sensor


def lidar_of(sensor: Sensor) -> Lidar:
    """Return the model of a sensor that is a LiDAR."""
    return cast(Lidar, sensor.model)


def camera_of(sensor: Sensor) -> Camera:
    """Return the model of a sensor that is a camera."""
    return cast(Camera, sensor.model)

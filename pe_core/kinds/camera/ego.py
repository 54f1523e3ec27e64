"""What of a camera's picture its own vehicle takes, pixel by pixel."""

from __future__ import annotations

from typing import cast

import numpy as np

from ...scene.geometry import rotate
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..ego_mask import FREE, OUTSIDE, EgoMask, require_few_rays
from .model import Camera

RAYS_AT_ONCE = 1 << 19


def picture_mask(sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
    """Ask every pixel by the ray through its middle, some rows at a time."""
    camera = cast(Camera, sensor.model)
    require_few_rays(sensor.name, camera.width * camera.height)
    found = np.full((camera.height, camera.width), FREE, np.int32)
    rows = max(1, RAYS_AT_ONCE // camera.width)
    seen = None
    if vehicle is not None:
        seen = vehicle.seen_from(sensor.pose.position, camera.sees_through_glass)
    for first in range(0, camera.height, rows):
        down, right = np.mgrid[first : min(first + rows, camera.height), : camera.width] + 0.5
        own = camera.projection.unproject(right.ravel(), down.ravel())
        shown = np.flatnonzero(~np.isnan(own[:, 0]))
        parts = np.full(len(own), OUTSIDE, np.int32)
        parts[shown] = FREE
        if seen is not None and vehicle is not None:
            face = seen.first_hit(rotate(sensor.pose.ground_from_sensor, own[shown])).face
            parts[shown] = np.where(face >= 0, np.asarray(vehicle.parts)[face], FREE)
        found[first : first + rows] = parts.reshape(-1, camera.width)
    return EgoMask(found)

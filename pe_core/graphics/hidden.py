"""What a camera has of its own vehicle in its picture: lines to where it sees it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..kinds.camera.picture import picture_rays
from ..scene import Sensor, Vehicle
from .models import camera_of
from .primitives import Primitives

RAYS = 240
"""Places of the picture that are looked along: enough to see where the body begins."""


def hidden_lines(
    sensor: Sensor, vehicle: Vehicle | None, color: ArrayLike, most: int = RAYS
) -> Primitives:
    """Return lines from a camera to its own vehicle, evenly spread over the picture.

    Parameters
    ----------
    sensor : Sensor
        A camera.
    vehicle : Vehicle or None
        What glass it has, cameras see through. None: there is nothing to be seen.
    color : (4,) float
    most : int
        Places of the picture that are looked along.
    """
    if vehicle is None:
        return Primitives.empty()
    rays = picture_rays(sensor, most)
    through_glass = camera_of(sensor).sees_through_glass
    distance = vehicle.first_hit(sensor.pose.position, rays, through_glass).distance
    met = np.isfinite(distance)
    start = np.broadcast_to(sensor.pose.position, (int(met.sum()), 3))
    ends = start + rays[met] * distance[met, None]
    return Primitives.of(np.stack([start, ends], axis=1), color)

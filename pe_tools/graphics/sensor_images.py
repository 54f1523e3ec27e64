"""Images of single sensors: a LiDAR's ranges, and a camera's pixels that the body hides."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.scene import Sensor, Vehicle
from pe_core.sensors import Camera, Lidar, RangePicture, kind_of

from .colors import VIRIDIS, Scale, on_scale
from .primitives import Primitives

NEAREST_M = 0.5
"""All that is nearer has the brightest colour."""
NO_ECHO = (0.16, 0.16, 0.17)
BODY_NEAR, BODY_FAR = (1.0, 0.62, 0.20), (0.72, 0.28, 0.0)
"""Vermillion, as occluded beams are drawn: nearer parts are lighter."""
BODY_SILENT = (0.42, 0.17, 0.0)
"""Colour of a beam that the body blocks so near that there is no echo."""
BODY_FAR_M = 5.0
RANGES: Scale = VIRIDIS[::-2]
"""From near to far."""
RAYS = 240
"""Places of the picture that are looked along: enough to see where the body begins."""


def lidar_of(sensor: Sensor) -> Lidar:
    """Return the model of a sensor that is a LiDAR."""
    return cast(Lidar, sensor.model)


def camera_of(sensor: Sensor) -> Camera:
    """Return the model of a sensor that is a camera."""
    return cast(Camera, sensor.model)


def range_colors(picture: RangePicture, far_m: float) -> NDArray[np.float32]:
    """(C, A, 3) sRGB of a LiDAR's beams; the scale is logarithmic, up to `far_m`."""
    heard = np.isfinite(picture.distance)
    distance = np.where(heard, np.maximum(picture.distance, NEAREST_M), far_m)
    colors = on_scale(range_share(distance, far_m), RANGES)
    colors[~heard] = NO_ECHO
    colors[picture.occluded & ~heard] = BODY_SILENT
    own = picture.occluded & heard
    colors[own] = on_scale(distance[own] / BODY_FAR_M, (BODY_NEAR, BODY_FAR))
    return colors


def range_share(distance: NDArray[np.float64], far_m: float) -> NDArray[np.float64]:
    """Return the position of distances [m] on the logarithmic scale: 0 near, 1 at `far_m`."""
    far = max(far_m, 2.0 * NEAREST_M)
    share = np.log(np.maximum(distance, NEAREST_M) / NEAREST_M) / math.log(far / NEAREST_M)
    return np.asarray(share)


def even_angles(angles: NDArray[np.float64], pixels_per_deg: float) -> NDArray[np.int64]:
    """(P,) index of the beam nearest to each pixel of an axis; `angles` [rad] are descending."""
    degrees = np.degrees(angles)
    high, low = float(degrees[0]), float(degrees[-1])
    count = max(1, round((high - low) * pixels_per_deg))
    places = high - (np.arange(count) + 0.5) * (high - low) / count
    between = (degrees[1:] + degrees[:-1]) / 2.0
    return np.searchsorted(-between, -places)


def hidden_lines(
    sensor: Sensor, vehicle: Vehicle | None, color: ArrayLike, most: int = RAYS
) -> Primitives:
    """Return lines from a sensor to its own vehicle, evenly spread over its field of view.

    Parameters
    ----------
    sensor : Sensor
    vehicle : Vehicle or None
        The vehicle; cameras see through its glass, radars through its covers. None gives no
        lines.
    color : (4,) float
    most : int
        Number of rays.
    """
    body = None if vehicle is None else kind_of(sensor).opaque(vehicle)
    if body is None:
        return Primitives.empty()
    rays, through_glass = kind_of(sensor).rays(sensor, most), sensor.model.sees_through_glass
    distance = body.first_hit(sensor.pose.position, rays, through_glass).distance
    met = np.isfinite(distance)
    start = np.broadcast_to(sensor.pose.position, (int(met.sum()), 3))
    ends = start + rays[met] * distance[met, None]
    return Primitives.of(np.stack([start, ends], axis=1), color)

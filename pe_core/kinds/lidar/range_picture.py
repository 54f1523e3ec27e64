"""What a LiDAR sees all around: how far each of its beams goes, and what ends it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import rotate
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from .model import Lidar

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RangePicture:
    """A LiDAR's beams as a picture: a row a channel, top first; a column an azimuth, left first.

    The middle of a full circle is straight ahead, its edges are straight behind. A channel's own
    azimuth offset shifts its beams and not its columns.

    Attributes
    ----------
    distance : (C, A) float
        Where each beam ends, on the vehicle or on the ground (z = 0) [m]; inf where on neither
        within its range.
    stopped : (C, A) bool
        Whether it is the vehicle that ends it.
    elevations : (C,) float
        Of the rows, descending [rad].
    azimuths : (A,) float
        Of the columns, descending: positive is left [rad].
    """

    distance: Floats
    stopped: NDArray[np.bool_]
    elevations: Floats
    azimuths: Floats


def range_picture(sensor: Sensor, vehicle: Vehicle | None) -> RangePicture:
    """Return how far a mounted LiDAR's beams go, as a picture of its surroundings.

    Parameters
    ----------
    sensor : Sensor
        A LiDAR.
    vehicle : Vehicle or None
        What stops beams, besides the ground.
    """
    lidar = cast(Lidar, sensor.model)
    directions = rotate(sensor.pose.ground_from_sensor, lidar.directions)
    body = np.full(len(directions), np.inf)
    if vehicle is not None:
        body = vehicle.first_hit(sensor.pose.position, directions).distance
    ground = _to_ground(sensor.pose.position[2], directions[:, 2])
    distance = np.minimum(body, ground)
    beyond = distance > lidar.max_range
    rows = np.argsort(-lidar.elevations, kind="stable")
    columns = np.argsort(-_around(lidar), kind="stable")

    def laid_out(values: NDArray) -> NDArray:
        return values.reshape(len(rows), len(columns))[np.ix_(rows, columns)]

    return RangePicture(
        laid_out(np.where(beyond, np.inf, distance)),
        laid_out((body <= ground) & ~beyond & np.isfinite(body)),
        lidar.elevations[rows],
        _around(lidar)[columns],
    )


def _to_ground(height: float, up: Floats) -> Floats:
    """(B,) distance to z = 0 of rays from a height [m] that rise by `up` a metre."""
    distance = np.full(len(up), np.inf)
    if height > 0.0:
        np.divide(height, -up, out=distance, where=up < 0.0)
    return distance


def _around(lidar: Lidar) -> Floats:
    """(A,) azimuths of the columns, above -180 to 180 degrees [rad]."""
    azimuths = lidar.azimuth_steps * lidar.azimuth_step
    turned: Floats = np.pi - np.mod(np.pi - azimuths, 2.0 * np.pi)
    return turned

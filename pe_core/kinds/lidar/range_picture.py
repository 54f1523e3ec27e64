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
        Where each beam ends, on the vehicle, on a thing or on the ground (z = 0) [m]; inf where on
        none between its least and its greatest range: nothing comes back.
    stopped : (C, A) bool
        Whether it is the vehicle that ends it, be it nearer than the least range.
    things : (C, A) int
        Which part of `things` ends it; -1 where none does, or nothing comes back.
    elevations : (C,) float
        Of the rows, descending [rad].
    azimuths : (A,) float
        Of the columns, descending: positive is left [rad].
    """

    distance: Floats
    stopped: NDArray[np.bool_]
    things: NDArray[np.int64]
    elevations: Floats
    azimuths: Floats


def range_picture(
    sensor: Sensor, vehicle: Vehicle | None, things: Vehicle | None = None
) -> RangePicture:
    """Return how far a mounted LiDAR's beams go, as a picture of its surroundings.

    Parameters
    ----------
    sensor : Sensor
        A LiDAR.
    vehicle : Vehicle or None
        What stops beams, besides the ground.
    things : Vehicle, optional
        What else stands there, part by part.
    """
    lidar, position = cast(Lidar, sensor.model), sensor.pose.position
    directions = rotate(sensor.pose.ground_from_sensor, lidar.directions)
    ground = _to_ground(position[2], directions[:, 2])
    body = np.full(len(directions), np.inf)
    if vehicle is not None:
        body = vehicle.first_hit(position, directions).distance
    thing, which = _to_things(things, np.asarray(position), directions)
    others = np.minimum(ground, thing)
    distance = np.minimum(body, others)
    silent = (distance > lidar.max_range) | (distance < lidar.min_range)
    met = (which >= 0) & (thing < np.minimum(body, ground)) & ~silent
    stopped = (body <= others) & (body <= lidar.max_range)
    rows = np.argsort(-lidar.elevations, kind="stable")
    columns = np.argsort(-columns_around(lidar), kind="stable")

    def laid_out(values: NDArray) -> NDArray:
        return values.reshape(len(rows), len(columns))[np.ix_(rows, columns)]

    return RangePicture(
        laid_out(np.where(silent, np.inf, distance)),
        laid_out(stopped),
        laid_out(np.where(met, which, -1)),
        lidar.elevations[rows],
        columns_around(lidar)[columns],
    )


def _to_things(
    things: Vehicle | None, origin: Floats, directions: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """(B,) distance to what stands there, and (B,) which part of it, -1 for none."""
    if things is None:
        return np.full(len(directions), np.inf), np.full(len(directions), -1)
    hits = things.first_hit_from(origin, directions)
    parts = np.asarray(things.parts)[hits.face]
    return hits.distance, np.where(hits.face >= 0, parts, -1).astype(np.int64)


def _to_ground(height: float, up: Floats) -> Floats:
    """(B,) distance to z = 0 of rays from a height [m] that rise by `up` a metre."""
    distance = np.full(len(up), np.inf)
    if height > 0.0:
        np.divide(height, -up, out=distance, where=up < 0.0)
    return distance


def columns_around(lidar: Lidar) -> Floats:
    """(A,) azimuths of the columns, above -180 to 180 degrees [rad]."""
    azimuths = lidar.azimuth_steps * lidar.azimuth_step
    turned: Floats = np.pi - np.mod(np.pi - azimuths, 2.0 * np.pi)
    return turned

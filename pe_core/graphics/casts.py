"""Where the beams of a mounted LiDAR end: all of them, or an even choice while it moves.

Casting is the dear part of what is drawn, so it is done once and shared: beams, rings on the ground
and the heat on the body are read off the same cast.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..kinds import Lidar
from ..scene import Sensor, Vehicle, rotate
from .models import lidar_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

A_DRAFT, MOST = 12_000, 1_500_000
"""Beams that are cast while the sensor moves, and at rest."""


@dataclass(frozen=True, slots=True, eq=False)
class Cast:
    """Beams of a mounted LiDAR: some of its channels, each at the same azimuths.

    `rows` (R,) channels and `columns` (K,) places among the azimuths, both ascending. Beam
    ``r * K + k`` has `directions` (R * K, 3) unit, ground frame; `ends` (R * K,) at the vehicle or
    the maximum range [m]; `face` (R * K,) the triangle of the vehicle that stops it, else -1.
    """

    sensor: Sensor
    rows: Ints
    columns: Ints
    directions: Floats
    ends: Floats
    face: Ints

    @property
    def stopped(self) -> NDArray[np.bool_]:
        """(R * K,) whether the vehicle stops the beam."""
        return self.face >= 0

    @property
    def points(self) -> Floats:
        """(R * K, 3) where the beams end, ground frame [m]."""
        ends: Floats = self.directions * self.ends[:, None]
        return ends + np.asarray(self.sensor.pose.position)


def cast(sensor: Sensor, vehicle: Vehicle | None, most: int = MOST) -> Cast:
    """Cast at most that many of a LiDAR's beams, evenly chosen, against the vehicle."""
    lidar = lidar_of(sensor)
    rows, columns = grid(lidar, most)
    numbers = (rows[:, None] * len(lidar.azimuth_steps) + columns).ravel()
    directions = rotate(sensor.pose.ground_from_sensor, lidar.directions[numbers])
    if vehicle is None or not len(numbers):
        ends, face = np.full(len(numbers), lidar.max_range), np.full(len(numbers), -1)
        return Cast(sensor, rows, columns, directions, ends, face)
    hits = vehicle.first_hit(sensor.pose.position, directions, lidar.sees_through_glass)
    met = hits.distance < lidar.max_range
    ends = np.where(met, hits.distance, lidar.max_range)
    return Cast(sensor, rows, columns, directions, ends, np.where(met, hits.face, -1))


def grid(lidar: Lidar, most: int) -> tuple[Ints, Ints]:
    """Channels (R,) and azimuths (K,) of an even choice of at most `most` beams, both ascending."""
    rows = evenly(len(lidar.elevations), most)
    return rows, around(lidar, most // max(len(rows), 1))


def around(lidar: Lidar, count: int) -> Ints:
    """At most `count` of the azimuths, evenly spread; of a sector the first and the last, too."""
    azimuths = len(lidar.azimuth_steps)
    count = min(count, azimuths)
    if azimuths == lidar.azimuth_count and count:
        return np.arange(count) * azimuths // count  # a circle: the last is the first's neighbour
    return evenly(azimuths, count)


def evenly(total: int, count: int) -> Ints:
    """(N,) at most `count` of the numbers below a total, evenly, the first and last among them."""
    if total <= count:
        return np.arange(total)
    return np.linspace(0, total - 1, max(count, 0)).round().astype(np.int64)

"""Which of a LiDAR's beams are shown, and where they end.

A LiDAR has a hundred thousand beams; a few thousand show its pattern. Azimuths are thinned first,
the same ones in every channel, so that each channel shows; channels only when there are more of
them than beams to draw. The vehicle often stops less than a hundredth of them, and those matter
most: they keep a share of the budget and are thinned less.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pe_core as pe

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STOPPED_SHARE = 0.25
"""Part of the budget that is kept for stopped beams."""
LOOKED_AT = 12_000
"""Beams cast to find where the vehicle stops some; beside those, every beam is looked at."""


@dataclass(frozen=True, slots=True)
class Beams:
    """Some beams of a mounted LiDAR.

    `directions` (N, 3) unit, ground frame; `ends` (N,) the vehicle or the maximum range [m];
    `stopped` (N,) whether it was the vehicle.
    """

    directions: Floats
    ends: Floats
    stopped: NDArray[np.bool_]

    def __getitem__(self, chosen: NDArray) -> Beams:
        """Return some of the beams."""
        return Beams(self.directions[chosen], self.ends[chosen], self.stopped[chosen])


def shown_beams(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, budget: int, channels: int | None = None
) -> Beams:
    """Return at most `budget` beams of a LiDAR: free ones evenly spread, then stopped ones.

    `channels` limits how many channels the free ones are from.
    """
    if vehicle is None:
        return _cast(sensor, None, spread(sensor.model, budget, channels))
    seen = vehicle.seen_from(sensor.pose.position)
    shown = spread(sensor.model, budget - int(budget * STOPPED_SHARE), channels)
    stopped = _stopped(sensor, seen, np.union1d(shown, spread(sensor.model, LOOKED_AT)))
    free = np.setdiff1d(shown, stopped)
    return _cast(sensor, seen, np.concatenate([free, _evenly(stopped, budget - len(free))]))


def spread(lidar: pe.Lidar, budget: int, channels: int | None = None) -> Ints:
    """(N,) beam numbers, ascending, N <= budget: every channel at the same azimuths, evenly."""
    azimuths = len(lidar.azimuth_steps)
    most = budget if channels is None else min(budget, channels)
    rows = _evenly(np.arange(len(lidar.elevations)), most)
    per_channel = min(azimuths, budget // max(len(rows), 1))
    columns = _evenly(np.arange(azimuths), per_channel)
    if azimuths == lidar.azimuth_count and per_channel:  # a circle: the last is the first's neighbour
        columns = np.arange(per_channel) * azimuths // per_channel
    return (rows[:, None] * azimuths + columns).ravel()


def _stopped(sensor: pe.Sensor, seen: object, looked: Ints) -> Ints:
    """Numbers of the beams that the vehicle stops, of those looked at and those beside them."""
    found = looked[_cast(sensor, seen, looked).stopped]
    beside = np.setdiff1d(_beside(sensor.model, found), looked)
    return np.union1d(found, beside[_cast(sensor, seen, beside).stopped])


def _beside(lidar: pe.Lidar, beams: Ints) -> Ints:
    """Beams of the same channel up to the next azimuth that was looked at, to either side."""
    reach = -(-lidar.beam_count // LOOKED_AT)
    azimuths = len(lidar.azimuth_steps)
    channel, column = np.divmod(beams, azimuths)
    columns = (column[:, None] + np.arange(-reach, reach + 1)) % azimuths
    return np.unique(channel[:, None] * azimuths + columns)


def _cast(sensor: pe.Sensor, seen: object | None, numbers: Ints) -> Beams:
    """Cast the beams of those numbers against the vehicle as seen from the sensor."""
    lidar = sensor.model
    directions = lidar.directions[numbers] @ sensor.pose.ground_from_sensor.T
    if seen is None or not len(numbers):
        ends = np.full(len(numbers), lidar.max_range)
        return Beams(directions, ends, np.zeros(len(numbers), bool))
    distance = seen.first_hit(directions).distance
    return Beams(directions, np.minimum(distance, lidar.max_range), distance < lidar.max_range)


def _evenly(values: Ints, count: int) -> Ints:
    """Return at most `count` of the values, evenly spread, the first and the last among them."""
    if len(values) <= count:
        return values
    return values[np.linspace(0, len(values) - 1, max(count, 0)).round().astype(np.int64)]

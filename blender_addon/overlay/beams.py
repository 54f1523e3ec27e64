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
    from ..engine import pe

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
    `stopped` (N,) whether it was the vehicle; `room` (N,) solid angle that each free beam has to
    itself among those shown [sr].
    """

    directions: Floats
    ends: Floats
    stopped: NDArray[np.bool_]
    room: Floats

    def __getitem__(self, chosen: NDArray) -> Beams:
        """Return some of the beams."""
        return Beams(*(getattr(self, each)[chosen] for each in self.__slots__))


def shown_beams(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, budget: int, channels: int | None = None
) -> Beams:
    """Return at most `budget` beams of a LiDAR: free ones evenly spread, then stopped ones.

    `channels` limits how many channels the free ones are from.
    """
    lidar = sensor.model
    if vehicle is None:
        shown, stopped, seen = spread(lidar, budget, channels), np.empty(0, np.int64), None
    else:
        seen = vehicle.seen_from(sensor.pose.position, sensor.model.sees_through_glass)
        shown = spread(lidar, budget - int(budget * STOPPED_SHARE), channels)
        stopped = _stopped(sensor, seen, np.union1d(shown, spread(lidar, LOOKED_AT)))
    free = np.setdiff1d(shown, stopped)
    numbers = np.concatenate([free, _thinned(lidar, stopped, budget - len(free))])
    directions = lidar.directions[numbers] @ sensor.pose.ground_from_sensor.T
    ends, is_stopped = _ends(lidar, seen, directions)
    return Beams(directions, ends, is_stopped, _room(lidar, shown)[numbers // _azimuths(lidar)])


def spread(lidar: pe.Lidar, budget: int, channels: int | None = None) -> Ints:
    """(N,) beam numbers, ascending, N <= budget: every channel at the same azimuths, evenly."""
    azimuths = _azimuths(lidar)
    most = budget if channels is None else min(budget, channels)
    rows = _evenly(np.arange(len(lidar.elevations)), most)
    per_channel = min(azimuths, budget // max(len(rows), 1))
    columns = _evenly(np.arange(azimuths), per_channel)
    if (
        azimuths == lidar.azimuth_count and per_channel
    ):  # a circle: the last is the first's neighbour
        columns = np.arange(per_channel) * azimuths // per_channel
    return (rows[:, None] * azimuths + columns).ravel()


def _stopped(sensor: pe.Sensor, seen: object, looked: Ints) -> Ints:
    """Numbers of the beams that the vehicle stops, of those looked at and those beside them."""
    lidar, ground_from_sensor = sensor.model, sensor.pose.ground_from_sensor

    def stopped_of(numbers: Ints) -> Ints:
        directions = lidar.directions[numbers] @ ground_from_sensor.T
        return numbers[_ends(lidar, seen, directions)[1]]

    found = stopped_of(looked)
    return np.union1d(found, stopped_of(np.setdiff1d(_beside(lidar, found), looked)))


def _beside(lidar: pe.Lidar, beams: Ints) -> Ints:
    """Beams of the same channel up to the next azimuth that was looked at, to either side."""
    reach = -(-lidar.beam_count // LOOKED_AT)
    channel, column = np.divmod(beams, _azimuths(lidar))
    columns = (column[:, None] + np.arange(-reach, reach + 1)) % _azimuths(lidar)
    return np.unique(channel[:, None] * _azimuths(lidar) + columns)


def _ends(
    lidar: pe.Lidar, seen: object | None, directions: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """Where beams end (N,) [m] and whether on the vehicle (N,), as it is seen from the sensor."""
    if seen is None or not len(directions):
        return np.full(len(directions), lidar.max_range), np.zeros(len(directions), bool)
    distance = seen.first_hit(directions).distance
    return np.minimum(distance, lidar.max_range), distance < lidar.max_range


def _room(lidar: pe.Lidar, shown: Ints) -> Floats:
    """(C,) solid angle from beam to beam in each channel, among those shown [sr]."""
    counts = np.bincount(shown // _azimuths(lidar), minlength=len(lidar.elevations))
    order = np.flatnonzero(counts)[np.argsort(lidar.elevations[counts > 0], kind="stable")]
    room = np.zeros(len(counts))
    if len(order) > 1:
        steps = np.diff(lidar.elevations[order])
        room[order] = (np.append(steps, steps[-1]) + np.append(steps[0], steps)) / 2.0
    else:
        room[order] = np.pi
    low, high = lidar.horizontal_fov
    return room * (high - low) / np.maximum(counts, 1)


def _azimuths(lidar: pe.Lidar) -> int:
    return len(lidar.azimuth_steps)


def _thinned(lidar: pe.Lidar, numbers: Ints, count: int) -> Ints:
    """Return at most `count` of ascending beam numbers: every k-th of each channel."""
    if len(numbers) <= count or count < 1:
        return numbers[: max(count, 0)]
    channel = numbers // _azimuths(lidar)
    rank = np.arange(len(numbers)) - np.searchsorted(channel, channel)
    kept = numbers
    for k in range(-(-len(numbers) // count), int(rank.max()) + 2):
        kept = numbers[rank % k == 0]
        if len(kept) <= count:
            break
    return _evenly(kept, count)


def _evenly(values: Ints, count: int) -> Ints:
    """Return at most `count` of the values, evenly spread, the first and the last among them."""
    if len(values) <= count:
        return values
    return values[np.linspace(0, len(values) - 1, max(count, 0)).round().astype(np.int64)]

"""Which of a LiDAR's beams are shown: a fair sample of them.

What is shown of beams that the vehicle stops is their true share among all beams of the sensor: one
in two hundred stopped looks like that, and not like a fan; and so does one in two.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..kinds import Lidar
from .casts import Cast, around, evenly
from .models import lidar_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

A_FEW, AZIMUTHS_OF_FEW = 5, 60
"""So many beams explain where a sensor looks; more hide what it looks at."""
FEWEST_AZIMUTHS = 8
"""A LiDAR with fewer has no channels to speak of: each beam has its own elevation."""


class ChannelMode(enum.StrEnum):
    """Of which channels beams are shown."""

    FEW = "FEW"
    ONE = "ONE"
    EVERY = "EVERY"
    ALL = "ALL"


@dataclass(frozen=True, slots=True)
class BeamChoice:
    """At most `budget` beams; of the `number`-th channel from below, or of every `number`-th."""

    budget: int
    channels: ChannelMode = ChannelMode.ALL
    number: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """Some beams of a mounted LiDAR.

    `directions` (N, 3) unit, ground frame; `ends` (N,) the vehicle or the maximum range [m];
    `stopped` (N,) whether it was the vehicle; `channel` (N,) its number; `share` the part of beams
    that are stopped, among all those that are meant.
    """

    directions: Floats
    ends: Floats
    stopped: NDArray[np.bool_]
    channel: Ints
    share: float


def shown_beams(found: Cast, choice: BeamChoice) -> Beams:
    """Return at most `budget` beams of a cast, stopped ones in their true share.

    That share is the sensor's; of one channel, that channel's own.
    """
    lidar, few = lidar_of(found.sensor), choice.channels == ChannelMode.FEW
    rows = np.flatnonzero(np.isin(found.rows, channels_of(lidar, choice)))
    stopped = found.stopped
    meant = stopped.reshape(len(found.rows), -1)
    meant = meant[rows] if choice.channels == ChannelMode.ONE else meant
    share = float(meant.mean()) if meant.size else 0.0
    budget = min(choice.budget, A_FEW * AZIMUTHS_OF_FEW) if few else choice.budget
    chosen = _fair(found, rows, share, budget)
    channel = found.rows[chosen // max(len(found.columns), 1)]
    return Beams(found.directions[chosen], found.ends[chosen], stopped[chosen], channel, share)


def channels_of(lidar: Lidar, choice: BeamChoice) -> Ints:
    """(C,) numbers of the channels that are shown, ascending."""
    count = len(lidar.elevations)
    if choice.channels == ChannelMode.ALL or len(lidar.azimuth_steps) < FEWEST_AZIMUTHS:
        return evenly(count, choice.budget)
    upwards = np.argsort(lidar.elevations, kind="stable")
    number = max(choice.number, 1)
    if choice.channels == ChannelMode.ONE:
        return upwards[[min(number, count) - 1]]
    if choice.channels == ChannelMode.EVERY:
        return np.sort(upwards[::number][: choice.budget])
    return _a_few(lidar.elevations, min(A_FEW, choice.budget))


def _a_few(elevations: Floats, count: int) -> Ints:
    """Channels nearest to evenly spread elevations: where a sensor looks, from top to bottom."""
    wanted = np.linspace(elevations.min(), elevations.max(), max(count, 1))
    return np.unique(np.abs(elevations[:, None] - wanted).argmin(axis=0))


def _fair(found: Cast, rows: Ints, share: float, budget: int) -> Ints:
    """Numbers within a cast: free beams in a regular pattern, and stopped ones by their share."""
    stopped, width = found.stopped, len(found.columns)
    columns = np.searchsorted(
        found.columns, around(lidar_of(found.sensor), budget // max(len(rows), 1))
    )
    columns = np.unique(np.minimum(columns, max(width - 1, 0)))
    pattern = (rows[:, None] * width + columns).ravel()
    of_rows = (rows[:, None] * width + np.arange(width)).ravel()
    free_count = min(round(budget * (1.0 - share)), int((~stopped[of_rows]).sum()))
    free = _some(free_count, pattern[~stopped[pattern]], np.flatnonzero(~stopped))
    wanted = round(len(free) * share / (1.0 - share)) if len(free) else budget
    room = budget - len(free)
    count = min(max(wanted, 1), max(room, 1)) if share > 0.0 else 0
    hit = _some(count, of_rows[stopped[of_rows]], np.flatnonzero(stopped))
    return np.concatenate([free[: budget - len(hit)], hit])


def _some(count: int, first: Ints, others: Ints) -> Ints:
    """At most `count` numbers, evenly from the first ones; from others when there are none."""
    pool = first if len(first) else others
    return pool[evenly(len(pool), count)]

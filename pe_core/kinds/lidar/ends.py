"""Where a LiDAR's beams end, as far as it is asked: only beams that matter are cast."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.raycast import Hits
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from .beams import BeamField, TurnedBeams
from .lattice import lattice_of
from .maybe import may_be_stopped
from .model import Lidar

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class KnownEnds:
    """Ends (B,) of all beams, known beforehand [m]."""

    ends: Floats

    @cached_property
    def longest(self) -> float:
        """The range [m]: no beam ends farther away."""
        return float(self.ends.max())

    @cached_property
    def stopped(self) -> Flags:
        """(B,) beams that end earlier."""
        return self.ends < self.longest

    @property
    def farthest(self) -> float:
        """No beam that is `stopped` ends farther away [m]."""
        return float(self.ends.max(where=self.stopped, initial=0.0))

    def some(self, beams: Ints) -> Floats:
        """(N,) ends of some beams [m]."""
        return self.ends[beams]


class LazyEnds:
    """Ends of a mounted LiDAR's beams, cast against a vehicle when they are asked for.

    Parameters
    ----------
    sensor : Sensor
    beams : TurnedBeams
        Its beams, at its orientation.
    vehicle : Vehicle
    """

    farthest = np.inf

    def __init__(self, sensor: Sensor, beams: TurnedBeams, vehicle: Vehicle) -> None:
        model = cast(Lidar, sensor.model)
        self._sensor, self._beams, self._vehicle = sensor, beams, vehicle
        self._seen = vehicle.seen_from(sensor.pose.position, model.sees_through_glass)
        count = model.beam_count
        self._hits = Hits(np.full(count, np.inf), np.full(count, -1))
        self._open = np.ones(count, bool)
        self.longest = model.max_range

    @cached_property
    def stopped(self) -> Flags:
        """(B,) beams that may end earlier than the range; no other does."""
        lattice = lattice_of(cast(Lidar, self._sensor.model))
        if lattice.slope_bounds is None:
            return np.ones(len(self._open), bool)
        axes = self._sensor.pose.ground_from_sensor
        flags = np.empty((len(lattice.channels), lattice.width), bool)
        flags[lattice.channels] = may_be_stopped(self._seen.seen, axes, lattice)
        return flags.reshape(-1)

    def some(self, beams: Ints) -> Floats:
        """(N,) ends of some beams [m]."""
        asked = np.zeros(len(self._open), bool)
        asked[beams] = True
        self._cast(np.flatnonzero(asked & self._open))
        return np.minimum(self._hits.distance[beams], self.longest)

    def field(self) -> BeamField:
        """Return all beams, cast."""
        self._cast(np.flatnonzero(self._open))
        ends = np.minimum(self._hits.distance, self.longest)
        return BeamField(self._beams.directions, ends, self.longest, self._hits, self._vehicle)

    def _cast(self, new: Ints) -> None:
        found = self._seen.first_hit(self._beams.some(new))
        self._hits.distance[new], self._hits.face[new] = found.distance, found.face
        self._open[new] = False


AnyEnds = KnownEnds | LazyEnds

"""Where a LiDAR's beams end, and which part of the vehicle stops them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from .definition import beam_directions, beam_ends
from .horizon import Slants, TopMap
from .model import Lidar
from .ties import without_zeros

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class BeamField:
    """The beams of a mounted LiDAR.

    `directions` (B, 3) unit, ground frame; `ends` (B,) [m]; `stopped_by` (B,) index of the vehicle
    part that stops the beam within its range, -1 where none does.
    """

    directions: Floats
    ends: Floats
    stopped_by: NDArray[np.int64]

    def stopped_count(self, part_names: tuple[str, ...]) -> dict[str, int]:
        """Stopped beams by part, most first."""
        counts = np.bincount(self.stopped_by[self.stopped_by >= 0], minlength=len(part_names))
        order = np.argsort(-counts, kind="stable")
        return {part_names[i]: int(counts[i]) for i in order if counts[i]}

    def counts(self, part_names: tuple[str, ...]) -> tuple[int, int, dict[str, int]]:
        """Beams, how many the vehicle stops, and by which parts."""
        stopped_by = self.stopped_count(part_names)
        return len(self.ends), sum(stopped_by.values()), stopped_by


def beam_field(sensor: Sensor, vehicle: Vehicle | None) -> BeamField:
    """Cast all beams of a LiDAR against the vehicle (None: nothing stops them)."""
    directions = beam_directions(sensor)
    max_range = cast(Lidar, sensor.model).max_range
    if vehicle is None:
        free = np.full(len(directions), -1)
        return BeamField(directions, np.full(len(directions), max_range), free)
    hits = vehicle.first_hit(sensor.pose.position, directions)
    stopped = hits.distance < max_range
    parts = np.asarray(vehicle.parts)[hits.face]
    return BeamField(directions, np.minimum(hits.distance, max_range), np.where(stopped, parts, -1))


def beam_counts(sensor: Sensor, vehicle: Vehicle | None) -> tuple[int, int, dict[str, int]]:
    """Beams of a sensor, how many the vehicle stops, and by which parts; zeros for a camera."""
    if sensor.kind != "lidar":
        return 0, 0, {}
    field = beam_field(sensor, vehicle)
    names = () if vehicle is None else tuple(vehicle.part_names)
    return field.counts(names)


@dataclass(frozen=True, slots=True)
class TurnedBeams:
    """A LiDAR's beams at one orientation: kept while the sensor moves without turning.

    `directions` (B, 3) unit, ground frame; `without_zeros` the same as the kernels take them;
    `slants` for drafts.
    """

    directions: Floats
    without_zeros: Floats
    slants: Slants

    @classmethod
    def of(cls, sensor: Sensor) -> TurnedBeams:
        """Turn the beams of a LiDAR."""
        directions = beam_directions(sensor)
        return cls(directions, without_zeros(directions), Slants.of(directions))


class BeamEnds:
    """Where the beams of LiDARs on a vehicle end: cast, or read from a map of its top as a draft.

    Parameters
    ----------
    vehicle : Vehicle or None
    """

    def __init__(self, vehicle: Vehicle | None) -> None:
        self._vehicle = vehicle

    @cached_property
    def _map(self) -> TopMap | None:
        return None if self._vehicle is None else TopMap(self._vehicle.triangles)

    def can_draft(self, sensor: Sensor) -> bool:
        """Whether there is a vehicle, and the sensor stands above its top surface."""
        if self._vehicle is None or self._map is None:
            return False
        return self._map.is_above(np.asarray(sensor.pose.position), self._vehicle.clearance)

    def of(self, sensor: Sensor, beams: TurnedBeams, draft: bool) -> Floats:
        """(B,) distance at which each beam ends [m]: as a draft where that is asked and can be."""
        if not (draft and self.can_draft(sensor)) or self._map is None:
            return beam_ends(sensor, beams.directions, self._vehicle)
        max_range = cast(Lidar, sensor.model).max_range
        return self._map.ends(np.asarray(sensor.pose.position), beams.slants, max_range)

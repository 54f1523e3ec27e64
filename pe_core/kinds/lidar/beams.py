"""Where a LiDAR's beams end, and which part of the vehicle stops them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import rotate
from ...scene.raycast import Hits
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import Stopped
from .definition import beam_directions
from .horizon import Slants, TopMap
from .model import Lidar
from .ties import without_zeros

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LARGEST_MAP_M2 = 200.0
"""A map of a larger vehicle (a lorry has 50 m2) takes seconds to draw; casting is as fast then."""


@dataclass(frozen=True)
class BeamField:
    """The beams of a mounted LiDAR, cast against a vehicle (None: nothing stops them).

    `directions` (B, 3) unit, ground frame; `ends` (B,) [m]; `stopped_by` (B,) index of the vehicle
    part that stops the beam within its range, -1 where none does.
    """

    directions: Floats
    ends: Floats
    _max_range: float
    _hits: Hits | None = None
    _vehicle: Vehicle | None = None

    @cached_property
    def stopped_by(self) -> NDArray[np.int64]:
        """(B,) part of the vehicle, or -1; worked out when it is asked for."""
        if self._hits is None or self._vehicle is None:
            return np.full(len(self.ends), -1)
        parts = np.asarray(self._vehicle.parts)[self._hits.face]
        return np.where(self._hits.distance < self._max_range, parts, -1)

    def stopped_count(self, part_names: tuple[str, ...]) -> dict[str, int]:
        """Stopped beams by part, most first."""
        counts = np.bincount(self.stopped_by[self.stopped_by >= 0], minlength=len(part_names))
        order = np.argsort(-counts, kind="stable")
        return {part_names[i]: int(counts[i]) for i in order if counts[i]}


def beam_field(
    sensor: Sensor, vehicle: Vehicle | None, directions: Floats | None = None
) -> BeamField:
    """Cast all beams of a LiDAR against the vehicle; `directions` if they are known already."""
    if directions is None:
        directions = beam_directions(sensor)
    max_range = cast(Lidar, sensor.model).max_range
    if vehicle is None:
        return BeamField(directions, np.full(len(directions), max_range), max_range)
    hits = vehicle.first_hit(sensor.pose.position, directions, sensor.model.sees_through_glass)
    ends = np.minimum(hits.distance, max_range)
    return BeamField(directions, ends, max_range, hits, vehicle)


def stopped_beams(field: BeamField, vehicle: Vehicle | None) -> Stopped:
    """Count a LiDAR's beams, those that the vehicle stops, and those by part."""
    names = () if vehicle is None else tuple(vehicle.part_names)
    by_part = field.stopped_count(names)
    return Stopped(len(field.ends), sum(by_part.values()), by_part)


@dataclass(frozen=True)
class TurnedBeams:
    """A LiDAR's beams at the orientation of `sensor`: kept while it moves without turning.

    Few are turned when they are asked for; all at once where many are.
    """

    sensor: Sensor

    @cached_property
    def directions(self) -> Floats:
        """(B, 3) unit directions, ground frame."""
        return beam_directions(self.sensor)

    @cached_property
    def _without_zeros(self) -> list[Floats]:
        return [np.ascontiguousarray(w) for w in without_zeros(self.directions).T]

    def expect(self, count: int) -> None:
        """Turn all beams now if more than there are will be asked for."""
        if count > cast(Lidar, self.sensor.model).beam_count:
            _ = self.directions

    def some(self, beams: Ints) -> Floats:
        """(N, 3) directions of some beams."""
        if "directions" in vars(self):
            return self.directions[beams]
        some = cast(Lidar, self.sensor.model).directions[beams]
        return rotate(self.sensor.pose.ground_from_sensor, some)

    def speeds(self, beams: Ints) -> list[Floats]:
        """Return the directions of some beams as kernels take them: an (N,) array an axis."""
        if "directions" in vars(self):
            return [np.take(w, beams) for w in self._without_zeros]
        x, y, z = np.ascontiguousarray(cast(Lidar, self.sensor.model).directions[beams].T)
        axes = self.sensor.pose.ground_from_sensor
        return [without_zeros(row[0] * x + row[1] * y + row[2] * z) for row in axes]

    @cached_property
    def slants(self) -> Slants:
        """For drafts alone: worked out when one is asked for."""
        return Slants.of(self.directions)


def _footprint(vehicle: Vehicle) -> float:
    """Area of the rectangle that the vehicle takes up seen from above [m2]."""
    (x0, y0, _), (x1, y1, _) = (corner.tolist() for corner in vehicle.bounds)
    return float((x1 - x0) * (y1 - y0))


class BeamEnds:
    """Where the beams of LiDARs on a vehicle end, read from a map of its top: a draft.

    Parameters
    ----------
    vehicle : Vehicle or None
    """

    def __init__(self, vehicle: Vehicle | None) -> None:
        self._vehicle = vehicle

    @cached_property
    def _map(self) -> TopMap | None:
        if self._vehicle is None or _footprint(self._vehicle) > LARGEST_MAP_M2:
            return None
        return TopMap(self._vehicle.triangles)

    def can_draft(self, sensor: Sensor) -> bool:
        """Whether there is a vehicle, none as large as a hall, and the sensor is above its top."""
        if self._vehicle is None or self._map is None:
            return False
        return self._map.is_above(np.asarray(sensor.pose.position), self._vehicle.clearance)

    def draft(self, sensor: Sensor, beams: TurnedBeams) -> Floats:
        """(B,) distance at which each beam of a sensor that `can_draft` is taken to end [m]."""
        assert self._map is not None
        max_range = cast(Lidar, sensor.model).max_range
        return self._map.ends(np.asarray(sensor.pose.position), beams.slants, max_range)

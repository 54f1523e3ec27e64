"""What turning and casting the beams of LiDARs on a vehicle gave, kept by name while it holds."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import cast

import numpy as np

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from .beams import BeamEnds, TurnedBeams
from .ends import AnyEnds, KnownEnds, LazyEnds
from .model import Lidar


@dataclass(frozen=True, slots=True)
class CastBeams:
    """Where a LiDAR's beams end, and whether that is a draft."""

    sensor: Sensor
    ends: AnyEnds
    is_draft: bool


class KnownBeams:
    """Beams of LiDARs on a vehicle; several samples of voxels may share them.

    Parameters
    ----------
    vehicle : Vehicle or None
    """

    def __init__(self, vehicle: Vehicle | None) -> None:
        self._vehicle, self._drafts = vehicle, BeamEnds(vehicle)
        self._turned: dict[str, tuple[Sensor, TurnedBeams]] = {}
        self._ended: dict[str, CastBeams] = {}
        """Both by the sensor's name, with the sensor they hold for: those of the last rig."""

    def turned(self, sensor: Sensor) -> TurnedBeams:
        """Return a LiDAR's beams, kept until it turns."""
        known = self._turned.get(sensor.name)
        if known and known[0].model is sensor.model and known[0].pose.rpy == sensor.pose.rpy:
            return known[1]
        beams = TurnedBeams(sensor)
        self._turned[sensor.name] = (sensor, beams)
        return beams

    def ended(self, sensor: Sensor, draft: bool) -> CastBeams:
        """Say where a LiDAR's beams end, kept until it moves; as a draft if that will do."""
        known = self._ended.get(sensor.name)
        if known and (draft or not known.is_draft) and is_same(known.sensor, sensor):
            return known
        found = self._ended[sensor.name] = self._end(sensor, draft)
        return found

    def endless(self, sensor: Sensor) -> KnownEnds:
        """Say where a LiDAR's beams end where there is no vehicle: at its range."""
        model = cast(Lidar, sensor.model)
        return KnownEnds(np.full(model.beam_count, model.max_range))

    def _end(self, sensor: Sensor, draft: bool) -> CastBeams:
        beams = self.turned(sensor)
        if draft and self._drafts.can_draft(sensor):
            return CastBeams(sensor, KnownEnds(self._drafts.draft(sensor, beams)), True)
        if self._vehicle is None:
            return CastBeams(sensor, self.endless(sensor), False)
        return CastBeams(sensor, LazyEnds(sensor, beams, self._vehicle), False)

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        names = {sensor.name for sensor in sensors}
        self._turned = {name: kept for name, kept in self._turned.items() if name in names}
        self._ended = {name: kept for name, kept in self._ended.items() if name in names}


def is_same(one: Sensor, other: Sensor) -> bool:
    """Whether two sensors measure the same."""
    return one.model is other.model and one.pose == other.pose

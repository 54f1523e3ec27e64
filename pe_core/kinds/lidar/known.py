"""What turning and casting the beams of LiDARs on a vehicle gave, kept by name while it holds."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import Floats
from .beams import BeamEnds, BeamField, TurnedBeams, beam_field


@dataclass(frozen=True, slots=True)
class CastBeams:
    """Where a LiDAR's beams end: (B,) [m]; `field` None where that is a draft."""

    sensor: Sensor
    ends: Floats
    field: BeamField | None


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
        beams = TurnedBeams.of(sensor)
        self._turned[sensor.name] = (sensor, beams)
        return beams

    def ended(self, sensor: Sensor, draft: bool) -> CastBeams:
        """Say where a LiDAR's beams end, kept until it moves; as a draft if that will do."""
        known = self._ended.get(sensor.name)
        fits = known and (draft or known.field) and known.sensor.model is sensor.model
        if known and fits and known.sensor.pose == sensor.pose:
            return known
        found = self._ended[sensor.name] = self._end(sensor, draft)
        return found

    def _end(self, sensor: Sensor, draft: bool) -> CastBeams:
        beams = self.turned(sensor)
        if draft and self._drafts.can_draft(sensor):
            return CastBeams(sensor, self._drafts.draft(sensor, beams), None)
        field = beam_field(sensor, self._vehicle, beams.directions)
        return CastBeams(sensor, field.ends, field)

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        names = {sensor.name for sensor in sensors}
        self._turned = {name: kept for name, kept in self._turned.items() if name in names}
        self._ended = {name: kept for name, kept in self._ended.items() if name in names}

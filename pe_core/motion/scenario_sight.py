"""What a rig measures of the watched bodies of a scenario: AP and tracks, frame by frame."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats
from ..metric.entropy import H_BLIND, ap_of_entropy
from ..metric.frames import RATE_HZ
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..scoring.targets.object_metric import FusedObjects
from ..sensors import ObjectMeasurementCache, PerceptionModel
from .clock import FrameClock, frame_rate, streams
from .scan import factor_of
from .scenario import Scenario
from .scenes import ScenarioScenes, scenario_scenes
from .tracks import Confirmation


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """The probability (W, K) that tracks are confirmed by each frame of a scenario, and that M of
    the last N frames find the bodies."""

    confirmed: Floats
    kept: Floats


class ScenarioSight:
    """Measures the W watched bodies of a scenario at its K frames.

    `rates`: Frames in a second by kind of sensor [Hz]; a kind without one has the scenario's.
    `positions` (W, K, 2): Of the bodies in the ground frame [m].
    """

    def __init__(
        self,
        scenario: Scenario,
        rig: Rig,
        vehicle: Vehicle | None,
        model: PerceptionModel,
        rates: Mapping[str, float],
    ) -> None:
        where, headings = scenario.positions(vehicle)
        watched = [k for k, actor in enumerate(scenario.actors) if actor.watched]
        scenes = scenario_scenes(scenario, where, headings, rig)
        self._scenario = scenario
        self._rig = rig
        self.positions = where[watched]
        self._bearings = {s.name: _bearings(s, self.positions) for s in rig}
        self._turns_hz = {s.name: rates.get(s.kind, RATE_HZ) for s in rig}
        self._frames_hz = {s.name: frame_rate(s, rates, RATE_HZ) for s in rig}
        self._fused = FusedObjects(scenes.watched, np.ones(scenes.rows.size), model)
        self._fused.check(rig)
        self._measured = {
            name: self._at_last_frame(rig[name], m)
            for name, m in _measured(rig, scenes, vehicle).items()
        }

    def ap(self, members: list[str] | None = None) -> Floats:
        """Return AP (W, K) of the last frames of some sensors, all by default; 0 where nothing sees
        the body."""
        entropies, visible = self._fused.entropies(self._rig, self._measured, members)
        found = np.where(visible & (entropies < H_BLIND), ap_of_entropy(entropies), 0.0)
        return np.asarray(found.reshape(self.positions.shape[:2]))

    def track(self, confirmation: Confirmation) -> Track:
        """Return the tracks, by the best stream at each frame (`clock`)."""
        confirmed = []
        kept = []
        for rate, names in streams(self._rig, self._frames_hz).items():
            clock = self._clock(rate)
            found = self.ap(names)[:, clock.frames]
            confirmed.append(clock.held(confirmation.confirmed(found, clock.frame_s)))
            kept.append(clock.held(confirmation.kept(found, clock.frame_s)))
        return Track(np.max(confirmed, axis=0), np.max(kept, axis=0))

    def _clock(self, rate_hz: float) -> FrameClock:
        return FrameClock.of(len(self._scenario.times), RATE_HZ, rate_hz)

    def _at_last_frame(self, sensor: Sensor, m: Floats) -> Floats:
        """Return m (W * K) of a sensor's last frame, with the factor of its scan, from m (W, K)."""
        clock = self._clock(self._frames_hz[sensor.name])
        bearings = self._bearings[sensor.name]
        at_frames = m * factor_of(sensor, bearings, 1.0 / RATE_HZ, self._turns_hz[sensor.name])
        return np.asarray(clock.held(at_frames[:, clock.frames]).ravel())


def _measured(rig: Rig, scenes: ScenarioScenes, vehicle: Vehicle | None) -> dict[str, Floats]:
    """Return m (W, K) of the watched bodies by sensor."""
    measured = ObjectMeasurementCache(scenes.objects, vehicle, True).measure(rig)
    return {sensor.name: measured[sensor.name][scenes.rows] for sensor in rig}


def _bearings(sensor: Sensor, where: Floats) -> Floats:
    """Return the bearings (W, K) of positions from a sensor in the ground frame [rad]."""
    away = where - np.array(sensor.pose.position[:2])
    return np.unwrap(np.arctan2(away[..., 1], away[..., 0]), axis=1)

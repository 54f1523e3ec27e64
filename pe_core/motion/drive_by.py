"""The drive-by: what a rig sees of the bodies of a scenario at each frame, and when it is enough.

A frame is a scene of objects, measured by the kernels of objects in traffic. AP follows by eqs. 4
to 8 and counts as the probability that a detector finds the body at the frame.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.values import rounded
from ..metric.frames import RATE_HZ
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from ..sensors import PerceptionModel
from .scenario import CHANCE, Scenario, outline
from .scenario_sight import ScenarioSight
from .tracks import KEPT, Confirmation, first_frame, longest_run

CHANCES = (CHANCE, 0.99)
"""Probabilities of a confirmed track whose moments are told."""


@dataclass(frozen=True, slots=True)
class Moment:
    """When something is so, and how far the body is from the vehicle's rectangle then [s, m]."""

    time_s: float
    distance_m: float


@dataclass(frozen=True, slots=True)
class SeenBody:
    """What a rig sees of a watched body.

    `ap, confirmed` (K,): AP of each sensor's last frame at each frame, and the probability that its
        track is confirmed by then.
    `by_sensor`: AP of each sensor alone.
    `positions` (K, 2): In the ground frame [m].
    `moments`: When it is confirmed, by probability; None: never in the scenario.
    `lost_s`: Longest time for which it is lost after it was confirmed, by `CHANCE` [s].
    `margin_s`: How long before the last moment at which the vehicle can stop, less the time that
        the scenario asks for [s]; negative: too late. None: never confirmed.
    """

    name: str
    ap: Floats
    confirmed: Floats
    by_sensor: Mapping[str, Floats]
    positions: Floats
    moments: Mapping[float, Moment | None]
    lost_s: float
    margin_s: float | None

    @property
    def is_met(self) -> bool:
        """Whether it is confirmed in time."""
        return self.margin_s is not None and self.margin_s >= 0.0

    @property
    def shown_margin_s(self) -> float | None:
        """The margin as it is shown, rounded to the safe side [s]."""
        return shown_margin(self.margin_s)

    def summary(self) -> dict[str, Any]:
        """Return verdict and moments as plain JSON data."""
        moments = {f"{p:g}": None if at is None else asdict(at) for p, at in self.moments.items()}
        verdict = {"name": self.name, "met": self.is_met, "margin_s": self.margin_s}
        return verdict | {"confirmed": moments, "lost_s": self.lost_s}

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain JSON data."""
        return self.summary() | {
            "ap": _listed(self.ap),
            "probability": _listed(self.confirmed),
            "ap_by_sensor": {name: _listed(ap) for name, ap in self.by_sensor.items()},
            "x": _listed(self.positions[:, 0]),
            "y": _listed(self.positions[:, 1]),
        }


@dataclass(frozen=True, slots=True)
class DriveBy:
    """A scenario as a rig sees it, body by body."""

    scenario: Scenario
    bodies: tuple[SeenBody, ...]

    @property
    def is_met(self) -> bool:
        """Whether each watched body is confirmed in time."""
        return all(body.is_met for body in self.bodies)

    @property
    def margin_s(self) -> float | None:
        """The smallest margin [s]; None where a body is never confirmed."""
        margins = [body.margin_s for body in self.bodies]
        known = [margin for margin in margins if margin is not None]
        return min(known) if len(known) == len(margins) else None

    def summary(self) -> dict[str, Any]:
        """Return verdicts and moments, with the stop that they are held to, as plain JSON data."""
        return {
            "name": self.scenario.name,
            "title": self.scenario.title,
            "met": self.is_met,
            "margin_s": self.margin_s,
            "shown_margin_s": shown_margin(self.margin_s),
            "brake_s": rounded(self.scenario.brake_s),
            "stop_m": rounded(self.scenario.stop_m),
            "bodies": [body.summary() for body in self.bodies],
        }

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain JSON data, frame by frame."""
        bodies = [body.to_dict() for body in self.bodies]
        return self.summary() | {"times_s": _listed(self.scenario.times), "bodies": bodies}


def drive_by(
    scenario: Scenario,
    rig: Rig,
    vehicle: Vehicle | None = None,
    model: PerceptionModel | None = None,
    confirmation: Confirmation | None = None,
    rates: Mapping[str, float] | None = None,
) -> DriveBy:
    """Return a scenario as a rig sees it.

    `rates` are the frames of sensors by kind [Hz]; a kind without one has the scenario's. A
    sensor of a lower rate than the scenario's has fewer frames that confirm a track (`clock`).

    `InputError` when a sensor has an AP curve of its own, or a class has none.
    """
    confirmation = confirmation or Confirmation()
    sight = ScenarioSight(scenario, rig, vehicle, model or PerceptionModel(), rates=rates or {})
    whole = sight.ap()
    alone = {sensor.name: sight.ap([sensor.name]) for sensor in rig}
    track = sight.track(confirmation)
    away = _distance(sight.positions, vehicle)
    bodies = []
    for k, actor in enumerate(actor for actor in scenario.actors if actor.watched):
        moments = _moments(scenario, track.confirmed[k], away[k])
        margin_s, lost_s = _margin_and_loss(scenario, track.confirmed[k], track.kept[k])
        bodies.append(
            SeenBody(
                name=actor.name,
                ap=whole[k],
                confirmed=track.confirmed[k],
                by_sensor={name: found[k] for name, found in alone.items()},
                positions=sight.positions[k],
                moments=moments,
                lost_s=lost_s,
                margin_s=margin_s,
            )
        )
    return DriveBy(scenario, tuple(bodies))


def _moments(scenario: Scenario, confirmed: Floats, away: Floats) -> dict[float, Moment | None]:
    """Return when a track is confirmed by each probability; `away` (K,) is its distance [m]."""
    moments: dict[float, Moment | None] = {}
    for chance in CHANCES:
        k = first_frame(confirmed, chance)
        at = None if k is None else Moment(float(scenario.times[k]), rounded(float(away[k])))
        moments[chance] = at
    return moments


def _margin_and_loss(
    scenario: Scenario, confirmed: Floats, kept: Floats
) -> tuple[float | None, float]:
    """Return a track's margin (None: never confirmed), and for how long it is lost [s]."""
    first = first_frame(confirmed, CHANCE)
    if first is None:
        return None, 0.0
    margin_s = scenario.brake_s - scenario.before_s - float(scenario.times[first])
    return rounded(margin_s), rounded(longest_run(kept[first:] < KEPT) / RATE_HZ)


def _distance(positions: Floats, vehicle: Vehicle | None) -> Floats:
    """Return distances (..., K) of points from the vehicle's rectangle on the ground [m]."""
    low, high = outline(vehicle)
    outside = np.maximum(np.maximum(low - positions, positions - high), 0.0)
    return np.asarray(np.hypot(outside[..., 0], outside[..., 1]))


def shown_margin(margin_s: float | None) -> float | None:
    """Return a margin rounded to the safe side, to 0.1 s."""
    return None if margin_s is None else math.floor(margin_s * 10.0) / 10.0


def _listed(values: Floats) -> list[float]:
    return [rounded(value) for value in values.tolist()]

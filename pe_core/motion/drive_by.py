"""The drive-by: what a rig sees of the bodies of a story at each frame, and when it is enough.

A frame is a scene of objects, measured by the kernels of objects in traffic. AP follows by eqs. 4
to 8 and counts as the probability that a detector finds the body at the frame.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.values import rounded
from ..metric.entropy import H_BLIND, ap_of_entropy
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..scoring.targets.object_metric import FusedObjects
from ..sensors import ObjectMeasurementCache, PerceptionModel, kind_of
from .scan import scan_factor
from .story import OTHER, Story
from .tracks import Confirmation

CHANCES = (0.9, 0.99)


@dataclass(frozen=True, slots=True)
class Moment:
    """When something is so, and how far the body is from the vehicle's anchor plane then [s, m]."""

    time_s: float
    distance_m: float


@dataclass(frozen=True, slots=True)
class SeenBody:
    """What a rig sees of a watched body.

    Attributes
    ----------
    name : str
    ap, confirmed : (K,) float
        AP at each frame, and the probability that its track is confirmed by then.
    by_sensor : mapping of str to (K,) float
        AP of each sensor alone.
    positions : (K, 2) float
        In the ground frame [m].
    moments : mapping of float to Moment or None
        When it is confirmed, by probability; None: never in the story.
    lost_s : float
        Longest time for which it is lost after it was confirmed, by the story's probability [s].
    margin_s : float or None
        How long before the last moment at which the vehicle can stop, less the time that the story
        asks for [s]; negative: too late. None: never confirmed.
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

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        moments = {f"{chance:g}": _moment(at) for chance, at in self.moments.items()}
        return {
            "name": self.name,
            "met": self.is_met,
            "margin_s": self.margin_s,
            "confirmed": moments,
            "lost_s": self.lost_s,
            "ap": _listed(self.ap),
            "probability": _listed(self.confirmed),
            "ap_by_sensor": {name: _listed(ap) for name, ap in self.by_sensor.items()},
            "x": _listed(self.positions[:, 0]),
            "y": _listed(self.positions[:, 1]),
        }


@dataclass(frozen=True, slots=True)
class DriveBy:
    """A story as a rig sees it, body by body."""

    story: Story
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
        """Return verdict and moments of each body, without its frames, as plain JSON data."""
        frames = ("ap", "probability", "ap_by_sensor", "x", "y")
        data = self.to_dict()
        del data["times_s"]
        bodies = [{k: v for k, v in b.items() if k not in frames} for b in data["bodies"]]
        return data | {"bodies": bodies, "shown_margin_s": shown_margin(self.margin_s)}

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data, with the stop that it is held to."""
        return {
            "name": self.story.name,
            "title": self.story.title,
            "met": self.is_met,
            "margin_s": self.margin_s,
            "brake_s": rounded(self.story.brake_s),
            "times_s": _listed(self.story.times),
            "bodies": [body.to_dict() for body in self.bodies],
        }


def drive_by(
    story: Story,
    rig: Rig,
    vehicle: Vehicle | None = None,
    model: PerceptionModel | None = None,
    confirmation: Confirmation | None = None,
) -> DriveBy:
    """Return a story as a rig sees it.

    Raises
    ------
    InputError
        When a sensor has an AP curve of its own, or a class has none.
    """
    confirmation = confirmation or Confirmation()
    objects, count = story.objects(vehicle), len(story.times)
    where, _ = story.positions(vehicle)
    watched = np.repeat([actor.watched for actor in story.actors], count)
    named = objects.labels != (
        objects.class_names.index(OTHER) if OTHER in objects.class_names else -1
    )
    fused = FusedObjects(objects, (watched & named).astype(float), model or PerceptionModel())
    fused.check(rig)
    whole_scan = ObjectMeasurementCache(objects, vehicle, True).measure(rig)
    measured = {s.name: whole_scan[s.name] * _scanned(s, where, story).ravel() for s in rig}

    def ap(members: list[str] | None) -> Floats:
        entropies, visible = fused.entropies(rig, measured, members)
        found = np.where(visible & (entropies < H_BLIND), ap_of_entropy(entropies), 0.0)
        return found.reshape(len(story.actors), count)

    whole, alone = ap(None), {sensor.name: ap([sensor.name]) for sensor in rig}
    bodies = []
    for k, actor in enumerate(story.actors):
        if actor.watched:
            by_sensor = {name: found[k] for name, found in alone.items()}
            bodies.append(
                _seen(story, actor.name, whole[k], by_sensor, where[k], vehicle, confirmation)
            )
    return DriveBy(story, tuple(bodies))


def _scanned(sensor: Sensor, where: Floats, story: Story) -> Floats:
    """Return the factor (A, K) of m by the scan of a LiDAR, eq. T3; 1 of other kinds.

    Which way it turns is not known: the lower factor of both is taken.
    """
    if not kind_of(sensor).counts_points:
        return np.ones(where.shape[:2])
    away = where - np.array(sensor.pose.position[:2])
    bearing = np.unwrap(np.arctan2(away[..., 1], away[..., 0]), axis=1)
    rate = np.gradient(bearing, 1.0 / story.rate_hz, axis=1)
    return scan_factor(-np.abs(rate), story.rate_hz)


def _seen(
    story: Story,
    name: str,
    ap: Floats,
    by_sensor: Mapping[str, Floats],
    positions: Floats,
    vehicle: Vehicle | None,
    confirmation: Confirmation,
) -> SeenBody:
    times = story.times
    confirmed = confirmation.confirmed(ap)
    away = _distance(positions, vehicle)
    moments: dict[float, Moment | None] = {}
    for chance in sorted({*CHANCES, story.chance}):
        k = confirmation.first(ap, chance)
        moments[chance] = None if k is None else Moment(float(times[k]), rounded(float(away[k])))
    first, margin, lost = confirmation.first(ap, story.chance), None, 0.0
    if first is not None:
        margin = rounded(story.brake_s - story.before_s - float(times[first]))
        lost = rounded(confirmation.longest_loss(ap, first) / story.rate_hz)
    return SeenBody(name, ap, confirmed, by_sensor, positions, moments, lost, margin)


def _distance(positions: Floats, vehicle: Vehicle | None) -> Floats:
    """Return distances (K,) of points from the vehicle's rectangle on the ground [m]."""
    low, high = ((0.0, 0.0), (0.0, 0.0)) if vehicle is None else (b[:2] for b in vehicle.bounds)
    outside = np.maximum(np.maximum(np.asarray(low) - positions, positions - np.asarray(high)), 0.0)
    return np.asarray(np.hypot(*outside.T))


def shown_margin(margin_s: float | None) -> float | None:
    """Return a margin rounded to the safe side, to 0.1 s."""
    return None if margin_s is None else math.floor(margin_s * 10.0) / 10.0


def _moment(at: Moment | None) -> dict[str, float] | None:
    return None if at is None else {"time_s": at.time_s, "distance_m": at.distance_m}


def _listed(values: Floats) -> list[float]:
    return [rounded(value) for value in values.tolist()]

"""The drive-by: what a rig sees of the bodies of a story at each frame, and when it is enough.

A frame is a scene of objects, measured by the kernels of objects in traffic. AP follows by eqs. 4
to 8 and counts as the probability that a detector finds the body at the frame.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.values import rounded
from ..metric.entropy import H_BLIND, ap_of_entropy
from ..scene.objects import Objects
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..scoring.targets.object_metric import FusedObjects
from ..sensors import ObjectMeasurementCache, PerceptionModel
from .scan import exposed, factor_of, seam
from .story import Story, outline
from .tracks import Confirmation, first_frame

CHANCES = (0.9, 0.99)


@dataclass(frozen=True, slots=True)
class Moment:
    """When something is so, and how far the body is from the vehicle's rectangle then [s, m]."""

    time_s: float
    distance_m: float


@dataclass(frozen=True, slots=True)
class SeenBody:
    """What a rig sees of a watched body.

    `ap, confirmed` (K,): AP at each frame, and the probability that its track is confirmed by then.
    `by_sensor`: AP of each sensor alone.
    `positions` (K, 2): In the ground frame [m].
    `moments`: When it is confirmed, by probability; None: never in the story.
    `lost_s`: Longest time for which it is lost after it was confirmed, by the story's probability
        [s].
    `seam_m, seam_of`: The widest distance at which two sensors that both see it see it apart (eq.
        T4), and which two; None: not known.
    `margin_s`: How long before the last moment at which the vehicle can stop, less the time that
        the story asks for [s]; negative: too late. None: never confirmed.
    """

    name: str
    ap: Floats
    confirmed: Floats
    by_sensor: Mapping[str, Floats]
    positions: Floats
    moments: Mapping[float, Moment | None]
    lost_s: float
    margin_s: float | None
    seam_m: float | None = None
    seam_of: tuple[str, ...] = ()

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
        seam = {} if self.seam_m is None else {"seam_m": self.seam_m, "seam_of": [*self.seam_of]}
        return verdict | {"confirmed": moments, "lost_s": self.lost_s} | seam

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
        """Return verdicts and moments, with the stop that they are held to, as plain JSON data."""
        return {
            "name": self.story.name,
            "title": self.story.title,
            "met": self.is_met,
            "margin_s": self.margin_s,
            "shown_margin_s": shown_margin(self.margin_s),
            "brake_s": rounded(self.story.brake_s),
            "stop_m": rounded(self.story.stop_m),
            "bodies": [body.summary() for body in self.bodies],
        }

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain JSON data, frame by frame."""
        bodies = [body.to_dict() for body in self.bodies]
        return self.summary() | {"times_s": _listed(self.story.times), "bodies": bodies}


def drive_by(
    story: Story,
    rig: Rig,
    vehicle: Vehicle | None = None,
    model: PerceptionModel | None = None,
    confirmation: Confirmation | None = None,
    rates: Mapping[str, float] | None = None,
) -> DriveBy:
    """Return a story as a rig sees it.

    `rates` are those of scans and exposures by kind [Hz]; a kind without one has the story's.

    `InputError` when a sensor has an AP curve of its own, or a class has none.
    """
    confirmation = confirmation or Confirmation()
    where, headings = story.positions(vehicle)
    objects, count = story.objects(where, headings), len(story.times)
    watched = np.repeat([float(actor.watched) for actor in story.actors], count)
    fused = FusedObjects(objects, watched, model or PerceptionModel())
    fused.check(rig)
    scans = _measured(rig, objects, vehicle, count)
    hz = {s.name: (rates or {}).get(s.kind, story.rate_hz) for s in rig}
    bearings, speeds = {s.name: _bearings(s, where) for s in rig}, story.speeds
    measured = {
        s.name: scans[s.name]
        * factor_of(s, bearings[s.name], 1.0 / story.rate_hz, hz[s.name]).ravel()
        for s in rig
    }

    def ap(members: list[str] | None) -> Floats:
        entropies, visible = fused.entropies(rig, measured, members)
        found = np.where(visible & (entropies < H_BLIND), ap_of_entropy(entropies), 0.0)
        return confirmation.in_time(found.reshape(len(story.actors), count), speeds)

    whole, alone = ap(None), {sensor.name: ap([sensor.name]) for sensor in rig}
    seams = {
        (one.name, other.name): apart * ((alone[one.name] > 0.0) & (alone[other.name] > 0.0))
        for one, other in combinations(rig, 2)
        if (apart := seam((one, other), bearings, hz, speeds)) is not None
    }
    bodies = []
    for k, actor in enumerate(story.actors):
        if actor.watched:
            by_sensor = {name: found[k] for name, found in alone.items()}
            body = _seen(story, actor.name, whole[k], by_sensor, where[k], vehicle, confirmation)
            if seams:
                pair = max(seams, key=lambda each: seams[each][k].max())
                widest = rounded(float(seams[pair][k].max()))
                body = replace(body, seam_m=widest, seam_of=pair)
            bodies.append(body)
    return DriveBy(story, tuple(bodies))


def _measured(rig: Rig, objects: Objects, vehicle: Vehicle | None, count: int) -> dict[str, Floats]:
    """Return m of objects, actor by actor with a number of frames each, by sensor. A pattern that
    takes several frames has an exposure a frame (`scan.exposed`)."""
    rows, cache = np.arange(len(objects)), ObjectMeasurementCache(objects, vehicle, True)
    most = max(sensor.scan.exposures for sensor in rig)
    by_exposure = [cache.measure(Rig([exposed(s, k) for s in rig])) for k in range(most)]
    return {
        s.name: np.stack([m[s.name] for m in by_exposure])[rows % count % s.scan.exposures, rows]
        for s in rig
    }


def _bearings(sensor: Sensor, where: Floats) -> Floats:
    """Return the bearings (A, K) of positions from a sensor in the ground frame [rad]."""
    away = where - np.array(sensor.pose.position[:2])
    return np.unwrap(np.arctan2(away[..., 1], away[..., 0]), axis=1)


def _seen(
    story: Story,
    name: str,
    ap: Floats,
    by_sensor: Mapping[str, Floats],
    positions: Floats,
    vehicle: Vehicle | None,
    confirmation: Confirmation,
) -> SeenBody:
    confirmed, away = confirmation.confirmed(ap), _distance(positions, vehicle)
    moments: dict[float, Moment | None] = {}
    first, margin, lost = first_frame(confirmed, story.chance), None, 0.0
    for chance in sorted({*CHANCES, story.chance}):
        k = first_frame(confirmed, chance)
        at = None if k is None else Moment(float(story.times[k]), rounded(float(away[k])))
        moments[chance] = at
    if first is not None:
        margin = rounded(story.brake_s - story.before_s - float(story.times[first]))
        lost = rounded(confirmation.longest_loss(ap, first) / story.rate_hz)
    return SeenBody(name, ap, confirmed, by_sensor, positions, moments, lost, margin)


def _distance(positions: Floats, vehicle: Vehicle | None) -> Floats:
    """Return distances (K,) of points from the vehicle's rectangle on the ground [m]."""
    low, high = outline(vehicle)
    outside = np.maximum(np.maximum(low - positions, positions - high), 0.0)
    return np.asarray(np.hypot(*outside.T))


def shown_margin(margin_s: float | None) -> float | None:
    """Return a margin rounded to the safe side, to 0.1 s."""
    return None if margin_s is None else math.floor(margin_s * 10.0) / 10.0


def _listed(values: Floats) -> list[float]:
    return [rounded(value) for value in values.tolist()]

"""How far and how well a rig sees, in the figures that words are made of."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ..errors import InputError, shown
from ..prior.prior import Prior
from ..scene.sensors import Rig
from ..sight import BlindGround, Reach, SeenShares, Sight, shown_end

USUAL_CLASS = "pedestrian"
"""Whose reach is told unless another class is asked for."""
SIDES = {"front": "ahead", "rear": "behind", "left": "left", "right": "right"}
"""Sides of the vehicle in words."""
BEARINGS = {"front": 0.0, "rear": math.pi, "left": math.pi / 2.0, "right": -math.pi / 2.0}
"""Where they are, counter-clockwise from straight ahead [rad]."""
ANY_CLASS = "any"
"""What the one class of a prior without classes is called."""
CLASSES_NAMED = 8
BLIND_TO_M = 0.5
"""Blind ground is told for what is so tall, a kerb's post or a small child: flat ground is seen in
rings only, far out."""


@dataclass(frozen=True, slots=True)
class Outlook:
    """What `Sight` tells of a rig.

    Attributes
    ----------
    expected_ap : dict of float
        AP that is expected, by class.
    shares : SeenShares
    reach : Reach
        Of one class.
    blind : BlindGround
        To what is half a metre tall (or as tall as the space's lowest layer).
    """

    expected_ap: Mapping[str, float]
    shares: SeenShares
    reach: Reach
    blind: BlindGround

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data, without the outlines of blind ground."""
        return {
            "expected_ap": dict(self.expected_ap),
            "seen_by_at_least": list(self.shares.by_number),
            "seen_by_sensor": {name: dict(own) for name, own in self.shares.zones.items()},
            "reach": _reach_dict(self.reach),
            "blind": _blind_dict(self.blind),
        }


def outlook(sight: Sight, rig: Rig, class_name: str | None = None) -> Outlook:
    """Look round with a rig.

    Parameters
    ----------
    sight : Sight
    rig : Rig
    class_name : str, optional
        Whose reach is told; pedestrians' by default, the first class's where there are none.

    Raises
    ------
    InputError
        When the prior has no class of that name.
    """
    name = class_of(sight.prior, class_name)
    tall = max(BLIND_TO_M, sight.space.z[0])
    return Outlook(
        sight.expected_ap(rig),
        sight.shares(rig),
        sight.reach(rig, name),
        sight.blind(rig, tall),
    )


def class_of(prior: Prior, name: str | None) -> str:
    """Return the class whose reach is told; `InputError` where the prior has none of that name."""
    names = prior.class_names
    if name is None:
        return USUAL_CLASS if USUAL_CLASS in names else names[0]
    if name not in names:
        raise InputError("prior", "class", f"one of {', '.join(names)}", shown(name))
    return name


def outlook_words(found: Outlook, of_voxels: bool = True) -> Iterator[str]:
    """Yield what an outlook tells, in short lines; AP and reach are of voxels."""
    if not of_voxels:
        yield _blind_words(found.blind)
        return
    each = [f"{name} {ap:.2f}" for name, ap in found.expected_ap.items()]
    more = ["..."] if len(each) > CLASSES_NAMED else []
    yield f"expected AP: {', '.join(each[:CLASSES_NAMED] + more)}"
    yield _reach_words(found.reach)
    yield _blind_words(found.blind)


def _reach_words(reach: Reach) -> str:
    what = f"{_one(reach.class_name)} is found (AP {reach.ap:g} or more)"
    ways = {side: _reach_to(reach, side) for side in SIDES}
    if not any(ways.values()):
        return f"{what} nowhere ahead, behind, left or right"
    return f"{what} up to " + ", ".join(f"{way or 'nowhere'} {SIDES[s]}" for s, way in ways.items())


def _reach_to(reach: Reach, side: str) -> str:
    """Return the reach along the bearing nearest to a side; empty where there is none."""
    away = [abs(math.remainder(b - BEARINGS[side], math.tau)) for b in reach.bearings.tolist()]
    k = away.index(min(away))
    distance, limit = float(reach.distance[k]), float(reach.limit[k])
    if distance <= 0.0:
        return ""
    return f"{distance:.0f} m{' and more' if distance >= limit else ''}"


def _one(class_name: str) -> str:
    """Return "a pedestrian", "an object"."""
    noun = "object" if class_name == ANY_CLASS else class_name
    return f"{'an' if noun[:1].lower() in 'aeiou' else 'a'} {noun}"


def _blind_words(blind: BlindGround) -> str:
    what = f"blind to what is {blind.height:g} m tall"
    if all(end == 0.0 for end in blind.zone.values()):
        return f"{what} nowhere at the body"
    ways = (f"{_blind_to(blind, side)} {words}" for side, words in SIDES.items())
    return f"{what}, from the body: {', '.join(ways)}"


def _blind_to(blind: BlindGround, side: str) -> str:
    """Say how far the blind ground that begins at the body reaches to a side."""
    end = blind.zone[side]
    if end == 0.0:
        return "none"
    return f"beyond {blind.within:g} m" if end is None else f"to {shown_end(end):.1f} m"


def _reach_dict(reach: Reach) -> dict[str, Any]:
    return {
        "class": reach.class_name,
        "ap": reach.ap,
        "bearings_deg": [round(math.degrees(b), 6) for b in reach.bearings],
        "distance_m": reach.distance.tolist(),
        "limit_m": reach.limit.tolist(),
        "per_sensor_m": {name: own.tolist() for name, own in reach.per_sensor.items()},
    }


def _blind_dict(blind: BlindGround) -> dict[str, Any]:
    spots = {
        side: None if spot is None else {"point": list(spot.point), "distance_m": spot.distance}
        for side, spot in blind.nearest.items()
    }
    return {
        "height_m": blind.height,
        "within_m": blind.within,
        "area_m2": blind.area,
        "nearest": spots,
        "zone_m": dict(blind.zone),
        "seen_from_m": dict(blind.seen_from),
    }

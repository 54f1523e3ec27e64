"""Reach, blind ground and expected AP of a rig: the figures, and their description in sentences."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pe_core.base.values import choice, error_text
from pe_core.prior.prior import Prior
from pe_core.scene.rig import Rig
from pe_core.scoring import sight
from pe_core.scoring.score import (
    FAR_M,
    FARTHEST_M,
    NEAR_M,
    FoundClass,
    ObjectScore,
    PartScore,
    Score,
)
from pe_core.search.rig_view import blind_height
from pe_tools.wording import percent

from .advice import Advice
from .warnings import hidden_sensors, hidden_words

USUAL_CLASS = "pedestrian"  # Class of the reach unless the user chooses another
SIDES = {"front": "ahead", "rear": "behind", "left": "left", "right": "right"}
"""Text for each side of the vehicle."""
BEARINGS = {"front": 0.0, "rear": math.pi, "left": math.pi / 2.0, "right": -math.pi / 2.0}
"""Bearing of each side, counter-clockwise from straight ahead [rad]."""
ANY_CLASS = "any"  # Name of the only class of a prior without classes
CLASSES_NAMED = 8
WHERE = {
    "front": "ahead",
    "rear": "behind",
    "left": "on the left",
    "right": "on the right",
    "near": f"within {NEAR_M:g} m",
    "mid": f"from {NEAR_M:g} to {FAR_M:g} m",
    "far": f"beyond {FAR_M:g} m",
}  # Text for each zone of `scoring.zones.ZONES`


def object_words(found: ObjectScore) -> tuple[str, ...]:
    """Describe a score on objects in lines: expected AP, LiDAR points, and reach by class."""
    ap = f"expected AP {found.ap:.2f} +- {error_text(found.ap_stderr)}"
    lines = [f"{ap}: {', '.join(f'{name} {c.ap:.2f}' for name, c in found.per_class.items())}"]
    for name, own in found.per_class.items():
        shares = ", ".join(map(percent, own.points.values()))
        points = f"{shares} get {', '.join(map(str, own.points))} points or more; "
        points = points if own.points else ""  # without LiDARs
        lines.append(f"{name}: {points}found alone (AP 0.5) {reach_words(own)}")
    return tuple(lines)


def objects_looked_at(found: ObjectScore) -> str:
    """Describe the evaluated objects: their number, and whether they can hide each other."""
    if found.traffic:
        return f"{found.objects:,} objects in {found.scenes:,} scenes, in traffic"
    return f"{found.objects:,} objects, none occludes another"


def lone_reach(metres: float) -> str:
    """Return the reach for a lone object: "73 m", "≥ 80 m" at the evaluated limit, or "none"."""
    return sight.reach_text(metres, metres >= FARTHEST_M)


def reach_words(own: FoundClass) -> str:
    """Describe how far a class is found ahead, behind, left and right."""
    return _ways([(own.reach[way], own.reach[way] >= FARTHEST_M) for way in SIDES])


def _ways(reaches: Iterable[tuple[float, bool]]) -> str:
    """Describe how far [m], and whether it may be more, ahead, behind, left and right."""
    ways = []
    missing = []
    for words, (metres, is_cut) in zip(SIDES.values(), reaches, strict=True):
        if sight.shown_reach(metres):
            ways.append(f"{sight.shown_reach(metres)} m{' and more' * is_cut} {words}")
        else:
            missing.append(words)
    if not ways:
        return "nowhere ahead, behind, left or right"
    return f"up to {', '.join(ways)}{'; not ' * bool(missing)}{', '.join(missing)}"


@dataclass(frozen=True, slots=True)
class Outlook:
    """Results of `Sight` for a rig. `expected_ap` is by class, 0 to 1; `shares` are the visible
    shares by number of sensors, by sensor and zone; `reach` is that for one class; `blind` is the
    ground on which an object of height `BLIND_TO_M` is invisible, or of the lowest height of the
    space if that is greater."""

    expected_ap: Mapping[str, float]
    shares: sight.VisibleShares
    reach: sight.Reach
    blind: sight.BlindGround

    def to_dict(self) -> dict[str, Any]:
        """Return the results as plain JSON data, without the outlines of blind ground."""
        return {
            "expected_ap": dict(self.expected_ap),
            "seen_by_at_least": list(self.shares.by_number),
            "seen_by_sensor": {name: dict(shares) for name, shares in self.shares.zones.items()},
            "reach": {
                "class": self.reach.class_name,
                "ap": self.reach.ap,
                "bearings_deg": [round(math.degrees(b), 6) for b in self.reach.bearings],
                "distance_m": self.reach.distance.tolist(),
                "limit_m": self.reach.limit.tolist(),
                "per_sensor_m": {
                    name: distances.tolist() for name, distances in self.reach.per_sensor.items()
                },
            },
            "blind": _blind_dict(self.blind),
        }


def outlook(view: sight.Sight, rig: Rig, class_name: str | None = None) -> Outlook:
    """Compute the outlook of a rig; for the class of the reach see `class_of`."""
    name = class_of(view.prior, class_name)
    return Outlook(
        view.expected_ap(rig),
        view.shares(rig),
        view.reach(rig, name),
        view.blind(rig, blind_height(view)),
    )


def class_of(prior: Prior, name: str | None) -> str:
    """Return the name of the class for the reach, which has to be one of the prior. For None it is
    pedestrians, or the first class of a prior without them."""
    names = prior.class_names
    if name is None:
        return USUAL_CLASS if USUAL_CLASS in names else names[0]
    return choice("prior", "class", name, names)


def outlook_words(found: Outlook, of_voxels: bool = True) -> Iterator[str]:
    """Describe an outlook in short lines; without `of_voxels`, only its blind ground."""
    if not of_voxels:
        yield _blind_words(found.blind)
        return
    aps = [f"{name} {ap:.2f}" for name, ap in found.expected_ap.items()]
    more = ["..."] if len(aps) > CLASSES_NAMED else []
    yield f"expected AP: {', '.join(aps[:CLASSES_NAMED] + more)}"
    yield _reach_words(found.reach)
    yield _blind_words(found.blind)


def _reach_words(reach: sight.Reach) -> str:
    noun = "object" if reach.class_name == ANY_CLASS else reach.class_name
    article = "an" if noun[:1].lower() in "aeiou" else "a"
    ways = _ways([reach.towards(BEARINGS[side]) for side in SIDES])
    return f"{article} {noun} is found (AP {reach.ap:g} or more) {ways}"


def _blind_words(blind: sight.BlindGround) -> str:
    subject = f"blind to what is {blind.height:g} m tall"
    if all(end == 0.0 for end in blind.zone.values()):
        return f"{subject} nowhere at the body"
    ways = []
    for side, words in SIDES.items():
        end = blind.zone[side]
        to = f"beyond {blind.within:g} m" if end is None else f"to {sight.shown_end(end):.1f} m"
        ways.append(f"{'none' if end == 0.0 else to} {words}")
    return f"{subject}, from the body: {', '.join(ways)}"


def _blind_dict(blind: sight.BlindGround) -> dict[str, Any]:
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


def rig_words(
    score: Score,
    seen: Outlook | None = None,
    rig: Rig | None = None,
    warnings: Sequence[Advice] = (),
) -> tuple[str, ...]:
    """Describe a score in short lines: hidden sensors, coverage, zones. `seen` is the outlook of
    the same rig: it adds the coverage by several sensors, expected AP, reach and blind ground. Of
    `rig`, sensors that see nothing are named; `warnings` explain why."""
    hidden = () if rig is None else hidden_words(hidden_sensors(rig, score, warnings))
    lines = [*hidden, _coverage(score, seen), *_zones(score.per_zone)]
    if score.objects is not None:
        lines += object_words(score.objects)
    if seen is not None:
        lines += outlook_words(seen, of_voxels=score.objects is None)
    return tuple(lines)


def _coverage(score: Score, seen: Outlook | None) -> str:
    if score.objects is not None:
        looked_at = objects_looked_at(score.objects)
        return f"{percent(score.coverage)} of the objects are seen, by weight ({looked_at})"
    line = f"{percent(score.coverage)} of where objects are is seen"
    if seen is None or len(seen.shares.by_number) < 3:
        return line
    return f"{line}; {percent(seen.shares.by_number[2])} by two or more sensors"


def _zones(zones: Mapping[str, PartScore]) -> Iterator[str]:
    """Name the zones with the lowest and the highest entropy."""
    order = sorted(zones, key=lambda name: zones[name].entropy)
    if order and zones[order[0]].entropy < zones[order[-1]].entropy:
        best, worst = (
            f"{WHERE.get(name, name)} ({zones[name].entropy:.2f} nats, "
            f"{percent(zones[name].coverage)} seen)"
            for name in (order[0], order[-1])
        )
        yield f"best {best}, worst {worst}"

"""Describe a score in sentences: coverage, zones, and what each sensor contributes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pe_core.scene.rig import Rig, Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.score import FAR_M, NEAR_M, PartScore, Score, SensorScore
from pe_core.sensors import kind_of
from pe_tools.wording import percent

from .advice import Advice
from .key_figures import MIN_LOSS, MIN_RISE
from .mount_checks import occluded_shares
from .summary import Outlook, object_words, objects_looked_at, outlook_words
from .warnings import hidden_sensors, hidden_words

WHERE = {
    "front": "ahead",
    "rear": "behind",
    "left": "on the left",
    "right": "on the right",
    "near": f"within {NEAR_M:g} m",
    "mid": f"from {NEAR_M:g} to {FAR_M:g} m",
    "far": f"beyond {FAR_M:g} m",
}
"""Text for each zone of `scoring.zones.ZONES`."""
PARTS_NAMED = 3
LITTLE = 0.05
"""A part of the vehicle that blocks less than this share of all blocked beams is not named."""


def words(
    score: Score,
    rig: Rig | None = None,
    vehicle: Vehicle | None = None,
    seen: Outlook | None = None,
    warnings: Sequence[Advice] = (),
) -> tuple[str, ...]:
    """Describe a score in short lines: hidden sensors, coverage, zones, and each sensor.

    A sensor's first line begins with its name; its further lines begin with two spaces.

    Parameters
    ----------
    score : Score
    rig, vehicle : Rig, Vehicle, optional
        Those that were scored. With both, also what a camera loses to the vehicle.
    seen : Outlook, optional
        Of the same rig. It adds the coverage by several sensors, expected AP, reach, blind ground,
        and the zones that each sensor sees best.
    warnings : sequence of Advice
        About the same rig. They explain why a sensor sees nothing.
    """
    lines = [*rig_words(score, seen, rig, warnings)]
    alone = len(score.per_sensor) == 1
    for name, sensor_score in score.per_sensor.items():
        sensor = None if rig is None else rig[name]
        zones = None if seen is None or score.objects else seen.shares.zones[name]
        first, *more = sensor_words(sensor_score, sensor, vehicle, zones, alone=alone)
        lines += [f"{name}: {first}", *(f"  {phrase}" for phrase in more)]
    return tuple(lines)


def rig_words(
    score: Score,
    seen: Outlook | None = None,
    rig: Rig | None = None,
    warnings: Sequence[Advice] = (),
) -> tuple[str, ...]:
    """Return the lines of `words` that describe the whole rig; parameters as there."""
    hidden = () if rig is None else hidden_words(hidden_sensors(rig, score, warnings))
    lines = [*hidden, _coverage(score, seen), *_zones(score.per_zone)]
    if score.objects is not None:
        lines += object_words(score.objects)
    if seen is not None:
        lines += outlook_words(seen, of_voxels=score.objects is None)
    return tuple(lines)


def sensor_words(
    own: SensorScore,
    sensor: Sensor | None = None,
    vehicle: Vehicle | None = None,
    zones: Mapping[str, float] | None = None,
    *,
    alone: bool = False,
) -> tuple[str, ...]:
    """Describe one sensor in phrases: its contribution, its best and worst zone, its occlusion.

    `own` is the sensor's part of the score; `zones` has the share of each zone that the sensor
    sees, 0 to 1 (`sight.VisibleShares`); `alone` is whether the rig has no other sensor.
    """
    digits = 2 if own.lost >= MIN_RISE else 4
    adds = f"without it {own.lost:.{digits}f} nats worse"
    adds = adds if own.lost >= MIN_LOSS else "without it no worse"
    phrases = ["the only sensor" if alone else adds]
    seen = zones or {}
    order = sorted(seen, key=seen.__getitem__, reverse=True)
    if order and seen[order[0]] != seen[order[-1]]:
        best, worst = (f"{WHERE[z]} ({percent(seen[z])})" for z in (order[0], order[-1]))
        phrases.append(f"sees most {best}, least {worst}")
    phrases.append(occluded_words(sensor, own, vehicle))
    return tuple(filter(None, phrases))


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


def occluded_words(
    sensor: Sensor | None, own: SensorScore | None = None, vehicle: Vehicle | None = None
) -> str:
    """Describe which parts block a sensor's view, as in "7.5% of its beams occluded by roof".

    It is empty where nothing blocks the view. For the parameters see `occluded_shares`.
    """
    shares = occluded_shares(sensor, own, vehicle)
    total = sum(shares.values())
    if not total:
        return ""
    unit = "beams" if sensor is None else kind_of(sensor).unit
    named = [part for part in shares if shares[part] >= LITTLE * total]
    text = f"{percent(total)} of its {unit} occluded"
    if len(named) == 1:
        return f"{text} by {named[0]}"
    by_part = ", ".join(f"{part} {percent(shares[part])}" for part in named[:PARTS_NAMED])
    return f"{text}: {by_part}{', ...' if len(named) > PARTS_NAMED else ''}"

"""A score in words that a designer uses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ..kinds import kind_of
from ..scene.sensors import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..scoring.score import PartScore, Score, SensorScore
from ..scoring.zones import FAR_M, NEAR_M
from .advice import Advice
from .figures import percent
from .hidden import hidden_sensors, hidden_words
from .mounting import stopped_shares
from .object_words import object_words, objects_looked_at
from .outlook import Outlook, outlook_words

WHERE = {
    "front": "ahead",
    "rear": "behind",
    "left": "on the left",
    "right": "on the right",
    "near": f"within {NEAR_M:g} m",
    "mid": f"from {NEAR_M:g} to {FAR_M:g} m",
    "far": f"beyond {FAR_M:g} m",
}
"""Zones (`scoring.zones.ZONES`) in words."""
PARTS_NAMED = 3
LITTLE = 0.05
"""Parts that stop less than this share of all that is stopped are not named."""
WORTH_NATS = 0.00005
"""What a sensor adds below this is told as nothing: four digits are shown."""


def words(
    score: Score,
    rig: Rig | None = None,
    vehicle: Vehicle | None = None,
    seen: Outlook | None = None,
    warnings: Sequence[Advice] = (),
) -> tuple[str, ...]:
    """Return a score in short lines: hidden sensors, what is seen, where, what each sensor adds.

    Lines that go on about a sensor begin with two spaces.

    Parameters
    ----------
    score : Score
    rig, vehicle : Rig, Vehicle, optional
        What was scored: the share of its picture that a camera loses is then told, too.
    seen : Outlook, optional
        Of the same rig: tells what is seen by several, expected AP, reach, blind ground, and where
        each sensor sees most.
    warnings : sequence of Advice
        On the same rig: they say why a sensor sees nothing.
    """
    of_rig = rig_words(score, seen, rig, warnings)
    return *of_rig, *_sensor_lines(score, rig, vehicle, seen)


def rig_words(
    score: Score,
    seen: Outlook | None = None,
    rig: Rig | None = None,
    warnings: Sequence[Advice] = (),
) -> tuple[str, ...]:
    """Return those lines of `words` that are on the whole rig."""
    hidden = () if rig is None else hidden_words(hidden_sensors(rig, score, warnings))
    return *hidden, *_rig_lines(score, seen)


def _rig_lines(score: Score, seen: Outlook | None) -> Iterator[str]:
    yield _coverage(score, seen)
    yield from _zones(score.per_zone)
    if score.objects is not None:
        yield from object_words(score.objects)
    if seen is not None:
        yield from outlook_words(seen, of_voxels=score.objects is None)


def _sensor_lines(
    score: Score, rig: Rig | None, vehicle: Vehicle | None, seen: Outlook | None
) -> Iterator[str]:
    for name, own in score.per_sensor.items():
        sensor = None if rig is None else rig[name]
        zones = None if seen is None or score.objects else seen.shares.zones[name]
        alone = len(score.per_sensor) == 1
        first, *more = sensor_words(own, sensor, vehicle, zones, alone=alone)
        yield f"{name}: {first}"
        yield from (f"  {each}" for each in more)


def sensor_words(
    own: SensorScore,
    sensor: Sensor | None = None,
    vehicle: Vehicle | None = None,
    zones: Mapping[str, float] | None = None,
    *,
    alone: bool = False,
) -> tuple[str, ...]:
    """Return what a sensor adds, where it sees most and least, and what stops it: a phrase each.

    Parameters
    ----------
    own : SensorScore
    sensor, vehicle : Sensor, Vehicle, optional
        As in `words`.
    zones : mapping of float, optional
        The share of each zone that it sees (`sight.SeenShares`).
    alone : bool
        Whether it is the rig's only sensor.
    """
    told = (
        "the only sensor" if alone else _adds(own),
        "" if zones is None else _most_and_least(zones),
        stopped_words(sensor, own, vehicle),
    )
    return tuple(filter(None, told))


def _coverage(score: Score, seen: Outlook | None) -> str:
    if score.objects is not None:
        looked_at = objects_looked_at(score.objects)
        return f"{percent(score.coverage)} of the objects are seen, by weight ({looked_at})"
    line = f"{percent(score.coverage)} of where objects are is seen"
    if seen is None or len(seen.shares.by_number) < 3:
        return line
    return f"{line}; {percent(seen.shares.by_number[2])} by two or more sensors"


def _zones(zones: Mapping[str, PartScore]) -> Iterator[str]:
    """Say where the rig sees best and worst."""
    order = sorted(zones, key=lambda name: zones[name].entropy)
    if order and zones[order[0]].entropy < zones[order[-1]].entropy:
        best, worst = (
            f"{WHERE.get(name, name)} ({zones[name].entropy:.2f} nats, "
            f"{percent(zones[name].coverage)} seen)"
            for name in (order[0], order[-1])
        )
        yield f"best {best}, worst {worst}"


def _adds(own: SensorScore) -> str:
    """Say what a sensor adds to its rig."""
    if own.lost < WORTH_NATS:
        return "without it no worse"
    return (
        f"without it {own.lost:.2f} nats worse"
        if own.lost >= 0.005
        else (f"without it {own.lost:.4f} nats worse")
    )


def _most_and_least(zones: Mapping[str, float]) -> str:
    """Say where a sensor sees most of where objects are, and least."""
    order = sorted(zones, key=lambda zone: -zones[zone])
    if not order or zones[order[0]] == zones[order[-1]]:
        return ""
    most, least = (f"{WHERE[z]} ({percent(zones[z])})" for z in (order[0], order[-1]))
    return f"sees most {most}, least {least}"


def stopped_words(
    sensor: Sensor | None, own: SensorScore | None = None, vehicle: Vehicle | None = None
) -> str:
    """Say what stops a sensor's beams or pixels: "7.5% of its beams stopped by roof"; or nothing.

    Beams as a score has counted them, else a sample of where the sensor looks.
    """
    shares = stopped_shares(sensor, own, vehicle)
    total = sum(shares.values())
    if not total:
        return ""
    unit = "beams" if sensor is None else kind_of(sensor).unit
    named = [part for part in shares if shares[part] >= LITTLE * total]
    told = f"{percent(total)} of its {unit} stopped"
    if len(named) == 1:
        return f"{told} by {named[0]}"
    by_part = ", ".join(f"{part} {percent(shares[part])}" for part in named[:PARTS_NAMED])
    return f"{told}: {by_part}{', ...' if len(named) > PARTS_NAMED else ''}"

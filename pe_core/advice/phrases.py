"""A score in words that a designer uses."""

from __future__ import annotations

from collections.abc import Iterator

from ..kinds import kind_of
from ..scene.sensors import Rig, Sensor
from ..scoring.score import PartScore, Score, SensorScore
from ..scoring.zones import FAR_M, NEAR_M
from .figures import percent

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
WORTH_NATS = 0.00005
"""What a sensor adds below this is told as nothing: four digits are shown."""


def words(score: Score, rig: Rig | None = None) -> tuple[str, ...]:
    """Return a score in short lines: what is seen, where best and worst, what each sensor adds.

    Parameters
    ----------
    score : Score
    rig : Rig, optional
        The rig that was scored: what its sensors count is then called by its name.
    """
    return tuple(_lines(score, rig))


def _lines(score: Score, rig: Rig | None) -> Iterator[str]:
    yield f"{percent(score.coverage)} of where objects are is seen"
    yield from _zones(score.per_zone)
    alone = len(score.per_sensor) == 1
    for name, own in score.per_sensor.items():
        sensor = None if rig is None else rig[name]
        yield f"{name}: {sensor_words(own, sensor, alone=alone)}"


def _zones(zones: dict[str, PartScore]) -> Iterator[str]:
    """Say where the rig sees best and worst."""
    if len(zones) < 2:
        return
    order = sorted(zones, key=lambda name: zones[name].entropy)
    best, worst = order[0], order[-1]
    if zones[best].entropy == zones[worst].entropy:
        return
    for mark, name in (("best", best), ("worst", worst)):
        zone = zones[name]
        seen = percent(zone.coverage)
        yield f"{mark} {WHERE.get(name, name)}: {seen} seen, {zone.entropy:.2f} nats"


def sensor_words(own: SensorScore, sensor: Sensor | None = None, *, alone: bool = False) -> str:
    """Return what a sensor adds, and what stops it, in a line; `alone` when it is the only one."""
    lost = f"{own.lost:.2f}" if own.lost >= 0.005 else f"{own.lost:.4f}"
    adds = f"without it {lost} nats worse" if own.lost >= WORTH_NATS else "without it no worse"
    if alone:
        adds = "the only sensor"
    if not own.stopped:
        return adds
    unit = "beams" if sensor is None else kind_of(sensor).unit
    return f"{adds}; {percent(own.stopped / own.beams)} of its {unit} stopped{_by(own)}"


def _by(own: SensorScore) -> str:
    """Name the parts that stop most."""
    by_count = sorted(own.stopped_by.items(), key=lambda item: (-item[1], item[0]))
    named = [f"{part} {percent(n / own.beams)}" for part, n in by_count[:PARTS_NAMED] if n]
    return f" ({', '.join(named)}{', ...' if len(by_count) > PARTS_NAMED else ''})"

"""Sensors that see nothing, or have lost most of what they would see: the first thing to tell."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..kinds import kind_of
from ..scene.sensors import Rig
from ..scoring.score import Score
from .advice import Advice
from .figures import joined, percent

MOSTLY = 0.5
"""A sensor that loses more than this share of its beams or picture is mostly hidden."""
NOTHING_THERE = "no object is expected where it looks"


@dataclass(frozen=True, slots=True)
class HiddenSensor:
    """A sensor that sees nothing of where objects are, or is mostly hidden by the vehicle.

    Attributes
    ----------
    name : str
    dead : bool
        It sees nothing of all voxels or objects that were evaluated.
    exact : bool
        These were all voxels, not a sample.
    lost : float
        Share of its beams, or of its picture, that the vehicle blocks, 0 to 1; 0 where its kind
        does not count them.
    why : str
        A phrase: "inside the body", "86% of its picture hidden".
    """

    name: str
    dead: bool
    exact: bool
    lost: float
    why: str


def hidden_sensors(
    rig: Rig, score: Score, warnings: Iterable[Advice] = ()
) -> tuple[HiddenSensor, ...]:
    """Return the sensors of a rig that are dead or mostly hidden, the dead ones first.

    Parameters
    ----------
    rig : Rig
    score : Score
        Of this rig.
    warnings : iterable of Advice
        On this rig: they know what is inside the body.
    """
    inside = {each.subject for each in warnings if each.code == "inside"}
    found = []
    for sensor in rig:
        own = score.per_sensor.get(sensor.name)
        if own is None:
            continue
        lost = own.stopped / own.beams if own.beams else 0.0
        dead, enclosed = own.coverage == 0.0, sensor.name in inside
        if dead or enclosed or lost > MOSTLY:
            why = [
                *(["inside the body"] if enclosed else []),
                *([f"{percent(lost)} of its {kind_of(sensor).loss}"] if lost else []),
            ]
            phrase = ", ".join(why) or NOTHING_THERE
            found.append(HiddenSensor(sensor.name, dead, not score.stderr, lost, phrase))
    return tuple(sorted(found, key=lambda each: not each.dead))


def hidden_words(found: Iterable[HiddenSensor]) -> tuple[str, ...]:
    """Return a line on the sensors that see nothing and one on those that are mostly hidden."""
    each = list(found)
    dead = [f"{one.name} ({one.why})" for one in each if one.dead]
    mostly = [f"{one.name} ({one.why})" for one in each if not one.dead]
    nothing = "nothing" if all(one.exact for one in each) else "nothing, or next to it"
    lines = []
    if dead:
        lines.append(f"{joined(dead)} {'sees' if len(dead) == 1 else 'see'} {nothing}")
    if mostly:
        lines.append(f"{joined(mostly)} {'is' if len(mostly) == 1 else 'are'} mostly hidden")
    return tuple(lines)

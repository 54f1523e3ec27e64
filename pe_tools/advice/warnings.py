"""Collect all warnings about a rig and its vehicle from the checks of this package."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from pe_core.geometry.grids import PerceptionSpace
from pe_core.prior.prior import Prior
from pe_core.scene.rig import Rig, Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.score import Score
from pe_core.sensors import kind_of
from pe_tools.advice.advice import joined, percent

from .advice import Advice
from .mount_checks import SensorAtBody, odd_mounting, odd_place
from .vehicle_checks import Bodywork, odd_vehicle


def warnings(
    rig: Iterable[Sensor],
    vehicle: Vehicle | None,
    space: PerceptionSpace,
    prior: Prior,
    score: Score | None = None,
) -> tuple[Advice, ...]:
    """Return warnings about probable mistakes, each with the sensor or part that causes it.

    Parameters
    ----------
    rig : Rig, or any sensors
    vehicle : Vehicle, optional
    space : PerceptionSpace
    prior : Prior
    score : Score, optional
        Score of this rig. Beams that the score has counted as stopped are not cast again.

    Returns
    -------
    tuple of Advice
        Warnings about the vehicle, then about the sensors in the rig's order.
    """
    return tuple(_warnings(rig, vehicle, space, score))


def _warnings(
    rig: Iterable[Sensor], vehicle: Vehicle | None, space: PerceptionSpace, score: Score | None
) -> Iterator[Advice]:
    body = None if vehicle is None else Bodywork(vehicle)
    if body is not None:
        yield from odd_vehicle(body)
    for sensor in rig:
        yield from odd_place(sensor, space)
        if body is not None:
            sensor_score = None if score is None else score.per_sensor.get(sensor.name)
            yield from odd_mounting(SensorAtBody(sensor, body, sensor_score))


MOSTLY = 0.5
"""A sensor is mostly hidden if the vehicle blocks more than this share of its beams or picture."""
NOTHING_THERE = "no object is expected where it looks"


@dataclass(frozen=True, slots=True)
class HiddenSensor:
    """A sensor that sees no place where objects are expected, or is mostly hidden by the vehicle.

    Attributes
    ----------
    name : str
    dead : bool
        Whether it sees none of the evaluated voxels or objects.
    exact : bool
        Whether all voxels were evaluated, not a sample.
    lost : float
        Share of its beams, or of its picture, that the vehicle blocks, 0 to 1; 0 for kinds that do
        not count beams.
    why : str
        The reason as a phrase: "inside the body", "86% of its picture occluded".
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
        Score of this rig.
    warnings : iterable of Advice
        Warnings about this rig: they tell which sensors are inside the body.

    Returns
    -------
    tuple of HiddenSensor
    """
    inside = {warning.subject for warning in warnings if warning.code == "inside"}
    hidden = []
    for sensor in rig:
        part = score.per_sensor.get(sensor.name)
        if part is None:
            continue
        lost = part.occluded / part.beams if part.beams else 0.0
        dead, enclosed = part.coverage == 0.0, sensor.name in inside
        if dead or enclosed or lost > MOSTLY:
            why = [
                *(["inside the body"] if enclosed else []),
                *([f"{percent(lost)} of its {kind_of(sensor).occlusion_text}"] if lost else []),
            ]
            phrase = ", ".join(why) or NOTHING_THERE
            hidden.append(HiddenSensor(sensor.name, dead, not score.stderr, lost, phrase))
    return tuple(sorted(hidden, key=lambda sensor: not sensor.dead))


def hidden_words(found: Iterable[HiddenSensor]) -> tuple[str, ...]:
    """Return one line about sensors that see nothing, and one about those mostly hidden."""
    sensors = list(found)
    dead = [f"{sensor.name} ({sensor.why})" for sensor in sensors if sensor.dead]
    mostly = [f"{sensor.name} ({sensor.why})" for sensor in sensors if not sensor.dead]
    nothing = "nothing" if all(sensor.exact for sensor in sensors) else "nothing, or next to it"
    lines = []
    if dead:
        lines.append(f"{joined(dead)} {'sees' if len(dead) == 1 else 'see'} {nothing}")
    if mostly:
        lines.append(f"{joined(mostly)} {'is' if len(mostly) == 1 else 'are'} mostly occluded")
    return tuple(lines)

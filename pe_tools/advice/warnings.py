"""Collect all warnings about a rig and its vehicle from the checks of this package."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from pe_core.geometry.grids import PerceptionSpace
from pe_core.prior.prior import Prior
from pe_core.scene.rig import Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.score import Score

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

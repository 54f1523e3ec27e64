"""All warnings on a rig and its vehicle. They are told, nothing is refused."""

from __future__ import annotations

from collections.abc import Iterator

from ..prior.prior import Prior
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from ..scoring.score import Score
from .advice import Advice
from .bodywork import Bodywork
from .mounting import SensorAtBody, odd_mounting, odd_place
from .vehicle_shape import odd_vehicle


def warnings(
    rig: Rig,
    vehicle: Vehicle | None,
    space: PerceptionSpace,
    prior: Prior,
    score: Score | None = None,
) -> tuple[Advice, ...]:
    """Tell what is probably not meant as it is, in plain words at the thing that causes it.

    Parameters
    ----------
    rig : Rig
    vehicle : Vehicle, optional
    space : PerceptionSpace
    prior : Prior
    score : Score, optional
        Of this rig: beams that it has counted as stopped are not cast again.

    Returns
    -------
    tuple of Advice
        The vehicle's first, then the sensors' in the rig's order.
    """
    return tuple(_told(rig, vehicle, space, score))


def _told(
    rig: Rig, vehicle: Vehicle | None, space: PerceptionSpace, score: Score | None
) -> Iterator[Advice]:
    body = None if vehicle is None else Bodywork(vehicle)
    if body is not None:
        yield from odd_vehicle(body)
    for sensor in rig:
        yield from odd_place(sensor, space)
        if body is not None:
            own = None if score is None else score.per_sensor.get(sensor.name)
            yield from odd_mounting(SensorAtBody(sensor, body, own))

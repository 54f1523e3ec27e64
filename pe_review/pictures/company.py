"""Who stands in a sensor's view: a person and a car at each distance, none before another."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..engine import pe
from .painted import PaintedBody
from .props import CAR_M, PERSON_M, car, person

Floats = NDArray[np.float64]

DISTANCES = (5.0, 10.0, 20.0, 40.0)
"""From the sensor to their near side, along the ground [m]."""
FIRST_RAD, GAP_RAD = math.radians(0.8), math.radians(0.7)
"""Between straight ahead and the first one, and between two."""
WIDEST = 0.72
"""How much of a wide view they spread over."""
MOST_SPREAD = 3.0
CLEAR_M = 0.3
"""Room between them and the vehicle."""


@dataclass(frozen=True, slots=True)
class Companion:
    """Someone in view: `name` is person or car, its `distance` [m], place [m], and its body."""

    name: str
    distance: float
    top: tuple[float, float, float]
    body: PaintedBody

    @property
    def label(self) -> str:
        """How far away it is, in words."""
        return f"{self.distance:g} m"


def company(sensor: pe.Sensor, half_view: float, vehicle: pe.Vehicle | None) -> list[Companion]:
    """Return people on the left and cars on the right of where a sensor looks.

    `half_view` is half its horizontal field of view [rad]; who has no room in it, or would stand in
    the vehicle, is left out.
    """
    found = []
    for name, size, side in (("person", PERSON_M, 1.0), ("car", CAR_M, -1.0)):
        turns = _turns(size[1], half_view)
        for distance, turn in turns.items():
            each = _standing(sensor, name, size, distance, side * turn)
            if vehicle is None or not _meets(each.body.body, vehicle):
                found.append(each)
    return found


def _turns(width: float, half_view: float) -> dict[float, float]:
    """How far aside each stands, by distance [rad]: the farthest innermost, side by side."""
    at, turns = FIRST_RAD, {}
    for distance in reversed(DISTANCES):
        half = math.atan(width / 2.0 / distance)
        turns[distance] = at + half
        at += 2.0 * half + GAP_RAD
    wide = min(max(WIDEST * half_view / at, 1.0), MOST_SPREAD)
    return {d: wide * turn for d, turn in turns.items() if turn < half_view}


def _standing(
    sensor: pe.Sensor, name: str, size: tuple[float, float, float], distance: float, turn: float
) -> Companion:
    heading = looks_to(sensor)
    away = distance + (size[0] / 2.0 if name == "car" else 0.0)
    x = sensor.pose.position[0] + away * math.cos(heading + turn)
    y = sensor.pose.position[1] + away * math.sin(heading + turn)
    body = car(x, y, heading + turn) if name == "car" else person(x, y, heading + turn + math.pi)
    return Companion(name, distance, (x, y, size[2]), body)


def looks_to(sensor: pe.Sensor) -> float:
    """Heading of a sensor's view on the ground [rad]; of one that looks down, its picture's top."""
    ahead, up = (sensor.pose.ground_from_sensor[:2, k] for k in (0, 2))
    flat = ahead if math.hypot(*ahead.tolist()) > 0.2 else up
    return math.atan2(float(flat[1]), float(flat[0]))


def _meets(one: pe.Vehicle, other: pe.Vehicle) -> bool:
    (low, high), (low_2, high_2) = one.bounds, other.bounds
    apart = (low[:2] > high_2[:2] + CLEAR_M) | (high[:2] < low_2[:2] - CLEAR_M)
    return not bool(apart.any())

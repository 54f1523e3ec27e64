"""Where a vehicle's axles are: other programs put their origin at the rear one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..text.values import Number
from .facing import NO_WHEELS, WHEELS, is_called
from .geometry import METRES
from .vehicle import Vehicle

Floats = NDArray[np.float64]

LENGTH = Number(0.0, above=True, cap=100.0, unit="m", noun="length")
AXLE_APART_M = 0.3
"""Wheels nearer to each other than this along the vehicle are on one axle, or twin axles."""
ROUNDED = 4
"""Digits of a guess [m]: a tenth of a millimetre."""


@dataclass(frozen=True, slots=True)
class Reference:
    """Axles of a vehicle, in the ground frame.

    Parameters
    ----------
    rear_axle_x, rear_axle_z : float
        Middle of the rear axle [m]: forward of the origin, and above the ground.
    wheelbase : float, optional
        From the rear axle to the front one [m].
    front_overhang, rear_overhang : float, optional
        From the front axle to the foremost point, from the rear axle to the rearmost [m].

    Raises
    ------
    InputError
        When a number is none, or not of its range.
    """

    rear_axle_x: float
    rear_axle_z: float
    wheelbase: float | None = None
    front_overhang: float | None = None
    rear_overhang: float | None = None

    def __post_init__(self) -> None:
        rules = {"rear_axle_x": METRES, "rear_axle_z": LENGTH, "wheelbase": LENGTH}
        rules |= {"front_overhang": METRES, "rear_overhang": METRES}
        for name, rule in rules.items():
            value = getattr(self, name)
            if value is not None or name.startswith("rear_axle"):
                object.__setattr__(self, name, rule.checked("reference", name, value))


def guessed_reference(vehicle: Vehicle | None) -> Reference | None:
    """Return where the axles are by the parts that are named as wheels; None where none are.

    The rearmost wheels make the rear axle, the foremost the front one; a vehicle whose wheels are
    all at one place, or without the names, is not guessed.
    """
    wheels = [] if vehicle is None else _wheels(vehicle)
    if vehicle is None or len(wheels) < 2:
        return None
    along = sorted(wheels, key=lambda center: center[0])
    rear, front = along[0], along[-1]
    if front[0] - rear[0] < AXLE_APART_M:
        return None
    low, high = vehicle.bounds
    numbers = (rear[0], rear[2], front[0] - rear[0], high[0] - front[0], rear[0] - low[0])
    return Reference(*(round(float(number), ROUNDED) for number in numbers))


def _wheels(vehicle: Vehicle) -> list[Floats]:
    """Return the middles of parts that are wheels, (3,) each."""
    found = []
    for number, name in enumerate(vehicle.part_names):
        points = vehicle.triangles[vehicle.parts == number].reshape(-1, 3)
        if len(points) and is_called(name, WHEELS, NO_WHEELS):
            found.append((points.min(axis=0) + points.max(axis=0)) / 2.0)
    return found

"""Which side of the body is outside, and whether a place is inside it.

First hits alone are asked, so that neither holes, nor double skins, nor a missing underbody matter.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from .frozen import frozen
from .geometry import dot
from .vehicle import Vehicle

Floats = NDArray[np.float64]

AROUND, BELOW_DEG, ENCLOSED = 256, 10.0, 0.9
"""A sensor is inside when the body is met in this share of so many directions, spread evenly over
the sphere from 10 degrees below the horizon up; a sensor under the body looks out sideways."""
SIDES, LIFT_M, GRAZING = 64, 1e-3, 0.2
"""Directions over the whole sphere that tell the open side of a skin, from how far off it; those
along the skin tell nothing."""
SHAFT_M, SHAFT_FROM_M = 0.3, 0.1
"""Half width of a shaft through which a place is open, wider than a window is high, and from where:
what is nearer may be the skin that the sensor stands on."""


def is_enclosed(vehicle: Vehicle, position: Floats, through_glass: bool = False) -> bool:
    """Whether the body is met nearly all round a place (3,) [m]."""
    hits = vehicle.first_hit(position.tolist(), spiral(AROUND, BELOW_DEG), through_glass)
    return float(np.mean(np.isfinite(hits.distance))) >= ENCLOSED


def is_open(vehicle: Vehicle, position: Floats) -> bool:
    """Whether a wide view gets away from a place (3,), up or by the nearest side.

    A quick look at boxes round the triangles: what is open is not enclosed, what is not may be.
    """
    low, high = vehicle.bounds
    gaps = np.concatenate([position[:2] - low[:2], high[:2] - position[:2]])
    nearest = int(np.argmin(gaps))
    if gaps[nearest] < 0.0 or position[2] > high[2]:  # beside all of it, or above
        return True
    sides = (2, 1.0), (nearest % 2, 1.0 if nearest > 1 else -1.0)
    return any(_gets_away(vehicle, position, *side) for side in sides)


def _gets_away(vehicle: Vehicle, position: Floats, axis: int, sign: float) -> bool:
    """Whether nothing is in the shaft that leads away from a place along an axis."""
    low, high = vehicle.triangle_bounds
    start = float(position[axis]) + sign * SHAFT_FROM_M
    within = high[axis] > start if sign > 0.0 else low[axis] < start
    for across in {0, 1, 2} - {axis}:
        within &= low[across] <= position[across] + SHAFT_M
        within &= high[across] >= position[across] - SHAFT_M
    return not within.any()


def open_side(vehicle: Vehicle, point: Floats, normal: Floats) -> float:
    """On which side of a skin more rays get away: 1.0 on its unit normal's (3,), else -1.0."""
    towards = dot(spiral(SIDES, 90.0), normal)
    return 1.0 if _free(vehicle, point, normal, towards) >= 0.0 else -1.0


def _free(vehicle: Vehicle, point: Floats, normal: Floats, towards: Floats) -> float:
    """How much more of what is on the normal's side is free than on the other."""
    shares = []
    for side in (1.0, -1.0):
        rays = spiral(SIDES, 90.0)[side * towards > GRAZING]
        hits = vehicle.first_hit_from(point + side * LIFT_M * normal, rays)
        shares.append(float(np.mean(np.isinf(hits.distance))))
    return shares[0] - shares[1]


@cache
def spiral(count: int, below_deg: float) -> Floats:
    """(count, 3) unit directions, evenly from some degrees below the horizon up (Fibonacci's)."""
    low = -math.sin(math.radians(below_deg))
    rows = []
    for k in range(count):
        z = low + (1.0 - low) * (k + 0.5) / count
        flat, angle = math.sqrt(1.0 - z * z), k * math.pi * (3.0 - math.sqrt(5.0))
        rows.append((flat * math.cos(angle), flat * math.sin(angle), z))
    return frozen(np.array(rows))

"""Inside test: whether a point is inside the vehicle, and which side of a surface is outside.

Only first hits of rays are used, so holes, double surfaces and a missing underbody do not matter.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from ..base.arrays import Floats, read_only
from ..geometry.poses import dot
from .vehicle import Vehicle

AROUND, BELOW_DEG, ENCLOSED = 256, 10.0, 0.9
"""Number of directions of the inside test, lowest elevation below the horizon, and the share of
directions that must hit the body. A sensor under the body is not inside: it sees out sideways."""
SIDES, LIFT_M, GRAZING = 64, 1e-3, 0.2
"""Open side of a surface: number of directions, distance of the start points from the surface, and
minimum cosine between a direction and the normal, as rays along the surface are no evidence."""
SHAFT_M, SHAFT_FROM_M = 0.3, 0.1
"""Half width of the shaft that has to be empty (wider than a window is high), and distance of its
start from the position: nearer triangles may be the surface on which the sensor is mounted."""


def is_enclosed(vehicle: Vehicle, position: Floats, through_glass: bool = False) -> bool:
    """Whether rays from a point (3,) [m] hit the body in nearly all directions."""
    hits = vehicle.first_hit(position.tolist(), spiral(AROUND, BELOW_DEG), through_glass)
    return float(np.mean(np.isfinite(hits.distance))) >= ENCLOSED


def is_open(vehicle: Vehicle, position: Floats) -> bool:
    """Whether a wide shaft from a position (3,) [m] is empty, upwards or to the nearest side.

    A fast test on the bounds of triangles. An open position is not enclosed; others may be.
    """
    low, high = vehicle.bounds
    gaps = np.concatenate([position[:2] - low[:2], high[:2] - position[:2]])
    nearest = int(np.argmin(gaps))
    if gaps[nearest] < 0.0 or position[2] > high[2]:  # beside the vehicle, or above it
        return True
    sides = (2, 1.0), (nearest % 2, 1.0 if nearest > 1 else -1.0)
    return any(_shaft_is_empty(vehicle, position, *side) for side in sides)


def _shaft_is_empty(vehicle: Vehicle, position: Floats, axis: int, sign: float) -> bool:
    """Whether no triangle is in the shaft from a position along an axis, in a direction `sign`."""
    low, high = vehicle.triangle_bounds
    start = float(position[axis]) + sign * SHAFT_FROM_M
    within = high[axis] > start if sign > 0.0 else low[axis] < start
    for across in {0, 1, 2} - {axis}:
        within &= low[across] <= position[across] + SHAFT_M
        within &= high[across] >= position[across] - SHAFT_M
    return not within.any()


def open_side(vehicle: Vehicle, point: Floats, normal: Floats) -> float:
    """Side of a surface where more rays miss the body: 1.0 along its unit normal (3,), or -1.0."""
    rays = spiral(SIDES, 90.0)
    towards, shares = dot(rays, normal), []
    for side in (1.0, -1.0):
        origin = point + side * LIFT_M * normal
        hits = vehicle.first_hit_from(origin, rays[side * towards > GRAZING])
        shares.append(float(np.mean(np.isinf(hits.distance))))
    return 1.0 if shares[0] - shares[1] >= 0.0 else -1.0


@cache
def spiral(count: int, below_deg: float) -> Floats:
    """(count, 3) unit directions on a Fibonacci spiral, from `below_deg` under the horizon up."""
    low = -math.sin(math.radians(below_deg))
    rows = []
    for k in range(count):
        z = low + (1.0 - low) * (k + 0.5) / count
        flat, angle = math.sqrt(1.0 - z * z), k * math.pi * (3.0 - math.sqrt(5.0))
        rows.append((flat * math.cos(angle), flat * math.sin(angle), z))
    return read_only(np.array(rows))

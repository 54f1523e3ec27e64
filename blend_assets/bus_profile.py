"""Numbers and surfaces of the example shuttle bus (metres, x forward, y left, z up).

The body is an implicit solid: a point is inside where `solid(points) < 0`. It is the smooth
intersection of upright sides, two gently bowed ends and a roof. The sides and ends touch the
bounding box at lamp height; its upright corners stay free, room for sensors there.
"""

from __future__ import annotations

import numpy as np
from curves import Array, smooth_max

# the height is that of the pod on the roof
LENGTH = 6.06
WIDTH = 2.02
HEIGHT = 2.60
FLOOR_Z = 0.24
ROOF_Z = 2.43
# drop of the roof at y = 1 m, and at x = 3 m
ROOF_CROWN = 0.045
ROOF_ARC = 0.030
# how far the corners in plan and the roof's edge are rounded
CORNER = 0.36
ROOF_EDGE = 0.30

WHEEL_RADIUS = 0.38
TRACK = 1.735
AXLES = {"front": 1.95, "rear": -1.90}  # x of the wheel centres: wheelbase 3.85
# wheel opening: a circle seen from the side
ARCH_RADIUS = 0.445
ARCH_Z = 0.385
WELL_Y = 0.60  # inner wall of the wheel housings

UPRIGHT = (0.60, 0.92)  # between these heights sides and ends stand upright
TUCK = 0.55  # how fast they draw in towards the floor, 1 / m
LEAN = 0.018  # and the sides towards the roof
# and windscreen and rear window
SCREEN_LEAN = 0.062
TAIL_LEAN = 0.030
BOW = 0.055  # how far the ends lie back at y = 1 m


def lean(z: Array, upper: float) -> Array:
    """How far a wall lies inside of its outermost line at this height."""
    low, high = UPRIGHT
    return TUCK * np.maximum(low - z, 0) ** 2 + upper * np.maximum(z - high, 0) ** 2


def sides(y: Array, z: Array) -> Array:
    """The left and the right wall."""
    return np.abs(y) - (WIDTH / 2 - lean(z, LEAN))


def ends(x: Array, y: Array, z: Array) -> Array:
    """Nose and tail."""
    upper = np.where(x > 0, SCREEN_LEAN, TAIL_LEAN)
    return np.abs(x) - (LENGTH / 2 - BOW * y**2 - lean(z, upper))


def roof(x: Array, y: Array, z: Array) -> Array:
    """The roof without what stands on it."""
    return z - (ROOF_Z - ROOF_CROWN * y**2 - ROOF_ARC * (x / 3) ** 4)


def solid(points: Array) -> Array:
    """Less than zero inside the bus."""
    x, y, z = points.T
    walls = smooth_max(sides(y, z), ends(x, y, z), CORNER)
    return smooth_max(walls, roof(x, y, z), ROOF_EDGE)

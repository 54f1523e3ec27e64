"""Panel lines of the bus: functions of points (n, 3) that are positive in a region.

All are drawn on the left half; those of the doors are used for the right half only, which is
cut and then mirrored.
"""

from __future__ import annotations

import bus_profile as profile
import numpy as np
from curves import Array
from panel_lines import Line, ahead, behind, height, inboard, negative, rounded

# seen along y: x over z; seen along x: y over z
SIDE = 0
UPRIGHT = 1

# Side windows: a band with round ends, bars across it.
BAND_X = (-2.63, 2.63)
BAND_Z = (1.06, 2.09)
BAND_RADIUS = 0.15
BARS = (-1.62, -0.60, 0.42, 1.44)
DOOR_SIDE_BARS = (-1.66, 1.68)
BAR_HALF = 0.021
# The double door: two leaves with a pane each.
DOOR_X = (-0.66, 0.72)
DOOR_Z = (0.285, 2.17)
DOOR_RADIUS = 0.07
DOOR_FRAME = 0.085
PANE_RADIUS = 0.07
PANE_Z = (0.55, 2.09)

# Windscreen and rear window, each within a dark mask.
MASK_FRONT = (0.885, (0.93, 2.245), 0.22)  # half width, heights, radius
GLASS_FRONT = (0.845, (0.97, 2.205), 0.18)
MASK_REAR = (0.865, (1.00, 2.165), 0.18)
GLASS_REAR = (0.825, (1.04, 2.125), 0.14)

HEADLIGHT_Y = (0.46, 0.865)
HEADLIGHT_Z = (0.665, 0.765)
HEADLIGHT_RADIUS = 0.045
LIGHT_STRIP_Z = (0.697, 0.731)  # the bright strip in them
SLOT_Y = 0.47
SLOT_Z = (0.695, 0.720)
TAILLIGHT_Y = 0.81
TAILLIGHT_X = -2.86
TAILLIGHT_Z = (0.57, 0.93)
REAR_BAR_Z = (0.735, 0.765)
BUMPER_Z = 0.475
SKIRT_Z = 0.325  # the lowest strip all around is dark
ROOF_LINE_Z = 2.275
ARCH_LIP = 0.035

nose = ahead(2.2)
tail = behind(-2.2)


def flank(p: Array) -> Array:
    """True on the side, not around the corners."""
    return (np.abs(p[:, 0]) < 2.85) & (p[:, 1] > 0.85)


def arch(p: Array) -> Array:
    """Distance from the nearer wheel opening, negative in it."""
    axle = np.where(p[:, 0] > 0, profile.AXLES["front"], profile.AXLES["rear"])
    return np.hypot(p[:, 0] - axle, p[:, 2] - profile.ARCH_Z) - profile.ARCH_RADIUS


def bend(field: Line) -> Line:
    """Positive near the round corners of a field: there its edge lies oblique."""

    def near(p: Array) -> Array:
        step = 1e-4
        slope = [field(p + offset) - field(p - offset) for offset in np.eye(3) * step]
        oblique = np.sort(np.abs(slope), axis=0)[1] / (2 * step) - 0.05
        return np.minimum(oblique, 0.05 - np.abs(field(p)))

    return near


def upright(half: float, heights: tuple[float, float], radius: float) -> Line:
    """A round-cornered field about the centre line of nose or tail."""
    return rounded(UPRIGHT, (-half, half), heights, radius)


def ends_of_bumper(p: Array) -> Array:
    """Positive ahead of the front wheels and behind the rear ones."""
    front = p[:, 0] - profile.AXLES["front"]
    rear = profile.AXLES["rear"] - p[:, 0]
    return np.maximum(front, rear)


band = rounded(SIDE, BAND_X, BAND_Z, BAND_RADIUS)
door = rounded(SIDE, DOOR_X, DOOR_Z, DOOR_RADIUS)
door_middle = ahead(sum(DOOR_X) / 2)
pane_front = rounded(
    SIDE, (sum(DOOR_X) / 2 + DOOR_FRAME / 2, DOOR_X[1] - DOOR_FRAME), PANE_Z, PANE_RADIUS
)
pane_rear = rounded(
    SIDE, (DOOR_X[0] + DOOR_FRAME, sum(DOOR_X) / 2 - DOOR_FRAME / 2), PANE_Z, PANE_RADIUS
)
mask_front = upright(*MASK_FRONT)
glass_front = upright(*GLASS_FRONT)
mask_rear = upright(*MASK_REAR)
glass_rear = upright(*GLASS_REAR)
headlight = rounded(UPRIGHT, HEADLIGHT_Y, HEADLIGHT_Z, HEADLIGHT_RADIUS)
slot_end = inboard(SLOT_Y)
taillight_side = negative(inboard(TAILLIGHT_Y))
taillight_end = behind(TAILLIGHT_X)
bumper_top = height(BUMPER_Z)
roof_line = height(ROOF_LINE_Z)
skirt = negative(height(SKIRT_Z))

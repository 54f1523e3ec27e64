"""Panel lines of the sedan: functions of points (n, 3) that are zero on the line."""

from __future__ import annotations

import numpy as np
import sedan_profile as profile
from curves import Array, Curve, step
from panel_lines import Line

HOOD_EDGE = Curve((0.60, 0.770), (1.10, 0.755), (1.60, 0.725), (2.30, 0.620))  # half width over x
FRONT_DOOR = Curve((0.20, 0.985), (0.45, 0.965), (0.75, 0.900), (1.00, 0.840))  # x over height
MIDDLE_DOOR = Curve((0.20, -0.130), (0.60, -0.115), (1.00, -0.150), (1.40, -0.230))
REAR_DOOR = Curve((0.20, -0.800), (0.40, -0.850), (0.60, -0.955), (0.80, -1.060), (1.05, -1.110))
QUARTER_LIGHT = Curve((0.90, -1.030), (1.40, -0.900))  # division of the rear side window
SILL_TOP = 0.265  # height of the lower door edge
SILL_TRIM = 0.205  # height of the dark strip under the doors
HANDLES = (0.02, -0.87)  # x of the middle of the door handles
# dark lower part of the rear bumper
DIFFUSER_TOP = 0.375
DIFFUSER_SIDE = 0.66
# half widths of the slot and the air inlets
SLOT_HALF = 0.008
CURTAIN_HALF = 0.028
HEADLIGHT_STRIP = 0.020  # height of the bright strip along the foot of the headlights
HANDLE_Z = (0.044, 0.066)  # lower and upper edge of the handles above the crease
# half widths of the bars across the side windows
PILLAR_HALF = 0.035
BAR_HALF = 0.012
CURTAIN = (0.315, 0.485)  # heights of the air inlets in the front corners
INTAKE = (0.235, 0.425)  # heights of the lower and upper edge of the front intake
GLASS_INSET = 0.050  # width of the roof rail and the front pillar, seen from the side
PILLAR_INSET = 0.030  # the same seen from the front


def above(p: Array) -> Array:
    """Positive on the greenhouse, negative on the lower body."""
    part = profile.terms(p)
    return part.lower - part.cabin


def arch(p: Array) -> Array:
    """Distance from the nearer wheel opening, negative in it."""
    x = np.where(p[:, 0] > 0, p[:, 0] - profile.AXLES["front"], p[:, 0] - profile.AXLES["rear"])
    return np.hypot(x, p[:, 2] - profile.ARCH_Z) - profile.ARCH_RADIUS


def cowl_edge(p: Array) -> Array:
    """Positive ahead of the rear edge of the bonnet."""
    return p[:, 0] + 0.20 * (p[:, 1] / 0.7) ** 2 - 1.105


def hood_nose(p: Array) -> Array:
    """Positive behind the front edge of the bonnet."""
    return 2.205 - 0.26 * (p[:, 1] / 0.7) ** 2 - p[:, 0]


def hood_side(p: Array) -> Array:
    """Positive inside of the side edge of the bonnet."""
    return HOOD_EDGE(p[:, 0]) - p[:, 1]


def screen_top(p: Array) -> Array:
    """Positive ahead of the upper edge of the windscreen."""
    return p[:, 0] + 0.17 * (p[:, 1] / 0.7) ** 2 - 0.285


def rear_top(p: Array) -> Array:
    """Positive behind the upper edge of the rear glass."""
    return -1.02 + 0.13 * (p[:, 1] / 0.6) ** 2 - p[:, 0]


def rear_foot(p: Array) -> Array:
    """Positive ahead of the lower edge of the rear glass."""
    return p[:, 0] + 1.735 - 0.13 * (p[:, 1] / 0.6) ** 2


def pillar(p: Array) -> Array:
    """Positive on windscreen, roof and rear glass, inside of the pillars."""
    return -PILLAR_INSET - profile.terms(p).cabin_side


def rear_pillar(p: Array) -> Array:
    """The same for the rear glass, whose pillars widen downwards."""
    return pillar(p) - 0.035 - 0.10 * (1.35 - p[:, 2])


def side_top(p: Array) -> Array:
    """Positive below the upper edge of the side windows."""
    return -GLASS_INSET - profile.terms(p).cabin_top


def side_foot(p: Array) -> Array:
    """Positive above the lower edge of the side windows."""
    return p[:, 2] - profile.BELT(p[:, 0])


def side_tail(p: Array) -> Array:
    """Positive ahead of the rear tip of the side windows."""
    return p[:, 0] + 1.50 - 0.75 * (p[:, 2] - 1.03)


def headlight_top(p: Array) -> Array:
    """Positive below the upper edge of the headlights."""
    return 0.708 + 0.10 * (2.2 - p[:, 0]) - p[:, 2]


def headlight_foot(p: Array) -> Array:
    """Positive above their lower edge."""
    return p[:, 2] - 0.635 - 0.25 * np.maximum(2.2 - p[:, 0], -0.05)


def headlight_inner(p: Array) -> Array:
    """Positive outside of their inner end."""
    return p[:, 1] - 0.46 + 0.6 * (p[:, 2] - 0.65)


def taillight_top(p: Array) -> Array:
    """Positive below the upper edge of the taillights."""
    return 0.945 - p[:, 2]


def taillight_foot(p: Array) -> Array:
    """Positive above their lower edge: a bar that widens and wraps the corner."""
    wrap = np.maximum(p[:, 0] + 2.22, 0) * 0.28
    return p[:, 2] - 0.895 + 0.055 * step(p[:, 1], 0.30, 0.62) - wrap


def crease(p: Array) -> Array:
    """Height above the crease of the flank."""
    return p[:, 2] - profile.WEDGE(p[:, 0]) - profile.CREASE_Z


def lip(p: Array) -> Array:
    """Positive above the front edge of the bonnet."""
    x, y, z = p.T
    return z - profile.body_top(x, y) - profile.ends(x, y, z)


def slot_line(p: Array) -> Array:
    """Height above the slot that joins the headlights."""
    return p[:, 2] - 0.668


def handle(p: Array) -> Array:
    """Positive at the height of the flush door handles."""
    return np.minimum(crease(p) - HANDLE_Z[0], HANDLE_Z[1] - crease(p))


def handle_ends(p: Array) -> Array:
    """Positive over the length of the front or the rear handle."""
    x = np.where(p[:, 0] > -0.6, p[:, 0] - HANDLES[0], p[:, 0] - HANDLES[1])
    return 0.10 - np.abs(x)


def curtain_line(p: Array) -> Array:
    """Across the upright air inlet at the corner of the front bumper."""
    return p[:, 1] - 0.735 + 0.15 * (p[:, 2] - 0.4)


def grille_side(p: Array) -> Array:
    """Positive inside of the ends of the front intake."""
    return 0.61 - 0.45 * np.abs(p[:, 2] - 0.28) - p[:, 1]


def door(curve: Curve) -> Line:
    """Positive ahead of a door edge."""
    return lambda p: p[:, 0] - curve(p[:, 2])


def between_axles(p: Array) -> Array:
    """Positive between the wheels."""
    return 1.2 - np.abs(p[:, 0])

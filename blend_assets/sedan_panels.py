"""Panel lines of the sedan: where the skin is cut, and which piece belongs to which object."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import sedan_profile as profile
from sedan_profile import Array, Curve
from sedan_skin import Skin, cut

GAP = 0.0035  # half the width of a shut line
Line = Callable[[Array], Array]

HOOD_EDGE = Curve((0.60, 0.770), (1.10, 0.755), (1.60, 0.725), (2.30, 0.620))  # half width over x
FRONT_DOOR = Curve((0.20, 0.985), (0.45, 0.965), (0.75, 0.900), (1.00, 0.840))  # x over height
MIDDLE_DOOR = Curve((0.20, -0.130), (0.60, -0.115), (1.00, -0.150), (1.40, -0.230))
REAR_DOOR = Curve((0.20, -0.800), (0.40, -0.850), (0.60, -0.955), (0.80, -1.060), (1.05, -1.110))
QUARTER_LIGHT = Curve((0.90, -1.030), (1.40, -0.900))  # division of the rear side window
SILL_TOP = 0.265  # height of the lower door edge
SILL_TRIM = 0.205  # height of the dark strip under the doors
HANDLES = (0.02, -0.87)  # x of the middle of the door handles
CURTAIN = (0.315, 0.485)  # heights of the air inlets in the front corners
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
    return 0.708 + 0.10 * (2.2 - p[:, 0]) - p[:, 2]


def headlight_foot(p: Array) -> Array:
    return p[:, 2] - 0.635 - 0.25 * np.maximum(2.2 - p[:, 0], -0.05)


def headlight_inner(p: Array) -> Array:
    return p[:, 1] - 0.46 + 0.6 * (p[:, 2] - 0.65)


def taillight_top(p: Array) -> Array:
    return 0.945 - p[:, 2]


def taillight_foot(p: Array) -> Array:
    wrap = np.maximum(p[:, 0] + 2.22, 0) * 0.28
    return p[:, 2] - 0.895 + 0.055 * profile.step(p[:, 1], 0.30, 0.62) - wrap


def crease(p: Array) -> Array:
    """Height above the crease of the flank."""
    return p[:, 2] - profile.WEDGE(p[:, 0]) - profile.CREASE_Z


def handle(p: Array) -> Array:
    """Positive at the height of the flush door handles."""
    return 0.011 - np.abs(crease(p) - 0.055)


def handle_ends(p: Array) -> Array:
    """Positive over the length of the front or the rear handle."""
    x = np.where(p[:, 0] > -0.6, p[:, 0] - HANDLES[0], p[:, 0] - HANDLES[1])
    return 0.10 - np.abs(x)


def curtain(p: Array) -> Array:
    """Across the upright air inlet at the corner of the front bumper."""
    return p[:, 1] - 0.735 + 0.15 * (p[:, 2] - 0.4)


def grille_side(p: Array) -> Array:
    return 0.60 - 0.35 * np.abs(p[:, 2] - 0.27) - p[:, 1]


def band(low: float, high: float) -> Line:
    """Positive between two heights."""
    return lambda p: np.minimum(p[:, 2] - low, high - p[:, 2])


def shut(line: Line) -> Line:
    """A shut line: positive within GAP of another line."""
    return lambda p: GAP - np.abs(line(p))


def door(curve: Curve) -> Line:
    return lambda p: p[:, 0] - curve(p[:, 2])


def both(*lines: Line) -> Line:
    """True where all lines are positive."""
    return lambda p: np.all([line(p) > 0 for line in lines], axis=0)


def height(limit: float) -> Line:
    return lambda p: p[:, 2] - limit


def negative(line: Line) -> Line:
    return lambda p: -line(p)


def ahead(limit: float) -> Line:
    return lambda p: p[:, 0] - limit


def behind(limit: float) -> Line:
    return lambda p: limit - p[:, 0]


below = negative(above)
in_hood = both(below, hood_side, cowl_edge, hood_nose)
on_nose, on_tail = ahead(1.70), behind(-1.88)
intake = band(0.235, 0.385)
diffuser = band(0.0, 0.375)
SIDE_GLASS = both(height(0.9), side_top, side_foot, side_tail)
WINDSHIELD = both(above, pillar, screen_top)
REAR_GLASS = both(ahead(-2.1), rear_pillar, rear_top, rear_foot)
ROOF = both(height(1.2), pillar, negative(screen_top), negative(rear_top))
HEADLIGHT = both(on_nose, headlight_top, headlight_foot, headlight_inner)
TAILLIGHT = both(on_tail, taillight_top, taillight_foot)


def widened(line: Line, by: float) -> Line:
    return lambda p: line(p) + by


class Panel(NamedTuple):
    """A piece of the skin: object, material and where it is."""

    name: str
    material: str
    inside: Line


def shut_lines() -> list[tuple[Line, Line]]:
    """Pairs of a line and the part of the skin that it divides into panels."""
    side = both(below, height(SILL_TOP - GAP))
    lines = [(door(curve), side) for curve in (FRONT_DOOR, MIDDLE_DOOR, REAR_DOOR)]
    sill = both(below, widened(negative(door(FRONT_DOOR)), GAP), widened(door(REAR_DOOR), GAP))
    lines.append((height(SILL_TOP), sill))
    lines.append((hood_side, both(below, cowl_edge, widened(hood_nose, GAP))))
    lines.append((hood_nose, both(below, ahead(1.5), widened(hood_side, GAP))))
    return lines


def cut_panels(skin: Skin) -> None:
    """All panel lines into the skin (in place), the long ones first."""
    cabin = both(ahead(-1.75), height(0.85))
    cut(skin, arch)
    cut(skin, crease, lambda p: np.abs(p[:, 0]) < 2.0)
    cut(skin, above, both(ahead(-1.2), height(0.85)))
    cut(skin, side_foot, both(side_tail, negative(pillar), cabin))
    cut(skin, side_top, both(side_foot, cabin, height(0.9)))
    cut(skin, side_tail, both(side_top, side_foot, height(0.9)))
    cut(skin, pillar, both(above, negative(side_top), ahead(-1.1), height(0.9)))
    for line in (screen_top, rear_top):
        cut(skin, line, both(height(1.2), pillar))
    cut(skin, rear_pillar, both(rear_top, ahead(-2.0), height(1.0)))
    cut(skin, rear_foot, both(rear_pillar, behind(-1.2), height(1.0)))
    cut(skin, cowl_edge, both(below, hood_side, ahead(0.5), height(0.8)))
    cut_lights(skin)
    for line, where in shut_lines():
        cut(skin, widened(line, GAP), where)
        cut(skin, widened(line, -GAP), where)
    for curve, half in ((MIDDLE_DOOR, 0.035), (QUARTER_LIGHT, 0.012)):
        for offset in (half, -half):
            cut(skin, widened(door(curve), offset), SIDE_GLASS)


def cut_lights(skin: Skin) -> None:
    """Lamps, intake and diffuser."""
    cut(skin, headlight_top, both(on_nose, widened(headlight_inner, 0.01), headlight_foot))
    cut(skin, headlight_foot, both(on_nose, widened(headlight_inner, 0.01), headlight_top))
    cut(skin, headlight_inner, both(on_nose, headlight_top, headlight_foot))
    cut(skin, widened(headlight_foot, -0.020), HEADLIGHT)
    cut(skin, taillight_top, both(on_tail))
    cut(skin, taillight_foot, both(on_tail, taillight_top))
    nose = both(ahead(1.9))
    for level in (0.235, 0.385):
        cut(skin, height(level), both(nose, widened(grille_side, 0.01)))
    cut(skin, grille_side, both(nose, band(0.235, 0.385)))
    cut(skin, height(SILL_TRIM), lambda p: np.abs(p[:, 0]) < 1.2)
    for level in (0.044, 0.066):
        cut(skin, lambda p, z=level: crease(p) - z, both(widened(handle_ends, 0.06), band(0.6, 0.95)))
    cut(skin, handle_ends, both(handle, band(0.6, 0.9)))
    for offset in (0.028, -0.028):
        cut(skin, widened(curtain, offset), both(ahead(1.8), band(0.27, 0.53)))
    inlet = both(ahead(1.8), widened(shut(curtain), 0.028 - GAP))
    for level in CURTAIN:
        cut(skin, height(level), inlet)
    cut(skin, height(0.375), both(behind(-2.0), lambda p: 0.70 - p[:, 1]))
    cut(skin, lambda p: 0.66 - p[:, 1], both(behind(-2.0), band(0, 0.375)))


def any_gap(p: Array) -> Array:
    """True in the shut lines."""
    return np.any([both(shut(line), where)(p) for line, where in shut_lines()], axis=0)


PANELS = [
    Panel("windows", "trim", both(SIDE_GLASS, widened(shut(door(MIDDLE_DOOR)), 0.035 - GAP))),
    Panel("windows", "trim", both(SIDE_GLASS, widened(shut(door(QUARTER_LIGHT)), 0.012 - GAP))),
    Panel("windows", "glass", SIDE_GLASS),
    Panel("windshield", "glass", WINDSHIELD),
    Panel("rear_window", "glass", REAR_GLASS),
    Panel("roof", "paint", ROOF),
    Panel("headlights", "headlight", both(HEADLIGHT, lambda p: 0.020 - headlight_foot(p))),
    Panel("headlights", "glass", HEADLIGHT),
    Panel("taillights", "taillight", TAILLIGHT),
    Panel("body", "trim", any_gap),
    Panel("hood", "paint", in_hood),
    Panel("body", "trim", both(below, ahead(0.5), negative(cowl_edge), hood_side, height(0.85))),
    Panel("body", "trim", both(ahead(1.9), grille_side, band(0.235, 0.385))),
    Panel("body", "trim", both(ahead(1.8), widened(shut(curtain), 0.028 - GAP), band(*CURTAIN))),
    Panel("body", "trim", lambda p: (p[:, 2] < SILL_TRIM) & (np.abs(p[:, 0]) < 1.2)),
    Panel("body", "trim", both(band(0.6, 0.95), handle, handle_ends)),
    Panel("body", "trim", both(behind(-2.0), band(0, 0.375), lambda p: 0.66 - p[:, 1])),
    Panel("body", "paint", lambda p: np.ones(len(p), dtype=bool)),
]


def classify(centres: Array) -> Array:
    """Index of the first panel that contains each point."""
    found = np.full(len(centres), -1)
    for i, panel in enumerate(PANELS):
        found[(found < 0) & panel.inside(centres)] = i
    return found

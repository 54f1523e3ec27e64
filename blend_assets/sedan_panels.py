"""Which piece of the skin belongs to which object, and the cuts that separate the pieces."""

from __future__ import annotations

import numpy as np
from panel_lines import (
    GAP,
    Line,
    Panel,
    ahead,
    band,
    behind,
    both,
    height,
    in_gaps,
    inboard,
    negative,
    widened,
    within,
)
from sedan_lines import (
    BAR_HALF,
    CURTAIN,
    CURTAIN_HALF,
    DIFFUSER_SIDE,
    DIFFUSER_TOP,
    FRONT_DOOR,
    HANDLE_Z,
    HEADLIGHT_STRIP,
    INTAKE,
    MIDDLE_DOOR,
    PILLAR_HALF,
    QUARTER_LIGHT,
    REAR_DOOR,
    SILL_TOP,
    SILL_TRIM,
    SLOT_HALF,
    above,
    arch,
    between_axles,
    cowl_edge,
    crease,
    curtain_line,
    door,
    grille_side,
    handle,
    handle_ends,
    headlight_foot,
    headlight_inner,
    headlight_top,
    hood_nose,
    hood_side,
    lip,
    pillar,
    rear_foot,
    rear_pillar,
    rear_top,
    screen_top,
    side_foot,
    side_tail,
    side_top,
    slot_line,
    taillight_foot,
    taillight_top,
)
from skin import Skin, cut, cut_gaps

below = negative(above)
nose = ahead(1.9)
corner = ahead(1.7)
tail = behind(-1.88)
slot = within(slot_line, SLOT_HALF)
curtain = within(curtain_line, CURTAIN_HALF)
HOOD = both(below, hood_side, cowl_edge, hood_nose)
SIDE_GLASS = both(height(0.9), side_top, side_foot, side_tail)
WINDSHIELD = both(above, pillar, screen_top)
REAR_GLASS = both(ahead(-2.1), rear_pillar, rear_top, rear_foot)
ROOF = both(height(1.2), pillar, negative(screen_top), negative(rear_top))
HEADLIGHT = both(corner, headlight_top, headlight_foot, headlight_inner)
STRIP = both(HEADLIGHT, negative(widened(headlight_foot, -HEADLIGHT_STRIP)))
TAILLIGHT = both(tail, taillight_top, taillight_foot)


def shut_lines() -> list[tuple[Line, Line]]:
    """Pairs of a line and the part of the skin that it divides into panels."""
    side = both(below, height(SILL_TOP - GAP))
    lines = [(door(curve), side) for curve in (MIDDLE_DOOR, REAR_DOOR)]
    fender = both(height(SILL_TOP - GAP), widened(negative(hood_side), -GAP))
    lines.append((door(FRONT_DOOR), both(below, fender)))
    sill = both(below, widened(negative(door(FRONT_DOOR)), GAP), widened(door(REAR_DOOR), GAP))
    lines.append((height(SILL_TOP), sill))
    lines.append((hood_side, both(below, cowl_edge, widened(hood_nose, GAP))))
    lines.append((hood_nose, both(below, ahead(1.5), widened(hood_side, GAP))))
    return lines


def cut_panels(skin: Skin) -> None:
    """All panel lines into the skin (in place), the long ones first."""
    cabin = both(ahead(-1.75), height(0.85))
    cut(skin, arch)
    cut(skin, crease, both(ahead(-2.0), behind(2.0)))
    cut(skin, above, both(ahead(-0.95), height(0.85)))
    cut(skin, side_foot, both(side_tail, negative(pillar), cabin))
    cut(skin, side_top, both(side_foot, cabin, height(0.9)))
    cut(skin, side_tail, both(side_top, side_foot, height(0.9)))
    cut(skin, pillar, both(above, negative(side_top), ahead(-1.1), height(0.9)))
    for edge in (screen_top, rear_top):
        cut(skin, edge, both(height(1.2), pillar))
    cut(skin, rear_pillar, both(rear_top, ahead(-2.0), height(1.0)))
    cut(skin, rear_foot, both(rear_pillar, behind(-1.2), height(1.0)))
    cut(skin, cowl_edge, both(below, hood_side, ahead(0.5), height(0.8)))
    cut_lights(skin)
    cut_gaps(skin, shut_lines())
    for curve, half in ((MIDDLE_DOOR, PILLAR_HALF), (QUARTER_LIGHT, BAR_HALF)):
        for offset in (half, -half):
            cut(skin, widened(door(curve), offset), SIDE_GLASS)


def cut_lights(skin: Skin) -> None:
    """Lamps, intake and diffuser."""
    cut(skin, lip, both(ahead(2.0), height(0.6)))
    cut(skin, headlight_top, both(corner, widened(headlight_inner, 0.01), headlight_foot))
    cut(skin, headlight_foot, both(corner, widened(headlight_inner, 0.01), headlight_top))
    cut(skin, headlight_inner, both(corner, headlight_top, headlight_foot))
    cut(skin, widened(headlight_foot, -HEADLIGHT_STRIP), HEADLIGHT)
    cut(skin, taillight_top, both(tail))
    cut(skin, taillight_foot, both(tail, taillight_top))
    for offset in (SLOT_HALF, -SLOT_HALF):
        cut(skin, widened(slot_line, offset), both(nose, widened(negative(headlight_inner), 0.04)))
    for level in INTAKE:
        cut(skin, height(level), both(nose, widened(grille_side, 0.01)))
    cut(skin, grille_side, both(nose, band(*INTAKE)))
    cut(skin, height(SILL_TRIM), both(between_axles))
    for level in HANDLE_Z:
        cut(skin, widened(crease, -level), both(widened(handle_ends, 0.06), band(0.6, 0.95)))
    cut(skin, handle_ends, both(handle, band(0.6, 0.9)))
    for offset in (CURTAIN_HALF, -CURTAIN_HALF):
        cut(skin, widened(curtain_line, offset), both(ahead(1.8), band(0.27, 0.53)))
    for level in CURTAIN:
        cut(skin, height(level), both(ahead(1.8), curtain))
    cut(skin, height(DIFFUSER_TOP), both(behind(-2.0), inboard(DIFFUSER_SIDE + 0.04)))
    cut(skin, inboard(DIFFUSER_SIDE), both(behind(-2.0), band(0, DIFFUSER_TOP)))


PANELS = [
    Panel("windows", "trim", both(SIDE_GLASS, within(door(MIDDLE_DOOR), PILLAR_HALF))),
    Panel("windows", "trim", both(SIDE_GLASS, within(door(QUARTER_LIGHT), BAR_HALF))),
    Panel("windows", "glass", SIDE_GLASS),
    Panel("windshield", "glass", WINDSHIELD),
    Panel("rear_window", "glass", REAR_GLASS),
    Panel("roof", "paint", ROOF),
    Panel("headlights", "headlight", STRIP),
    Panel("headlights", "glass", HEADLIGHT),
    Panel("taillights", "taillight", TAILLIGHT),
    Panel("body", "trim", in_gaps(shut_lines())),
    Panel("hood", "paint", HOOD),
    Panel("body", "trim", both(below, ahead(0.5), negative(cowl_edge), hood_side, height(0.85))),
    Panel("body", "trim", both(nose, negative(headlight_inner), slot)),
    Panel("body", "trim", both(nose, grille_side, band(*INTAKE))),
    Panel("body", "trim", both(ahead(1.8), curtain, band(*CURTAIN))),
    Panel("body", "trim", both(between_axles, negative(height(SILL_TRIM)))),
    Panel("body", "trim", both(band(0.6, 0.95), handle, handle_ends)),
    Panel("body", "trim", both(behind(-2.0), band(0, DIFFUSER_TOP), inboard(DIFFUSER_SIDE))),
    Panel("body", "paint", lambda p: np.ones(len(p), dtype=bool)),
]

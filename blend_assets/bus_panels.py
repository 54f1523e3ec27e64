"""Which piece of the bus's skin belongs to which object, and the cuts that separate the pieces.

Left and right half have panels of their own, as the doors are on the right.
"""

from __future__ import annotations

import bus_lines as lines
import numpy as np
from bus_lines import flank, nose, tail
from curves import Array
from panel_lines import (
    Line,
    Panel,
    Where,
    ahead,
    band,
    both,
    height,
    in_gaps,
    negative,
    widened,
    within,
)
from skin import Skin, cut, cut_gaps, refine

# Longest edges at wheel openings, in round corners of windows and of doors, in the headlights.
COARSE = 0.10
FINE = 0.08
FINER = 0.05
LAMP = 0.075
MARGIN = 0.12  # how far lines are drawn beyond the corners of small fields
PANES = (lines.pane_front, lines.pane_rear)
side_glass = both(flank, lines.band)
between_axles = negative(lines.ends_of_bumper)
bumper = both(lines.ends_of_bumper, negative(lines.bumper_top))
lip = both(flank, negative(widened(lines.arch, -lines.ARCH_LIP)))
taillight = both(tail, lines.taillight_side, lines.taillight_end, band(*lines.TAILLIGHT_Z))
rear_bar = both(tail, negative(lines.taillight_side), band(*lines.REAR_BAR_Z))
door = both(flank, lines.door)


def common_gaps() -> list[tuple[Line, Where]]:
    """Shut lines of both halves."""
    return [(lines.roof_line, height(2.0)), (lines.bumper_top, lines.ends_of_bumper)]


def door_gaps() -> list[tuple[Line, Where]]:
    """Shut lines of the double door."""
    return [(lines.door, flank), (lines.door_middle, both(door))]


def everywhere(p: Array) -> Array:
    """True."""
    return np.ones(len(p), dtype=bool)


def cut_common(skin: Skin) -> None:
    """Panel lines of both halves into the skin (in place), the long ones first."""
    refine(skin, both(flank, within(lines.arch, 0.02)), COARSE)
    fields = (
        (lines.mask_front, nose),
        (lines.mask_rear, tail),
        (lines.glass_front, nose),
        (lines.glass_rear, tail),
    )
    for field, where in fields:
        refine(skin, both(where, lines.bend(field)), FINE)
    refine(skin, both(nose, widened(lines.headlight, 0.02)), LAMP)
    cut(skin, lines.arch)
    cut(skin, widened(lines.arch, -lines.ARCH_LIP), flank)
    cut(skin, lines.skirt)
    for field, where in fields:
        cut(skin, field, where)
    cut_lights(skin)
    cut_gaps(skin, common_gaps())
    cut(skin, lines.bumper_top, between_axles)


def cut_lights(skin: Skin) -> None:
    """Lamps, and the bars that join them (in place)."""
    cut(skin, lines.headlight, nose)
    for level in lines.LIGHT_STRIP_Z:
        cut(skin, height(level), both(nose, lines.headlight))
    for level in lines.SLOT_Z:
        cut(skin, height(level), both(nose, widened(lines.slot_end, MARGIN)))
    near = both(tail, widened(lines.taillight_side, MARGIN), widened(lines.taillight_end, MARGIN))
    for level in lines.TAILLIGHT_Z:
        cut(skin, height(level), near)
    for edge in (lines.taillight_side, lines.taillight_end):
        cut(skin, edge, both(near, widened(band(*lines.TAILLIGHT_Z), MARGIN)))
    for level in lines.REAR_BAR_Z:
        cut(skin, height(level), both(tail, negative(lines.taillight_side)))


def cut_left(skin: Skin) -> None:
    """The side windows of the left half (in place)."""
    refine(skin, both(flank, lines.bend(lines.band)), FINER)
    cut(skin, lines.band, flank)
    cut_bars(skin, lines.BARS, side_glass)


def cut_right(skin: Skin) -> None:
    """Doors and side windows of the right half, while it lies on the left (in place)."""
    refine(skin, both(flank, lines.bend(lines.band)), FINER)
    for field in (lines.door, *PANES):
        refine(skin, both(flank, lines.bend(field)), FINER)
    beside = both(flank, widened(negative(lines.door), MARGIN / 2))
    cut_gaps(skin, [(lines.door_middle, both(flank, widened(lines.door, MARGIN)))])
    cut_gaps(skin, [(lines.door, flank)])
    cut(skin, lines.band, beside)
    cut_bars(skin, lines.DOOR_SIDE_BARS, both(side_glass, beside))
    for pane in PANES:
        cut(skin, pane, door)


def cut_bars(skin: Skin, bars: tuple[float, ...], where: Where) -> None:
    """Upright bars across the side windows (in place)."""
    for x in bars:
        for offset in (lines.BAR_HALF, -lines.BAR_HALF):
            cut(skin, widened(ahead(x), offset), where)


def bars(at: tuple[float, ...]) -> list[Panel]:
    """Panels of the bars: they are no glass."""
    return [Panel("body", "trim", both(side_glass, within(ahead(x), lines.BAR_HALF))) for x in at]


FACE = [
    Panel("windshield", "glass", both(nose, lines.glass_front)),
    Panel("body", "trim", both(nose, lines.mask_front)),
    Panel("rear_window", "glass", both(tail, lines.glass_rear)),
    Panel("body", "trim", both(tail, lines.mask_rear)),
    Panel("headlights", "headlight", both(nose, lines.headlight, band(*lines.LIGHT_STRIP_Z))),
    Panel("headlights", "trim", both(nose, lines.headlight)),
    Panel("taillights", "taillight", taillight),
    Panel("taillights", "taillight", rear_bar),
    Panel("body", "trim", in_gaps(common_gaps())),
    Panel("body", "trim", both(nose, lines.slot_end, band(*lines.SLOT_Z))),
    Panel("roof", "paint", lines.roof_line),
    Panel("body", "trim", lip),
    Panel("bumper_front", "trim", both(nose, bumper, lines.skirt)),
    Panel("bumper_front", "accent", both(nose, bumper)),
    Panel("bumper_rear", "trim", both(tail, bumper, lines.skirt)),
    Panel("bumper_rear", "accent", both(tail, bumper)),
]
SIDE = [
    Panel("windows", "glass", side_glass),
    Panel("body", "trim", lines.skirt),
    Panel("body", "accent", negative(lines.bumper_top)),
    Panel("body", "paint", everywhere),
]
DOORS = [
    Panel("body", "trim", in_gaps(door_gaps())),
    Panel("door_windows", "glass", both(door, lines.pane_front)),
    Panel("door_windows", "glass", both(door, lines.pane_rear)),
    Panel("door_front", "accent", both(door, lines.door_middle, negative(lines.bumper_top))),
    Panel("door_front", "paint", both(door, lines.door_middle)),
    Panel("door_rear", "accent", both(door, negative(lines.bumper_top))),
    Panel("door_rear", "paint", door),
]
LEFT = [*FACE, *bars(lines.BARS), *SIDE]
RIGHT = [*FACE, *DOORS, *bars(lines.DOOR_SIDE_BARS), *SIDE]

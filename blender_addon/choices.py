"""What menus of the panel list: priors, targets, and regions of the ground.

A .blend file holds numbers of these lists: new entries go to the end.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

Range = tuple[float, float]  # Low and high bound [m]
FocusArea = tuple[Range, Range]  # Ranges of x and y

ALL: Range = (-math.inf, math.inf)
AHEAD: Range = (0.0, math.inf)
BEHIND: Range = (-math.inf, 0.0)
FAR_M = 40.0
CUSTOM = "custom"
ROAD = "road"
HIGHWAY = "highway"
UNIFORM = "uniform"
FROM_BOXES = "boxes"
ON_SURFACE = "SURFACE"
ON_SLOTS = "SLOTS"
"""Kinds of mounts."""
BY_PARTS = "PARTS"
BY_GROUP = "GROUP"
BY_MESH = "MESH"
"""Which faces a surface is made of."""

PRIORS = (
    (ROAD, "Road", "Cars, trucks, cyclists, pedestrians and cones as met on public roads", 0),
    (HIGHWAY, "Highway", "Cars, trucks, motorcyclists and cones on and round three lanes", 2),
    (UNIFORM, "Uniform", "Every location in the perception space has the same weight", 1),
    (FROM_BOXES, "Labelled Boxes", "Objects as in a file of labelled boxes", 3),
)
"""In the form of a Blender menu; a .blend file holds the numbers."""


OBJECTS = "objects"
EXPECTED_AP = "expected_ap"
RANDOM = "random"
"""Targets of a score, objective of a search, and the method with a schedule, that panels treat in
another way; all are declared by the engine."""
NO_BODY = "NONE"
BODY_ITEMS = (
    (NO_BODY, "None", "Not a test body"),
    ("child", "Child", "A pedestrian"),
    ("adult", "Adult", "A pedestrian"),
    ("cyclist", "Cyclist", "A cyclist"),
    ("car", "Car", "A car"),
    ("pole", "Pole", "A thin post"),
    ("cone", "Cone", "A traffic cone"),
)
"""What an object is: the sensors that see it are written beside it."""
BEFORE_MOVE = 0
"""What the live score is compared with; any other number is the key of a variant."""
SIMPLE = "SIMPLE"
PANELS = (
    (SIMPLE, "Simple", "The panels of the first hour, in plain words"),
    ("ALL", "All", "All panels, with the terms and units of the metric"),
)


@dataclass(frozen=True)
class Region:
    """A part of the ground that a focus can be set to: one or several areas."""

    key: str
    label: str
    short: str
    description: str
    areas: tuple[FocusArea, ...] = ()


REGIONS = {
    region.key: region
    for region in (
        Region("everywhere", "Everywhere", "everywhere", "The whole space", areas=((ALL, ALL),)),
        Region("front", "Front", "x > 0", "Everything ahead of the origin", areas=((AHEAD, ALL),)),
        Region("rear", "Rear", "x < 0", "Everything behind the origin", areas=((BEHIND, ALL),)),
        Region(
            "left", "Left", "y > 0", "Everything to the left of the vehicle", areas=((ALL, AHEAD),)
        ),
        Region(
            "right",
            "Right",
            "y < 0",
            "Everything to the right of the vehicle",
            areas=((ALL, BEHIND),),
        ),
        Region(
            "far",
            "Far Ahead and Behind",
            f"|x| > {FAR_M:g} m",
            f"Everything more than {FAR_M:g} m ahead or behind",
            areas=(((-math.inf, -FAR_M), ALL), ((FAR_M, math.inf), ALL)),
        ),
        Region(CUSTOM, "Custom", "custom", "Bounds that you set"),
    )
}
"""The regions in the order of the menu; a .blend file holds the position in it."""

REGION_ITEMS = tuple((each.key, each.label, each.description) for each in REGIONS.values())
"""In the form of a Blender menu."""


class LimitBox(NamedTuple):
    """An axis-aligned box in the ground frame [m], and whether it is a no-go area."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    forbidden: bool = False


class FocusRegion(NamedTuple):
    """A focus weight: its areas [m]; classes None: all."""

    name: str
    factor: float
    areas: tuple[FocusArea, ...]
    classes: tuple[str, ...] | None = None


def free_name(wanted: str, taken: set[str]) -> str:
    """Return a name that is not taken, numbered if necessary: "Idea", "Idea 2"; "Seed 0 (2)"."""
    name = wanted
    number = 2
    while name in taken:
        name = f"{wanted} ({number})" if wanted[-1:].isdigit() else f"{wanted} {number}"
        number = number + 1
    return name

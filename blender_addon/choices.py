"""What the panel offers to choose from: priors, and regions of the ground.

A .blend file holds numbers and places in these lists: new ones go to the end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

VERSION = 1
"""Of what is stored in a .blend file; `bridge.versions` brings older files up to it."""

Range = tuple[float, float]
"""Low and high bound [m]."""
Area = tuple[Range, Range]
"""Ranges of x and y."""

ALL: Range = (-math.inf, math.inf)
AHEAD: Range = (0.0, math.inf)
BEHIND: Range = (-math.inf, 0.0)
FAR_M = 40.0
CUSTOM = "custom"
ROAD, HIGHWAY, UNIFORM, FROM_BOXES = "road", "highway", "uniform", "boxes"
ON_SURFACE, ON_SLOTS = "SURFACE", "SLOTS"
"""Kinds of mounts."""
BY_PARTS, BY_MATERIAL, BY_GROUP = "PARTS", "MATERIAL", "GROUP"
"""What faces a surface is made of."""

PRIORS = (
    (ROAD, "Road", "Cars, trucks, cyclists, pedestrians and cones as met on public roads", 0),
    (HIGHWAY, "Highway", "Cars, trucks, motorcyclists and cones on and round three lanes", 2),
    (UNIFORM, "Uniform", "Every place in the perception space matters the same", 1),
    (FROM_BOXES, "Labelled Boxes", "Objects where a file of labels has them", 3),
)
"""As Blender wants a menu; the numbers are what a .blend file holds."""


VOXELS, OBJECTS = "voxels", "objects"
TARGETS = (
    (
        VOXELS,
        "Voxels",
        "How well each cube is measured: perception entropy, as in the paper",
        0,
    ),
    (
        OBJECTS,
        "Objects",
        "How well objects of the prior are found: expected AP, and how far",
        1,
    ),
)


@dataclass(frozen=True)
class Region:
    """A part of the ground that a focus can be chosen for; several areas where it is not one."""

    key: str
    label: str
    short: str
    description: str
    areas: tuple[Area, ...] = ()


REGIONS = {
    region.key: region
    for region in (
        Region("everywhere", "Everywhere", "everywhere", "The whole space", ((ALL, ALL),)),
        Region("front", "Front", "x > 0", "All that is ahead of the origin", ((AHEAD, ALL),)),
        Region("rear", "Rear", "x < 0", "All that is behind the origin", ((BEHIND, ALL),)),
        Region("left", "Left", "y > 0", "All on the vehicle's left", ((ALL, AHEAD),)),
        Region("right", "Right", "y < 0", "All on the vehicle's right", ((ALL, BEHIND),)),
        Region(
            "far",
            "Far Ahead and Behind",
            f"|x| > {FAR_M:g} m",
            f"What is more than {FAR_M:g} m ahead or behind",
            (((-math.inf, -FAR_M), ALL), ((FAR_M, math.inf), ALL)),
        ),
        Region(CUSTOM, "Custom", "custom", "Bounds of your own"),
    )
}
"""The regions in the order of the menu; a .blend file holds the place in it."""

REGION_ITEMS = tuple((each.key, each.label, each.description) for each in REGIONS.values())
"""As Blender wants a menu."""


BEFORE_MOVE, PINNED = 0, -1
"""What the live score is compared with; any other number is the key of a variant."""

NO_ANCHOR = "NONE"
"""No known rig is scored beside the live score."""


def free_name(wanted: str, taken: set[str]) -> str:
    """Return a name, with a number behind it where it is taken: "Idea", "Idea 2"."""
    name, number = wanted, 2
    while name in taken:
        name, number = f"{wanted} {number}", number + 1
    return name

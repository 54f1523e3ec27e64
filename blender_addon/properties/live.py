"""The live score: whether it follows, what it is compared with, what is told beside it."""

from __future__ import annotations

import zlib

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty

from ..choices import BEFORE_MOVE, NO_ANCHOR, PINNED
from ..engine import catalog
from .callbacks import switched

ANCHORS = (
    (NO_ANCHOR, "None", "No other rig's score beside the live one", 0),
    *(
        (
            key,
            rig.title,
            f"{len(rig.sensors)} sensors of {rig.vehicle}",
            1 + zlib.crc32(key.encode()) % 2**30,
        )
        for key, rig in catalog.known_rigs().items()
    ),
)
"""Of known rigs; a file holds a number that stays a rig's whatever others there are."""


class PE_LiveSettings(bpy.types.PropertyGroup):
    """The live score of a scene."""

    on: BoolProperty(
        name="Live",
        description="A score follows while a sensor is moved: a draft at once, exact when it "
        "rests, on a sample of voxels. Score gives that of all voxels",
        update=switched,
    )
    against: IntProperty(
        name="Compared With",
        description="What the live score is compared with: 0, the sensors before the last move; "
        "-1, those that were pinned; else the key of a variant",
        default=BEFORE_MOVE,
        min=PINNED,
        update=switched,
    )
    figures: BoolProperty(
        name="Blind Ground, Reach, AP",
        description="Tell also how much ground is blind, how far ahead a class is found, and with "
        "which AP, once things rest: for the height and the class that the 3D view shows",
        default=True,
        update=switched,
    )
    anchor: EnumProperty(
        items=ANCHORS,
        name="Beside",
        description="A known rig, stretched onto this vehicle and scored under the same prior, to "
        "have something to go by. It is scored once, in the background",
        default=NO_ANCHOR,
        update=switched,
    )

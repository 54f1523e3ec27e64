"""The live score: whether it follows."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, IntProperty

from .callbacks import switched


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
        default=0,
        min=-1,
        update=switched,
    )

"""The live score: whether it follows."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty

from .callbacks import switched


class PE_LiveSettings(bpy.types.PropertyGroup):
    """The live score of a scene."""

    on: BoolProperty(
        name="Live",
        description="A score follows while a sensor is moved: a draft at once, exact when it "
        "rests, on a sample of voxels. Score gives that of all voxels",
        update=switched,
    )

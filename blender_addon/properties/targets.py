"""What a score judges a rig on, voxels or objects, and what it found of objects."""

from __future__ import annotations

from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ..choices import TARGETS
from ..engine import pe
from .callbacks import changed


class TargetSettings:
    """A part of the scene's settings."""

    targets: EnumProperty(
        items=TARGETS,
        name="Targets",
        description="What rigs are judged on",
        update=changed,
    )
    traffic: BoolProperty(
        name="Traffic",
        description="Objects of a scene hide each other from every sensor",
        update=changed,
    )
    scenes: IntProperty(
        name="Scenes",
        description="Scenes that objects stand in; the expected score is their mean",
        default=pe.TargetRule().scenes,
        min=8,
        max=20_000,
        soft_max=4096,
        update=changed,
    )
    result_ap: StringProperty(
        name="Expected AP", description="Of all objects, by their weights, and its standard error"
    )

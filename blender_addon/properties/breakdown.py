"""The last result by zone and by class of object, for the panel's table."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty, StringProperty


class PE_ResultPart(bpy.types.PropertyGroup):
    """A zone of the ground, or a class of objects; its name is what the table calls it."""

    is_class: BoolProperty(name="Is a Class", description="A class of objects, not a zone")
    entropy: FloatProperty(name="Entropy", description="Perception entropy in it [nats]")
    coverage: FloatProperty(
        name="Coverage", description="Share of where its objects are that is seen, 0 to 1"
    )
    ap: StringProperty(name="Expected AP", description="Of a class, where objects were scored")
    reach: StringProperty(
        name="Reach", description="How far ahead a class is found with an AP of 0.5"
    )

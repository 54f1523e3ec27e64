"""What is odd about a sensor or the vehicle, as the last score told it."""

from __future__ import annotations

import bpy
from bpy.props import FloatProperty, FloatVectorProperty, IntProperty, StringProperty


class PE_Warning(bpy.types.PropertyGroup):
    """A warning in plain words (`pe_core.advice.Advice`)."""

    subject: StringProperty(name="Subject", description="Name of the sensor; empty: the vehicle")
    code: StringProperty(name="Code", description="Which warning it is")
    text: StringProperty(name="Text", description="What is odd, in a sentence")
    part: StringProperty(name="Part", description="Part of the vehicle that causes it")
    fix: StringProperty(name="Fix", description="What would mend it, if that is known")
    amount: FloatVectorProperty(
        name="Amount", description="How much of the fix: degrees, a factor, metres", size=3
    )
    amounts: IntProperty(name="Amounts", description="How many of these numbers count", max=3)


class PE_StoppingPart(bpy.types.PropertyGroup):
    """A part of the vehicle that is in a sensor's way; its name is the part's."""

    share: FloatProperty(
        name="Share", description="Share of what the sensor sees that this part stops, 0 to 1"
    )

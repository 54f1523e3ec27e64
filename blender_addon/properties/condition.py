"""States of the vehicle and weathers, as rows of the panel."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import BoolProperty, IntProperty, StringProperty

from ..engine import geometry, kinds
from .callbacks import changed
from .declared import group_of

StateFields: Any = group_of(geometry.State)
WeatherFields: Any = group_of(kinds.Weather)


class PE_State(StateFields, bpy.types.PropertyGroup):
    """A state of the vehicle: a frame of the scene, and the motions that were read there."""

    enabled: BoolProperty(
        name="Used", description="Score this state, too", default=True, update=changed
    )
    frame: IntProperty(
        name="Frame", description="Frame of the scene that shows this state", default=-1, min=-1
    )
    table: StringProperty(name="Motions", description="Motions as JSON", update=changed)


class PE_Weather(WeatherFields, bpy.types.PropertyGroup):
    """A weather. At most one of rain, snow and fog is above 0."""

    enabled: BoolProperty(
        name="Used", description="Score this weather, too", default=True, update=changed
    )

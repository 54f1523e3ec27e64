"""States of the vehicle and weathers, as rows of the panel."""

from __future__ import annotations

from typing import Any

from bpy.types import PropertyGroup

from ..engine import geometry, kinds
from .callbacks import changed
from .declared import group_of
from .fields import switch, text, whole

StateFields: Any = group_of(geometry.State)
WeatherFields: Any = group_of(kinds.Weather)


class PE_State(StateFields, PropertyGroup):
    """A state of the vehicle: a frame of the scene, and the motions that were read there."""

    enabled: switch("Used", "Score this state, too", True, update=changed)
    frame: whole("Frame", "Frame of the scene that shows this state", -1, min=-1)
    table: text("Motions", "Motions as JSON", update=changed)


class PE_Weather(WeatherFields, PropertyGroup):
    """A weather. At most one of rain, snow and fog is above 0."""

    enabled: switch("Used", "Score this weather, too", True, update=changed)

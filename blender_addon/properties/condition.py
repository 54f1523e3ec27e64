"""States of the vehicle and weathers, as rows of the panel."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty

from .callbacks import changed

WEIGHT = "Part in the weighted mean of all conditions"


class PE_State(bpy.types.PropertyGroup):
    """A state of the vehicle: a frame of the scene, and the motions that were read there."""

    enabled: BoolProperty(
        name="Used", description="Score this state, too", default=True, update=changed
    )
    weight: FloatProperty(name="Weight", description=WEIGHT, default=1.0, min=0.0, update=changed)
    frame: IntProperty(
        name="Frame", description="Frame of the scene that shows this state", default=-1, min=-1
    )
    table: StringProperty(name="Motions", description="Motions as JSON", update=changed)


class PE_Weather(bpy.types.PropertyGroup):
    """A weather. At most one of rain, snow and fog is above 0."""

    enabled: BoolProperty(
        name="Used", description="Score this weather, too", default=True, update=changed
    )
    weight: FloatProperty(name="Weight", description=WEIGHT, default=1.0, min=0.0, update=changed)
    rain_mm_h: FloatProperty(
        name="Rain mm/h", description="Rate of rain", min=0.0, max=300.0, update=changed
    )
    snow_mm_h: FloatProperty(
        name="Snow mm/h", description="Rate of snow, as water", min=0.0, max=50.0, update=changed
    )
    fog_mor_m: FloatProperty(
        name="Visibility in Fog",
        description="Visibility in fog: the meteorological optical range; 0: no fog",
        min=0.0,
        max=100_000.0,
        unit="LENGTH",
        update=changed,
    )
    night: BoolProperty(
        name="Night", description="Cameras see what headlamps light", update=changed
    )
    lit_m: FloatProperty(
        name="Lit",
        description="How far objects are lit at night; 0: as two headlamps of UN R112 light",
        min=0.0,
        max=100_000.0,
        unit="LENGTH",
        update=changed,
    )
    reflectivity: FloatProperty(
        name="Reflectivity",
        description="Of targets, relative to that for which LiDARs state their range",
        default=1.0,
        min=0.001,
        max=10.0,
        update=changed,
    )

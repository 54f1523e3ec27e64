"""Which sensors: models that may take another's place, limits on all of them, the front found."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, StringProperty

from .callbacks import model_suggestions


class PE_SensorOption(bpy.types.PropertyGroup):
    """A model that may be chosen, and its price."""

    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        search=model_suggestions,
        search_options={"SUGGESTION"},
    )
    price: FloatProperty(
        name="Price",
        description="What one of it costs, as you know it: the catalogue has no prices",
        min=0.0,
        soft_max=100_000.0,
        precision=2,
        step=1000,
    )


class OfferedModels:
    """A part of an object's settings."""

    options: CollectionProperty(
        type=PE_SensorOption, name="Models", description="Models that may take this place"
    )
    may_be_left_out: BoolProperty(
        name="May Be Left Out", description="A design may do without this sensor"
    )


class PE_FrontRow(bpy.types.PropertyGroup):
    """A design that no other beats in price and entropy: its name, and the variant that it is."""

    price: FloatProperty(name="Price", description="Of all sensors that were chosen")
    entropy: FloatProperty(name="Entropy", description="Perception entropy in nats, for display")
    key: IntProperty(name="Key", description="Of its variant")


class SelectionSettings:
    """A part of the scene's settings."""

    max_price: FloatProperty(
        name="Max Price",
        description="Of all sensors that are chosen; 0: no limit",
        min=0.0,
        soft_max=1e6,
        precision=2,
        step=1000,
    )
    max_sensors: IntProperty(
        name="Max Sensors", description="Of a design; 0: no limit", min=0, soft_max=20
    )
    currency: StringProperty(
        name="Currency", description="What prices are told in", default="", maxlen=12
    )
    front: CollectionProperty(
        type=PE_FrontRow, name="Front", description="Designs that no other beats, cheapest first"
    )
    front_told: StringProperty(name="Told", description="How many designs were looked at, and how")

"""Stored results: parts and warnings of the last score, variants, the Pareto front."""

from __future__ import annotations

import bpy
from bpy.props import (
    BoolProperty,
    BoolVectorProperty,
    CollectionProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from ..choices import free_name
from ..engine import search


class PE_ResultPart(bpy.types.PropertyGroup):
    """A zone of the ground or a class of objects, with its label in the table as its name."""

    is_class: BoolProperty(name="Is a Class", description="A class of objects, not a zone")
    entropy: FloatProperty(name="Entropy", description="Perception entropy in it [nats]")
    coverage: FloatProperty(
        name="Coverage", description="Share of where its objects are that is seen, 0 to 1"
    )
    ap: StringProperty(name="Expected AP", description="Of a class, where objects were scored")
    reach: StringProperty(
        name="Reach", description="How far ahead a class is found with an AP of 0.5"
    )


class PE_Warning(bpy.types.PropertyGroup):
    """A stored warning (`pe_tools.advice.Advice`)."""

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
    """A part of the vehicle that blocks a sensor; the row has the name of the part."""

    share: FloatProperty(
        name="Share", description="Share of what the sensor sees that this part stops, 0 to 1"
    )


MAX_NAME_LENGTH = 60


def _keep_apart(variant: PE_Variant, _context: bpy.types.Context) -> None:
    """Update callback of a variant's name: names are unique and not empty."""
    rows = variant.id_data.perception_entropy.variants
    taken = {row.name for row in rows if row.key != variant.key}
    name = free_name(variant.name.strip() or "Variant", taken)
    if name != variant.name:
        variant.name = name


class PE_VariantSensor(bpy.types.PropertyGroup):
    """A sensor as a variant stores it: see `bridge.SensorRecord`."""

    name: StringProperty(name="Name", description="Name of the sensor's object")
    model: StringProperty(name="Model", description="Name of the sensor in the catalogue")
    fusion: StringProperty(name="Fusion", description="Its group, empty for the usual one")
    own_curve: BoolProperty(name="Own AP Curve", description="It does not take its kind's")
    curve_a: FloatProperty(name="a", description="AP = a ln m + b: slope")
    curve_b: FloatProperty(name="b", description="AP = a ln m + b: value at one point")
    pose: FloatVectorProperty(
        name="Placement",
        description="x, y, z [m], roll, pitch, yaw [deg]",
        size=len(search.AXES),
    )
    free: BoolVectorProperty(
        name="Free Axes", description="What the search may change", size=len(search.AXES)
    )
    bounded: BoolVectorProperty(
        name="Bounded", description="Axes that have bounds of their own", size=len(search.AXES)
    )
    bounds_low: FloatVectorProperty(
        name="Low Bounds", description="Of these axes [m or deg]", size=len(search.AXES)
    )
    bounds_high: FloatVectorProperty(
        name="High Bounds", description="Of these axes [m or deg]", size=len(search.AXES)
    )
    mirror_of: StringProperty(name="Mirror Of", description="The sensor it is linked to")
    mount: StringProperty(name="Mount", description="Where the search may put it")
    rack: StringProperty(name="Rack", description="What it moves with")
    visible: BoolProperty(name="Visible", description="It is seen, and so it counts", default=True)
    display: StringProperty(name="Display", description="How its empty is drawn", default="ARROWS")
    size: FloatProperty(name="Size", description="How large its empty is drawn", default=0.25)


class PE_Variant(bpy.types.PropertyGroup):
    """A variant: the records of all sensors, and the result of scoring them."""

    name: StringProperty(
        name="Name",
        description="Name of the variant. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_keep_apart,
    )
    key: IntProperty(name="Key", description="Tells it from the others, whatever its name")
    note: StringProperty(name="Note", description="What is to be remembered of it")
    holds_ties: BoolProperty(
        name="Holds Ties",
        description="It knows its sensors' mirror links, mounts and racks; older ones do not",
        options={"HIDDEN"},
    )
    sensors: CollectionProperty(
        type=PE_VariantSensor, name="Sensors", description="Where each sensor stands"
    )

    has_result: BoolProperty(name="Has Result", description="It has been scored")
    entropy: FloatProperty(name="Entropy", description="Perception entropy in nats, for display")
    coverage: FloatProperty(name="Coverage", description="Share of the prior that is seen, 0 to 1")
    stderr: FloatProperty(name="Standard Error", description="Of the perception entropy")
    voxels: IntProperty(name="Voxels", description="Voxels that were looked at", subtype="UNSIGNED")
    score_json: StringProperty(
        name="Score", description="The score in full: zones, classes, sensors"
    )
    figures_json: StringProperty(
        name="Figures", description="Blind ground, reach ahead and expected AP"
    )
    figures_of: StringProperty(
        name="Figures Of",
        description="Vehicle, prior, settings, height and class that the figures are of",
    )
    signature: StringProperty(
        name="Signature", description="Vehicle, prior and settings it was scored with"
    )
    stale: BoolProperty(
        name="Stale", description="Vehicle, prior or settings have changed since it was scored"
    )


class PE_FrontRow(bpy.types.PropertyGroup):
    """A design of the Pareto front of price and entropy, with the key of its variant."""

    price: FloatProperty(name="Price", description="Of all sensors that were chosen")
    entropy: FloatProperty(name="Entropy", description="Perception entropy in nats, for display")
    key: IntProperty(name="Key", description="Of its variant")

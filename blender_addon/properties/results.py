"""Variants of a scene: sets of sensors with their scores."""

from __future__ import annotations

from typing import Any

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
from ..engine import pe, search
from .declared import group_of

MAX_NAME_LENGTH = 60


def _keep_apart(variant: PE_Variant, _context: bpy.types.Context) -> None:
    """Update callback of a variant's name: names are unique and not empty."""
    rows = variant.id_data.perception_entropy.variants
    taken = {row.name for row in rows if row.key != variant.key}
    name = free_name(variant.name.strip() or "Variant", taken)
    if name != variant.name:
        variant.name = name


CurveFields: Any = group_of(pe.ApCurve, prefix="curve_", update=None)


class PE_VariantSensor(CurveFields, bpy.types.PropertyGroup):
    """A sensor as a variant stores it: see `bridge.SensorRecord`."""

    name: StringProperty(name="Name", description="Name of the sensor's object")
    model: StringProperty(name="Model", description="Name of the sensor in the catalogue")
    fusion: StringProperty(name="Fusion", description="Fusion group; empty for the default")
    own_curve: BoolProperty(name="Own AP Curve", description="The sensor has its own AP curve")
    pose: FloatVectorProperty(
        name="Placement",
        description="x, y, z [m], roll, pitch, yaw [deg]",
        size=len(search.AXES),
    )
    free: BoolVectorProperty(
        name="Free Axes", description="Axes that the search may change", size=len(search.AXES)
    )
    bounded: BoolVectorProperty(
        name="Bounded", description="Axes with their own bounds", size=len(search.AXES)
    )
    bounds_low: FloatVectorProperty(
        name="Low Bounds", description="Bounds of these axes [m or deg]", size=len(search.AXES)
    )
    bounds_high: FloatVectorProperty(
        name="High Bounds", description="Bounds of these axes [m or deg]", size=len(search.AXES)
    )
    mirror_of: StringProperty(name="Mirror Of", description="Linked mirror image")
    mount: StringProperty(name="Mount", description="Mount of the sensor in a search")
    rack: StringProperty(name="Rack", description="Rack that moves as one")
    visible: BoolProperty(
        name="Visible", description="The sensor is visible, so it is scored", default=True
    )
    display: StringProperty(
        name="Display", description="Display type of the sensor's empty", default="ARROWS"
    )
    size: FloatProperty(name="Size", description="Display size of the sensor's empty", default=0.25)


class PE_Variant(bpy.types.PropertyGroup):
    """A variant: the records of all sensors, and the result of scoring them."""

    name: StringProperty(
        name="Name",
        description="Name of the variant. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_keep_apart,
    )
    key: IntProperty(
        name="Key", description="Identifies the variant, also after a change of its name"
    )
    note: StringProperty(name="Note", description="Note about the variant")
    holds_ties: BoolProperty(
        name="Holds Ties",
        description="The variant stores mirror links, mounts and racks; variants of older versions "
        "do not",
        options={"HIDDEN"},
    )
    sensors: CollectionProperty(
        type=PE_VariantSensor, name="Sensors", description="Pose of each sensor"
    )

    has_result: BoolProperty(name="Has Result", description="The variant has a score")
    entropy: FloatProperty(name="Entropy", description="Perception entropy in nats, for display")
    coverage: FloatProperty(name="Coverage", description="Visible share of the prior, 0 to 1")
    stderr: FloatProperty(
        name="Standard Error", description="Standard error of the perception entropy"
    )
    voxels: IntProperty(name="Voxels", description="Number of evaluated voxels", subtype="UNSIGNED")
    score_json: StringProperty(name="Score", description="The full score: zones, classes, sensors")
    figures_json: StringProperty(
        name="Figures", description="Blind ground, reach ahead and expected AP"
    )
    figures_of: StringProperty(
        name="Figures Of",
        description="Vehicle, prior, settings, height and class of the figures",
    )
    signature: StringProperty(
        name="Signature", description="Vehicle, prior and settings of the score"
    )
    stale: BoolProperty(
        name="Stale",
        description="Vehicle, prior or settings have changed since the variant was scored",
    )

"""Variants of a scene: sets of sensors with their scores."""

from __future__ import annotations

from typing import Any

import bpy

from ..choices import free_name
from ..engine import pe, search
from .declared import group_of
from .fields import number, numbers, rows, switch, switches, text, whole

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

    name: text("Name", "Name of the sensor's object")
    model: text("Model", "Name of the sensor in the catalogue")
    fusion: text("Fusion", "Fusion group; empty for the default")
    own_curve: switch("Own AP Curve", "The sensor has its own AP curve")
    pose: numbers("Placement", "x, y, z [m], roll, pitch, yaw [deg]", len(search.AXES))
    free: switches("Free Axes", "Axes that the search may change", len(search.AXES))
    bounded: switches("Bounded", "Axes with their own bounds", len(search.AXES))
    bounds_low: numbers("Low Bounds", "Bounds of these axes [m or deg]", len(search.AXES))
    bounds_high: numbers("High Bounds", "Bounds of these axes [m or deg]", len(search.AXES))
    mirror_of: text("Mirror Of", "Linked mirror image")
    mount: text("Mount", "Mount of the sensor in a search")
    rack: text("Rack", "Rack that moves as one")
    visible: switch("Visible", "The sensor is visible, so it is scored", True)
    display: text("Display", "Display type of the sensor's empty", "ARROWS")
    size: number("Size", "Display size of the sensor's empty", 0.25)


class PE_Variant(bpy.types.PropertyGroup):
    """A variant: the records of all sensors, and the result of scoring them."""

    name: text(
        "Name",
        "Name of the variant. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_keep_apart,
    )
    key: whole("Key", "Identifies the variant, also after a change of its name")
    note: text("Note", "Note about the variant")
    holds_ties: switch(
        "Holds Ties",
        "The variant stores mirror links, mounts and racks; variants of older versions do not",
        options={"HIDDEN"},
    )
    sensors: rows("Sensors", "Pose of each sensor", PE_VariantSensor)

    has_result: switch("Has Result", "The variant has a score")
    entropy: number("Entropy", "Perception entropy in nats, for display")
    coverage: number("Coverage", "Visible share of the prior, 0 to 1")
    stderr: number("Standard Error", "Standard error of the perception entropy")
    voxels: whole("Voxels", "Number of evaluated voxels", subtype="UNSIGNED")
    score_json: text("Score", "The full score: zones, classes, sensors")
    figures_json: text("Figures", "Blind ground, reach ahead and expected AP")
    figures_of: text("Figures Of", "Vehicle, prior, settings, height and class of the figures")
    signature: text("Signature", "Vehicle, prior and settings of the score")
    stale: switch("Stale", "Vehicle, prior or settings have changed since the variant was scored")

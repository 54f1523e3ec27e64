"""What is seldom changed: space, clearance, AP curves, own sensors, bounds of the search."""

from __future__ import annotations

import bpy
from bpy.props import (
    BoolProperty,
    BoolVectorProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from ..engine import pe, search
from .callbacks import changed

SPACE = pe.PerceptionSpace()
CLEARANCE_M = 0.02
"""As a study has it."""
OWN_KINDS = (
    ("lidar", "LiDAR", "Beams of channels that are evenly spread"),
    ("camera", "Camera", "A pinhole camera with square pixels, or one with a lens of its own"),
)


def _bounds_of_space(axis: str) -> FloatVectorProperty:
    return FloatVectorProperty(
        name=axis.upper(),
        description="From and to: the box whose voxels are scored",
        size=2,
        default=getattr(SPACE, axis),
        unit="LENGTH",
        precision=2,
        update=changed,
    )


class PE_CurveSettings(bpy.types.PropertyGroup):
    """The AP curve of a kind of sensor, whose name it has: AP = a ln m + b."""

    own: BoolProperty(
        name="Own", description="Use these numbers, as pe fit finds them", update=changed
    )
    a: FloatProperty(
        name="a", description="AP = a ln m + b: slope", precision=4, min=1e-12, update=changed
    )
    b: FloatProperty(
        name="b", description="AP = a ln m + b: value at one point", precision=4, update=changed
    )


class PE_OwnSensorSettings(bpy.types.PropertyGroup):
    """A sensor of one's own; its name is that of the model."""

    kind: EnumProperty(items=OWN_KINDS, name="Kind", description="What it is", update=changed)
    channels: IntProperty(
        name="Channels",
        description="Number of channels, evenly spread over the field of view",
        default=32,
        min=1,
        max=2048,
        update=changed,
    )
    elevations: FloatVectorProperty(
        name="Elevation °",
        description="Lowest and highest channel in degrees above the horizon",
        size=2,
        default=(-25.0, 15.0),
        min=-90.0,
        max=90.0,
        update=changed,
    )
    azimuths: FloatVectorProperty(
        name="Azimuth °",
        description="From and to in degrees, positive is left",
        size=2,
        default=(-180.0, 180.0),
        min=-360.0,
        max=360.0,
        update=changed,
    )
    azimuth_step: FloatProperty(
        name="Azimuth Step °",
        description="Degrees from beam to beam of a channel",
        default=0.2,
        min=0.001,
        max=360.0,
        precision=3,
        update=changed,
    )
    max_range: FloatProperty(
        name="Range",
        description="Farthest distance at which a beam counts",
        default=200.0,
        min=0.01,
        unit="LENGTH",
        update=changed,
    )
    min_range: FloatProperty(
        name="From",
        description="Nearest distance at which a beam counts",
        default=0.0,
        min=0.0,
        unit="LENGTH",
        update=changed,
    )
    width: IntProperty(
        name="Width", description="Pixels across", default=1920, min=1, update=changed
    )
    height: IntProperty(
        name="Height", description="Pixels down", default=1080, min=1, update=changed
    )
    hfov: FloatProperty(
        name="Field of View °",
        description="Horizontal field of view in degrees",
        default=90.0,
        min=0.001,
        max=179.9,
        update=changed,
    )
    lens: StringProperty(
        name="Lens",
        description="In place of the field of view, as in a study: fx = 930, cx = 965, cy = 530, "
        'distortion = { model = "brown-conrady", k1 = -0.16 }. Also min_range_m and max_range_m',
        update=changed,
    )
    problem: StringProperty(name="Problem", description="Why it cannot be used, if so")
    known_as: StringProperty(name="Known As", description="Its name when last looked at")


class AdvancedSceneSettings:
    """A part of the scene's settings."""

    space_x: _bounds_of_space("x")
    space_y: _bounds_of_space("y")
    space_z: _bounds_of_space("z")
    space_interval: FloatProperty(
        name="Voxel",
        description="Side of a voxel; it has to divide the space",
        default=SPACE.interval,
        min=0.001,
        soft_max=1.0,
        unit="LENGTH",
        update=changed,
    )
    clearance: FloatProperty(
        name="Clearance",
        description="How proud of the skin a flush-mounted sensor counts",
        default=CLEARANCE_M,
        min=0.0,
        max=0.99,
        unit="LENGTH",
        update=changed,
    )
    curves: CollectionProperty(
        type=PE_CurveSettings, name="AP Curves", description="What measurements are worth, by kind"
    )
    own_sensors: CollectionProperty(
        type=PE_OwnSensorSettings, name="Own Sensors", description="Models of this file's own"
    )
    own_index: IntProperty(
        name="Selected Own Sensor", description="Row of the list whose figures are shown", min=0
    )


class SearchBounds:
    """A part of a sensor's settings."""

    bounded: BoolVectorProperty(
        name="Bounded",
        description="The search keeps within bounds of its own here; else the vehicle's outline",
        size=len(search.AXES),
    )
    bounds_low: FloatVectorProperty(
        name="From",
        description="Lowest value that the search may try: metres, or degrees",
        size=len(search.AXES),
        precision=3,
    )
    bounds_high: FloatVectorProperty(
        name="To",
        description="Highest value that the search may try: metres, or degrees",
        size=len(search.AXES),
        precision=3,
    )

"""What a search's placements have to stand, and what that costs those it began with and found."""

from __future__ import annotations

from bpy.props import BoolProperty, FloatProperty, StringProperty


class ToleranceSettings:
    """A part of the scene's settings."""

    mounting_errors: BoolProperty(
        name="Mounting Errors",
        description="Judge each candidate by its mean over small errors of mounting, so that what "
        "is found can be bolted on. A candidate takes about eight times as long",
    )
    tolerance_position: FloatProperty(
        name="Position",
        description="How far off sensors are mounted along each axis: 1 sigma",
        default=0.01,
        min=0.0,
        max=1.0,
        precision=3,
        step=0.1,
        unit="LENGTH",
    )
    tolerance_angle: FloatProperty(
        name="Angle °",
        description="How far off sensors are turned about each of their axes, in degrees: 1 sigma",
        default=0.3,
        min=0.0,
        max=45.0,
        precision=2,
        step=1.0,
    )
    failures: BoolProperty(
        name="Sensor Failures",
        description="Judge each candidate by its mean over the loss of each one sensor",
    )
    worst: BoolProperty(
        name="Worst Case",
        description="Judge by the worst of mounting errors and failures instead of their mean",
    )

    result_mounted_off: StringProperty(
        name="Mounted Off",
        description="What mounting errors add to the entropy on average, before and after",
    )
    result_sensor_lost: StringProperty(
        name="Sensor Lost",
        description="What the loss of one sensor adds to the entropy on average, before and after",
    )
    result_fragile: StringProperty(
        name="Fragile", description="Why what was found cannot be mounted exactly enough, if so"
    )

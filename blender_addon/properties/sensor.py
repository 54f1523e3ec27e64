"""What is stored on an object: what makes it a sensor, and its part in the last result."""

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

from ..engine import search
from .advanced import SearchBounds
from .callbacks import changed, model_chosen, models_of_a_kind, own_curve_switched, redraw
from .mounting import MountedSettings
from .pose import GroundPose
from .selection import OfferedModels
from .warnings import PE_StoppingPart

DEFAULT_MODEL = "Pandar64"
AXIS_LABELS = ("X", "Y", "Z", "Roll", "Pitch", "Yaw")
"""Of `search.AXES`."""
FREE_BY_DEFAULT = tuple(axis in search.PAPER_FREE for axis in search.AXES)


class PE_ObjectSettings(
    GroundPose, SearchBounds, MountedSettings, OfferedModels, bpy.types.PropertyGroup
):
    """What makes an object a sensor, and its part in the last result."""

    is_sensor: BoolProperty(
        name="Is a Sensor",
        description="This object is a sensor: its x axis looks ahead, z is up",
        update=changed,
    )
    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        default=DEFAULT_MODEL,
        search=models_of_a_kind,
        search_options={"SUGGESTION"},  # what is typed is kept, and answered in words
        update=model_chosen,
    )
    fusion: StringProperty(
        name="Fusion",
        description="Sensors of one group count their beams or pixels together. When empty, all "
        "LiDARs are one group and each camera stands alone",
        update=changed,
    )
    own_curve: BoolProperty(
        name="Own AP Curve",
        description="Take the numbers below for this sensor, not its kind's. Sensors of one fusion "
        "group have one curve",
        update=own_curve_switched,
    )
    curve_a: FloatProperty(
        name="a", description="AP = a ln m + b: slope", precision=4, min=1e-12, update=changed
    )
    curve_b: FloatProperty(
        name="b", description="AP = a ln m + b: value at one point", precision=4, update=changed
    )
    free: BoolVectorProperty(
        name="Free Axes",
        description="What the search may change",
        size=len(search.AXES),
        default=FREE_BY_DEFAULT,
    )
    show: BoolProperty(
        name="Show Beams",
        description="Draw this sensor's beams or frustum in the 3D view",
        default=True,
        update=redraw,
    )
    placed: FloatVectorProperty(
        name="Placed",
        description="Placement last written by a search: x, y, z [m], roll, pitch, yaw [deg]",
        size=len(search.AXES),
        options={"HIDDEN"},
    )

    stands_when_dropped: BoolProperty(
        name="Stands When Dropped",
        description="Stands upright on the surface when it is dropped from the asset browser",
        options={"HIDDEN"},
    )
    is_parked: BoolProperty(
        name="Is Parked",
        description="A sensor that is set aside, as it belongs to another variant",
        options={"HIDDEN"},
    )
    parked_from: StringProperty(
        name="Parked From",
        description="Collections it was taken out of, as it belongs to another variant",
    )

    mirror_of: StringProperty(
        name="Mirror Of", description="Name of the sensor that is linked as its mirror image"
    )

    has_result: BoolProperty(name="Has Result", description="The last result knows this sensor")
    result_of: StringProperty(
        name="Result Of", description="Name of the sensor that the result is of: a copy brings it"
    )
    result_run: StringProperty(
        name="Result Run", description="Signature of the scene's result that it came with"
    )
    entropy: FloatProperty(
        name="Alone", description="Perception entropy if this were the only sensor [nats]"
    )
    coverage: FloatProperty(
        name="Coverage", description="Share of the prior that this sensor sees, 0 to 1"
    )
    beams: IntProperty(
        name="Beams", description="Beams of one revolution; places of a camera's picture"
    )
    stopped: IntProperty(
        name="Stopped", description="Beams, or places of the picture, that the vehicle itself stops"
    )
    stopped_text: StringProperty(
        name="Stopped By", description="Which parts of the vehicle stop how many beams"
    )

    loss_text: StringProperty(
        name="Loss", description="How much the rig's entropy rises when this sensor fails [nats]"
    )
    loss_where: StringProperty(
        name="Costs Most", description="Where it rises most, and how much there [nats]"
    )
    words: StringProperty(
        name="In Words", description="What the last result says of this sensor, a line each"
    )
    stopped_parts: CollectionProperty(
        type=PE_StoppingPart, name="Stopped By", description="Parts of the vehicle in its way"
    )
    is_view: BoolProperty(
        name="Is a View", description="This camera shows what the sensor sees that it rides on"
    )

    see_through: BoolProperty(
        name="Cameras See Through",
        description="Glass: cameras see through this object; LiDAR beams are stopped all the same",
        update=changed,
    )

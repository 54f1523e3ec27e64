"""Settings of the overlay in the 3D view: a switch for each layer, and display options.

Older settings stay on the scene, where scripts and older files have them: `show_overlay`,
`beam_limit` and `beam_length`.
"""

from __future__ import annotations

import zlib

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from ..choices import BEFORE_MOVE, NO_ANCHOR, PINNED
from ..engine import catalog, pe
from .callbacks import redraw, switched

DEFAULT_CLASS = "pedestrian"
HEIGHTS = (
    ("H0", "Ground", "The voxels that stand on the ground", 1),
    ("H50", "0.5 m", "As high as a bumper or a cone", 2),
    ("H100", "1 m", "As high as a bonnet", 3),
    ("H150", "1.5 m", "As high as heads and roofs", 4),
)
TALL = (
    ("H0", "Flat", "What lies flat on the ground: the gaps between a LiDAR's rings are blind", 1),
    ("H50", "0.5 m", "A cone, a crouching child, a low wall", 2),
    ("H100", "1 m", "A child", 3),
    ("H150", "1.5 m", "A car, a grown person", 4),
)
AVERAGED = ("AVERAGE", "Average", "All heights, by how likely an object is there: as scored", 0)
COLORS = (
    ("STATE", "Free or Occluded", "Blue beams are free, orange beams end on the vehicle"),
    (
        "SENSOR",
        "Sensor",
        "Each sensor has a colour of its own, as in the list; orange beams end on the vehicle",
    ),
    ("CHANNEL", "Channel", "From the lowest channel, dark, to the highest, bright"),
)


def classes_of(
    _view: bpy.types.PropertyGroup, context: bpy.types.Context, _typed: str
) -> list[str]:
    """Return the classes of the scene's prior; for boxes from a file, those of the road."""
    highway = context.scene.perception_entropy.prior == "highway"
    return list((pe.Prior.highway() if highway else pe.Prior.road()).class_names)


class PE_ViewSettings(bpy.types.PropertyGroup):
    """Settings of what the 3D view draws."""

    show_ground: BoolProperty(
        name="Ground Map",
        description="Colour the ground by how well sensors see it",
        default=True,
        update=redraw,
    )
    ground_quantity: EnumProperty(
        items=(
            ("SENSORS", "Sensors", "Number of sensors that see a location: none, 1, 2, 3 or more"),
            ("COVERAGE", "Coverage", "Share of a location that is visible to a sensor"),
            ("ENTROPY", "Entropy", "Uncertainty of a detector in nats; lower is better"),
            ("REDUNDANCY", "Redundancy", "What is left when any one sensor is lost, or kinds"),
        ),
        name="Show",
        description="Quantity that the colours of the ground show",
        default="ENTROPY",
        update=redraw,
    )
    redundancy_of: EnumProperty(
        items=(
            ("SENSORS_LEFT", "Sensors Left", "The fewest sensors when any one is lost"),
            ("KINDS", "Kinds", "How many kinds of sensors see the test body"),
            ("KINDS_LEFT", "Kinds Left", "The fewest kinds when any one sensor is lost"),
        ),
        name="Redundancy",
        description="What the redundancy map shows",
        update=redraw,
    )
    redundancy_height: FloatProperty(
        name="Body Height",
        description="Height of the test body: a cylinder 0.3 m wide that stands alone",
        default=0.8,
        min=0.01,
        max=5.0,
        unit="LENGTH",
        update=redraw,
    )
    ground_height: EnumProperty(
        items=(AVERAGED, *HEIGHTS),
        name="Height",
        description="Height above the ground that is evaluated",
        update=redraw,
    )
    ground_opacity: FloatProperty(
        name="Opacity",
        description="Opacity of the map's colours",
        default=0.35,
        min=0.05,
        max=1.0,
        subtype="FACTOR",
        update=redraw,
    )

    ground_range: EnumProperty(
        items=(
            (
                "FITTED",
                "Fitted",
                "Colours are spread over what this scene shows: all but the lowest and the "
                "highest 2 % of its places. Kept from the first score on, until it is fitted again",
            ),
            (
                "WHOLE",
                "Whole",
                "From what nobody sees to what is seen best: the same colours in "
                "every scene, and on review pages",
            ),
            ("FIXED", "Fixed", "Between two values that you set"),
        ),
        name="Range",
        description="Range of values of the ground map's colours; the bright end is good",
        update=redraw,
    )
    ground_fits: IntProperty(
        name="Fits",
        description="How often the range of the colours was fitted again",
        options={"HIDDEN"},
        update=redraw,
    )
    entropy_range: FloatVectorProperty(
        name="Entropy",
        description="Entropy at the dark and at the bright end [nats]",
        size=2,
        default=(16.7, -11.0),
        precision=1,
        update=redraw,
    )
    coverage_range: FloatVectorProperty(
        name="Coverage",
        description="Coverage at the dark and at the bright end, 0 to 1",
        size=2,
        default=(0.0, 1.0),
        min=0.0,
        max=1.0,
        precision=2,
        update=redraw,
    )
    ground_difference: BoolProperty(
        name="Difference",
        description="Show where the rig is better (blue) or worse (orange) than the rig that Live "
        "is compared with: before the last move, pinned sensors, or a variant",
        update=redraw,
    )

    show_axles: BoolProperty(
        name="Axles",
        description="Show the axles, if they are known, and the axes on the ground under the rear "
        "axle: the origin of other programs",
        default=True,
        update=redraw,
    )
    show_front: BoolProperty(
        name="Front",
        description="Show with an arrow where the front of the vehicle is, until there is a sensor",
        default=True,
        update=redraw,
    )
    show_ghosts: BoolProperty(
        name="Other Variant",
        description="Show the variant whose ghost is switched on in the list of variants",
        default=True,
        update=redraw,
    )
    ghost_key: IntProperty(
        name="Ghost", description="Key of the variant that is shown; 0: none", update=redraw
    )
    show_requirements: BoolProperty(
        name="Requirements",
        description="Draw the zones of requirements: filled where they are met, hatched where "
        "they are not",
        default=True,
        update=redraw,
    )
    show_place: BoolProperty(
        name="Queried Location",
        description="Mark the queried location",
        default=True,
        update=redraw,
    )

    show_focus: BoolProperty(
        name="Focus",
        description="Outline the regions with a higher or lower weight than in the prior",
        default=True,
        update=redraw,
    )
    show_mounts: BoolProperty(
        name="Mounts",
        description="Tint the surfaces of mounts; no-go areas and bounds are boxes",
        default=True,
        update=redraw,
    )
    show_blind: BoolProperty(
        name="Blind Ground",
        description="Outline the ground round the vehicle that no sensor sees, with its extent on "
        "each side",
        default=True,
        update=redraw,
    )
    blind_height: EnumProperty(
        items=TALL,
        name="Height",
        description="Height of an object on the ground; ground where it is invisible is blind",
        default="H50",
        update=redraw,
    )

    show_reach: BoolProperty(
        name="Reach",
        description="Draw the distance up to which objects of a class are found: average precision "
        "of at least 0.5",
        default=False,
        update=redraw,
    )
    reach_class: StringProperty(
        name="Class",
        description="Class of the objects",
        default=DEFAULT_CLASS,
        search=classes_of,
        search_options=set(),
        update=redraw,
    )
    reach_of: EnumProperty(
        items=(
            ("RIG", "Rig", "All sensors together"),
            ("SELECTED", "Selected", "All together, and each selected sensor alone"),
            ("ALL", "All", "All together, and each sensor alone"),
        ),
        name="Of",
        description="Sensors whose reach is drawn",
        update=redraw,
    )

    show_frustums: BoolProperty(
        name="Camera Views",
        description="Draw the cameras' fields of view, true to lens and pitch",
        default=True,
        update=redraw,
    )
    footprints: BoolProperty(
        name="On the Ground",
        description="Draw the ground in a camera's field of view, up to the range or the horizon",
        default=True,
        update=redraw,
    )
    view_range: FloatProperty(
        name="Range",
        description="Drawn length of a camera's view on the ground",
        default=12.0,
        min=0.5,
        soft_max=100.0,
        subtype="DISTANCE",
        unit="LENGTH",
        update=redraw,
    )

    show_beams: BoolProperty(
        name="Beams",
        description="Draw a sample of LiDAR beams, with the true share of beams that end on the "
        "vehicle",
        default=True,
        update=redraw,
    )
    beams_of: EnumProperty(
        items=(
            ("SELECTED", "Selected", "Beams of selected sensors"),
            ("ALL", "All", "Beams of all sensors"),
        ),
        name="Of",
        description="Sensors whose beams are drawn",
        update=redraw,
    )
    channels: EnumProperty(
        items=(
            ("FEW", "Few", "A few channels from the highest to the lowest"),
            ("ONE", "One", "A single channel"),
            ("EVERY", "Every nth", "Every nth channel"),
            ("ALL", "All", "All channels"),
        ),
        name="Channels",
        description="Channels whose beams are drawn",
        update=redraw,
    )
    channel: IntProperty(
        name="Channel",
        description="Number of the channel; the lowest is 1",
        default=1,
        min=1,
        update=redraw,
    )
    every: IntProperty(
        name="Every", description="2: every second channel", default=4, min=1, update=redraw
    )
    beam_colors: EnumProperty(
        items=COLORS,
        name="Color By",
        description="Quantity that the colours of beams show",
        default="SENSOR",
        update=redraw,
    )
    rings: BoolProperty(
        name="On the Ground",
        description="Draw the rings in which channels meet the ground",
        default=True,
        update=redraw,
    )

    show_heat: BoolProperty(
        name="Occluded Beams",
        description="Colour the vehicle where it occludes beams, by their number",
        default=False,
        update=redraw,
    )
    show_labels: BoolProperty(
        name="Names",
        description="Write each sensor's name beside it",
        default=True,
        update=redraw,
    )
    show_inset: BoolProperty(
        name="Picture in View",
        description="Show what the selected sensor sees in a corner of the 3D view",
        update=redraw,
    )
    show_legend: BoolProperty(
        name="Legend",
        description="Explain the colours in the lower right corner",
        default=True,
        update=redraw,
    )


ANCHORS = (
    (NO_ANCHOR, "None", "No other rig's score beside the live one", 0),
    *(
        (
            key,
            rig.title,
            f"{len(rig.sensors)} sensors of {rig.vehicle}",
            1 + zlib.crc32(key.encode()) % 2**30,
        )
        for key, rig in catalog.known_rigs().items()
    ),
)
"""Of known rigs; a file holds a number that stays a rig's whatever others there are."""


class PE_LiveSettings(bpy.types.PropertyGroup):
    """The live score of a scene."""

    on: BoolProperty(
        name="Live",
        description="Update a score while a sensor moves: a preview at once, an exact score when "
        "the scene is idle, on a sample of voxels. Score evaluates all voxels",
        update=switched,
    )
    against: IntProperty(
        name="Compared With",
        description="Reference of the live score: 0, the sensors before the last move; -1, the "
        "pinned sensors; otherwise the key of a variant",
        default=BEFORE_MOVE,
        min=PINNED,
        update=switched,
    )
    figures: BoolProperty(
        name="Blind Ground, Reach, AP",
        description="Add blind ground, reach ahead and AP when the scene is idle, for the height "
        "and the class that the 3D view shows",
        default=True,
        update=switched,
    )
    anchor: EnumProperty(
        items=ANCHORS,
        name="Known Rig",
        description="A known rig, scaled to this vehicle and scored under the same prior, for "
        "comparison. It is scored once, in the background",
        default=NO_ANCHOR,
        update=switched,
    )

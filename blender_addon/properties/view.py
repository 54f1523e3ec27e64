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
    ("STATE", "Free or Stopped", "Blue beams go free, orange ones end on the vehicle"),
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
        description="Colour the ground by how well it is seen",
        default=True,
        update=redraw,
    )
    ground_quantity: EnumProperty(
        items=(
            ("SENSORS", "Sensors", "How many sensors see a place: nobody, 1, 2, 3 or more"),
            ("COVERAGE", "Coverage", "What share of a place some sensor sees"),
            ("ENTROPY", "Entropy", "How uncertain a detector is there, in nats; lower is better"),
        ),
        name="Show",
        description="What the colours of the ground tell",
        default="ENTROPY",
        update=redraw,
    )
    ground_height: EnumProperty(
        items=(AVERAGED, *HEIGHTS),
        name="Height",
        description="How high above the ground to look",
        update=redraw,
    )
    ground_opacity: FloatProperty(
        name="Opacity",
        description="How much of what lies below the map's colours hide",
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
                "Colours are spread over what this scene shows: all but the "
                "lowest and the highest 2 % of its places",
            ),
            (
                "WHOLE",
                "Whole",
                "From what nobody sees to what is seen best: the same colours in "
                "every scene, and on review pages",
            ),
            ("FIXED", "Fixed", "Between values of your own"),
        ),
        name="Range",
        description="What the colours of the ground map are spread over; the bright end is good",
        update=redraw,
    )
    entropy_range: FloatVectorProperty(
        name="Entropy",
        description="Entropy of the dark and of the bright end [nats]",
        size=2,
        default=(16.7, -11.0),
        precision=1,
        update=redraw,
    )
    coverage_range: FloatVectorProperty(
        name="Coverage",
        description="Coverage of the dark and of the bright end, 0 to 1",
        size=2,
        default=(0.0, 1.0),
        min=0.0,
        max=1.0,
        precision=2,
        update=redraw,
    )
    ground_difference: BoolProperty(
        name="Difference",
        description="Show where it is better (blue) and where worse (orange) than what Live is "
        "compared with: before the last move, pinned sensors, or a variant",
        update=redraw,
    )

    show_axles: BoolProperty(
        name="Axles",
        description="Show the axles, where they are known, and the rear one's axes on the ground: "
        "the origin of other programs",
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
    show_place: BoolProperty(
        name="Queried Location",
        description="Mark the place that was asked about",
        default=True,
        update=redraw,
    )

    show_focus: BoolProperty(
        name="Focus",
        description="Outline the regions that count more or less than the prior says",
        default=True,
        update=redraw,
    )
    show_mounts: BoolProperty(
        name="Mounts",
        description="Tint the surfaces that sensors may sit on; no-go areas and bounds are boxes",
        default=True,
        update=redraw,
    )
    show_blind: BoolProperty(
        name="Blind Ground",
        description="Outline the ground round the vehicle that no sensor sees, and say how far it "
        "goes to each side",
        default=True,
        update=redraw,
    )
    blind_height: EnumProperty(
        items=TALL,
        name="Height",
        description="How tall it is, standing on the ground, that nobody sees any of",
        default="H50",
        update=redraw,
    )

    show_reach: BoolProperty(
        name="Reach",
        description="Draw how far away objects of a class are still found: average precision of "
        "at least 0.5",
        default=False,
        update=redraw,
    )
    reach_class: StringProperty(
        name="Class",
        description="What is to be found",
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
        description="Whose reach is drawn",
        update=redraw,
    )

    show_frustums: BoolProperty(
        name="Camera Views",
        description="Draw what cameras look at: their frustum, true to lens and pitch",
        default=True,
        update=redraw,
    )
    footprints: BoolProperty(
        name="On the Ground",
        description="Draw the ground that a camera looks at, as far as the range or the horizon",
        default=True,
        update=redraw,
    )
    view_range: FloatProperty(
        name="Range",
        description="How far on the ground a camera's view is drawn",
        default=12.0,
        min=0.5,
        soft_max=100.0,
        subtype="DISTANCE",
        unit="LENGTH",
        update=redraw,
    )

    show_beams: BoolProperty(
        name="Beams",
        description="Draw a fair sample of LiDAR beams: as many of a hundred end on the vehicle as "
        "of all",
        default=True,
        update=redraw,
    )
    beams_of: EnumProperty(
        items=(
            ("SELECTED", "Selected", "Beams of selected sensors"),
            ("ALL", "All", "Beams of all sensors"),
        ),
        name="Of",
        description="Whose beams are drawn",
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
        description="Of which channels beams are drawn",
        update=redraw,
    )
    channel: IntProperty(
        name="Channel", description="Counted from the lowest, 1", default=1, min=1, update=redraw
    )
    every: IntProperty(
        name="Every", description="2: every second channel", default=4, min=1, update=redraw
    )
    beam_colors: EnumProperty(
        items=COLORS,
        name="Color By",
        description="What the colours of beams tell",
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
        name="Blocked Beams",
        description="Colour the vehicle where it stops beams, by how many end there",
        default=False,
        update=redraw,
    )
    show_labels: BoolProperty(
        name="Names",
        description="Write the names of sensors beside them",
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
        description="Say in the lower right corner what the colours mean",
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
        description="A score follows while a sensor is moved: a draft at once, exact when it "
        "rests, on a sample of voxels. Score gives that of all voxels",
        update=switched,
    )
    against: IntProperty(
        name="Compared With",
        description="What the live score is compared with: 0, the sensors before the last move; "
        "-1, those that were pinned; else the key of a variant",
        default=BEFORE_MOVE,
        min=PINNED,
        update=switched,
    )
    figures: BoolProperty(
        name="Blind Ground, Reach, AP",
        description="Tell also how much ground is blind, how far ahead a class is found, and with "
        "which AP, once things rest: for the height and the class that the 3D view shows",
        default=True,
        update=switched,
    )
    anchor: EnumProperty(
        items=ANCHORS,
        name="Beside",
        description="A known rig, stretched onto this vehicle and scored under the same prior, to "
        "have something to go by. It is scored once, in the background",
        default=NO_ANCHOR,
        update=switched,
    )

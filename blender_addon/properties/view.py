"""Settings of the overlay in the 3D view: a switch for each layer, and display options.

Older settings stay on the scene, where scripts and older files have them: `show_overlay`,
`beam_limit` and `beam_length`.
"""

from __future__ import annotations

import zlib
from functools import partial

from bpy.types import Context, PropertyGroup

from ..choices import BEFORE_MOVE, NO_ANCHOR, PINNED
from ..engine import catalog, pe
from . import fields
from .callbacks import redraw, switched

menu, number, numbers = (
    partial(kind, update=redraw) for kind in (fields.menu, fields.number, fields.numbers)
)
switch, text, whole = (
    partial(kind, update=redraw) for kind in (fields.switch, fields.text, fields.whole)
)
"""What is changed here draws 3D views again."""
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


def classes_of(_view: PropertyGroup, context: Context, _typed: str) -> list[str]:
    """Return the classes of the scene's prior; for boxes from a file, those of the road."""
    highway = context.scene.perception_entropy.prior == "highway"
    return list((pe.Prior.highway() if highway else pe.Prior.road()).class_names)


class PE_ViewSettings(PropertyGroup):
    """Settings of what the 3D view draws."""

    show_ground: switch("Ground Map", "Colour the ground by how well sensors see it", True)
    ground_quantity: menu(
        "Show",
        "Quantity that the colours of the ground show",
        (
            ("SENSORS", "Sensors", "Number of sensors that see a location: none, 1, 2, 3 or more"),
            ("COVERAGE", "Coverage", "Share of a location that is visible to a sensor"),
            ("ENTROPY", "Entropy", "Uncertainty of a detector in nats; lower is better"),
            ("REDUNDANCY", "Redundancy", "What is left when any one sensor is lost, or kinds"),
        ),
        default="ENTROPY",
    )
    redundancy_of: menu(
        "Redundancy",
        "What the redundancy map shows",
        (
            ("SENSORS_LEFT", "Sensors Left", "The fewest sensors when any one is lost"),
            ("KINDS", "Kinds", "How many kinds of sensors see the test body"),
            ("KINDS_LEFT", "Kinds Left", "The fewest kinds when any one sensor is lost"),
        ),
    )
    redundancy_height: number(
        "Body Height",
        "Height of the test body: a cylinder 0.3 m wide that stands alone",
        0.8,
        min=0.01,
        max=5.0,
        unit="LENGTH",
    )
    ground_height: menu("Height", "Height above the ground that is evaluated", (AVERAGED, *HEIGHTS))
    ground_opacity: number(
        "Opacity", "Opacity of the map's colours", 0.35, min=0.05, max=1.0, subtype="FACTOR"
    )

    ground_range: menu(
        "Range",
        "Range of values of the ground map's colours; the bright end is good",
        (
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
    )
    ground_fits: whole(
        "Fits", "How often the range of the colours was fitted again", options={"HIDDEN"}
    )
    entropy_range: numbers(
        "Entropy",
        "Entropy at the dark and at the bright end [nats]",
        2,
        default=(16.7, -11.0),
        precision=1,
    )
    coverage_range: numbers(
        "Coverage",
        "Coverage at the dark and at the bright end, 0 to 1",
        2,
        default=(0.0, 1.0),
        min=0.0,
        max=1.0,
        precision=2,
    )
    ground_difference: switch(
        "Difference",
        "Show where the rig is better (blue) or worse (orange) than the rig that Live "
        "is compared with: before the last move, pinned sensors, or a variant",
    )

    show_axles: switch(
        "Axles",
        "Show the axles, if they are known, and the axes on the ground under the rear "
        "axle: the origin of other programs",
        True,
    )
    show_front: switch(
        "Front",
        "Show with an arrow where the front of the vehicle is, until there is a sensor",
        True,
    )
    show_ghosts: switch(
        "Other Variant", "Show the variant whose ghost is switched on in the list of variants", True
    )
    ghost_key: whole("Ghost", "Key of the variant that is shown; 0: none")
    show_requirements: switch(
        "Requirements",
        "Draw the zones of requirements: filled where they are met, hatched where they are not",
        True,
    )
    show_place: switch("Queried Location", "Mark the queried location", True)

    show_focus: switch(
        "Focus", "Outline the regions with a higher or lower weight than in the prior", True
    )
    show_mounts: switch(
        "Mounts", "Tint the surfaces of mounts; no-go areas and bounds are boxes", True
    )
    show_blind: switch(
        "Blind Ground",
        "Outline the ground round the vehicle that no sensor sees, with its extent on each side",
        True,
    )
    blind_height: menu(
        "Height",
        "Height of an object on the ground; ground where it is invisible is blind",
        TALL,
        default="H50",
    )

    show_reach: switch(
        "Reach",
        "Draw the distance up to which objects of a class are found: average precision "
        "of at least 0.5",
        False,
    )
    reach_class: text(
        "Class", "Class of the objects", DEFAULT_CLASS, search=classes_of, search_options=set()
    )
    reach_of: menu(
        "Of",
        "Sensors whose reach is drawn",
        (
            ("RIG", "Rig", "All sensors together"),
            ("SELECTED", "Selected", "All together, and each selected sensor alone"),
            ("ALL", "All", "All together, and each sensor alone"),
        ),
    )

    show_frustums: switch(
        "Camera Views", "Draw the cameras' fields of view, true to lens and pitch", True
    )
    footprints: switch(
        "On the Ground",
        "Draw the ground in a camera's field of view, up to the range or the horizon",
        True,
    )
    view_range: number(
        "Range",
        "Drawn length of a camera's view on the ground",
        12.0,
        min=0.5,
        soft_max=100.0,
        subtype="DISTANCE",
        unit="LENGTH",
    )

    show_beams: switch(
        "Beams",
        "Draw a sample of LiDAR beams, with the true share of beams that end on the vehicle",
        True,
    )
    beams_of: menu(
        "Of",
        "Sensors whose beams are drawn",
        (
            ("SELECTED", "Selected", "Beams of selected sensors"),
            ("ALL", "All", "Beams of all sensors"),
        ),
    )
    channels: menu(
        "Channels",
        "Channels whose beams are drawn",
        (
            ("FEW", "Few", "A few channels from the highest to the lowest"),
            ("ONE", "One", "A single channel"),
            ("EVERY", "Every nth", "Every nth channel"),
            ("ALL", "All", "All channels"),
        ),
    )
    channel: whole("Channel", "Number of the channel; the lowest is 1", 1, min=1)
    every: whole("Every", "2: every second channel", 4, min=1)
    beam_colors: menu(
        "Color By", "Quantity that the colours of beams show", COLORS, default="SENSOR"
    )
    rings: switch("On the Ground", "Draw the rings in which channels meet the ground", True)

    show_heat: switch(
        "Occluded Beams", "Colour the vehicle where it occludes beams, by their number", False
    )
    show_labels: switch("Names", "Write each sensor's name beside it", True)
    show_inset: switch(
        "Picture in View", "Show what the selected sensor sees in a corner of the 3D view"
    )
    show_legend: switch("Legend", "Explain the colours in the lower right corner", True)


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


class PE_LiveSettings(PropertyGroup):
    """The live score of a scene."""

    on: switch(
        "Live",
        "Update a score while a sensor moves: a preview at once, an exact score when "
        "the scene is idle, on a sample of voxels. Score evaluates all voxels",
        update=switched,
    )
    against: whole(
        "Compared With",
        "Reference of the live score: 0, the sensors before the last move; -1, the "
        "pinned sensors; otherwise the key of a variant",
        BEFORE_MOVE,
        min=PINNED,
        update=switched,
    )
    figures: switch(
        "Blind Ground, Reach, AP",
        "Add blind ground, reach ahead and AP when the scene is idle, for the height "
        "and the class that the 3D view shows",
        True,
        update=switched,
    )
    anchor: menu(
        "Known Rig",
        "A known rig, scaled to this vehicle and scored under the same prior, for "
        "comparison. It is scored once, in the background",
        ANCHORS,
        default=NO_ANCHOR,
        update=switched,
    )

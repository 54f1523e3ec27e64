"""Settings of the 3D view and of the live score, each declared once.

A layer's settings stand below its switch, `show_` and its name. See `pe_core.base.setting`.
"""

from dataclasses import dataclass
from typing import Any

from ..choices import BEFORE_MOVE
from ..engine import studies

DEFAULT_CLASS = "pedestrian"
AVERAGE = "AVERAGE"
FITTED = "FITTED"
WHOLE = "WHOLE"
"""The range of values that the colours of the ground map cover."""
SELECTED = "SELECTED"
ALL = "ALL"
RIG = "RIG"
BY_STATE = "STATE"
BY_SENSOR = "SENSOR"
BY_CHANNEL = "CHANNEL"
HEIGHTS_M = {AVERAGE: None, "H0": 0.0, "H50": 0.5, "H100": 1.0, "H150": 1.5}
MIN_LENGTH_M = 0.1

OPACITY = studies.Number(0.05, 1.0)
SHARE = studies.Number(0.0, 1.0)
METRES = studies.Number(0.5, unit="m")
LENGTH = studies.Number(MIN_LENGTH_M, unit="m")
COUNT = studies.Whole(1)
KEY = studies.Whole(0)


def _switch(default: bool, label: str, text: str) -> bool:
    return studies.setting(default, studies.Toggle(), text, studies.Panel("", label))


def _value(default: Any, rule: Any, label: str, text: str, **panel: Any) -> Any:
    return studies.setting(default, rule, text, studies.Panel("", label, **panel))


def _menu(
    default: str, label: str, text: str, items: tuple[tuple[str, str, str], ...], when: str = ""
) -> str:
    """Return a setting of one of several texts, each with its label and its meaning."""
    panel = studies.Panel("", label, menu=tuple(item[1:] for item in items), when=when)
    return studies.setting(default, studies.OneOf(tuple(item[0] for item in items)), text, panel)


@dataclass(frozen=True, slots=True)
class ViewSettings:
    """What the 3D view draws; `layers` are the names of those that are switched on."""

    show_ground: bool = _switch(True, "Ground Map", "Colour the ground by how well sensors see it")
    ground_quantity: str = _menu(
        "ENTROPY",
        "Show",
        "Quantity that the colours of the ground show",
        items=(
            ("SENSORS", "Sensors", "Number of sensors that see a location: none, 1, 2, 3 or more"),
            ("COVERAGE", "Coverage", "Share of a location that is visible to a sensor"),
            ("ENTROPY", "Entropy", "Uncertainty of a detector in nats; lower is better"),
        ),
    )
    ground_height: str = _menu(
        AVERAGE,
        "Height",
        "Height above the ground that is evaluated",
        items=(
            (AVERAGE, "Average", "All heights, by how likely an object is there: as scored"),
            ("H0", "Ground", "The voxels that stand on the ground"),
            ("H50", "0.5 m", "As high as a bumper or a cone"),
            ("H100", "1 m", "As high as a bonnet"),
            ("H150", "1.5 m", "As high as heads and roofs"),
        ),
    )
    ground_opacity: float = _value(0.35, OPACITY, "Opacity", "Opacity of the map's colours")
    ground_range: str = _menu(
        FITTED,
        "Range",
        "Range of values of the ground map's colours; the bright end is good",
        items=(
            (
                FITTED,
                "Fitted",
                "Colours are spread over what this scene shows: all but the lowest and the highest "
                "2 % of its places. Kept from the first score on, until it is fitted again",
            ),
            (
                WHOLE,
                "Whole",
                "From what nobody sees to what is seen best: the same colours in every scene, and "
                "on review pages",
            ),
        ),
    )
    ground_fits: int = _value(0, KEY, "Fits", "How often the range of the colours was fitted again")
    ground_difference: bool = _switch(
        False,
        "Difference",
        "Show where the rig is better (blue) or worse (orange) than the rig that Live is compared "
        "with: before the last move, or a variant",
    )
    show_blind: bool = _switch(
        True,
        "Blind Ground",
        "Outline the ground round the vehicle that no sensor sees, with its extent on each side",
    )
    blind_height: str = _menu(
        "H50",
        "Height",
        "Height of an object on the ground; ground where it is invisible is blind",
        items=(
            (
                "H0",
                "Flat",
                "What lies flat on the ground: the gaps between a LiDAR's rings are blind",
            ),
            ("H50", "0.5 m", "A cone, a crouching child, a low wall"),
            ("H100", "1 m", "A child"),
            ("H150", "1.5 m", "A car, a grown person"),
        ),
    )
    show_reach: bool = _switch(
        False,
        "Reach",
        "Draw the distance up to which objects of a class are found: average precision of at least "
        "0.5",
    )
    reach_class: str = _value(DEFAULT_CLASS, studies.Name(), "Class", "Class of the objects")
    reach_of: str = _menu(
        RIG,
        "Of",
        "Sensors whose reach is drawn",
        items=(
            (RIG, "Rig", "All sensors together"),
            (SELECTED, "Selected", "All together, and each selected sensor alone"),
            (ALL, "All", "All together, and each sensor alone"),
        ),
    )
    show_requirements: bool = _switch(
        True,
        "Requirements",
        "Draw the zones of requirements: filled where they are met, hatched where they are not",
    )
    show_scenario: bool = _switch(
        True,
        "Drive-by",
        "Show the selected scenario at the frame of the timeline: bodies, and lines from each "
        "sensor that sees one; below, AP over time",
    )
    show_mounts: bool = _switch(
        True, "Mounts", "Tint the surfaces of mounts; no-go areas and bounds are boxes"
    )
    show_focus: bool = _switch(
        True, "Focus", "Outline the regions with a higher or lower weight than in the prior"
    )
    show_frustums: bool = _switch(
        True, "Camera Views", "Draw the cameras' fields of view, true to lens and pitch"
    )
    footprints: bool = _switch(
        True,
        "On the Ground",
        "Draw the ground in a camera's field of view, up to the range or the horizon",
    )
    view_range: float = _value(
        12.0, METRES, "Range", "Drawn length of a camera's view on the ground",
        soft_max=100.0, when="footprints",
    )  # fmt: skip
    show_beams: bool = _switch(
        True,
        "Beams",
        "Draw a sample of LiDAR beams, with the true share of beams that end on the vehicle",
    )
    beams_of: str = _menu(
        SELECTED,
        "Of",
        "Sensors whose beams are drawn",
        items=(
            (SELECTED, "Selected", "Beams of selected sensors"),
            (ALL, "All", "Beams of all sensors"),
        ),
    )
    channels: str = _menu(
        "FEW",
        "Channels",
        "Channels whose beams are drawn",
        items=(
            ("FEW", "Few", "A few channels from the highest to the lowest"),
            ("ALL", "All", "All channels"),
        ),
    )
    beam_colors: str = _menu(
        BY_SENSOR,
        "Color By",
        "Quantity that the colours of beams show",
        items=(
            (BY_STATE, "Free or Occluded", "Blue beams are free, orange beams end on the vehicle"),
            (
                BY_SENSOR,
                "Sensor",
                "Each sensor has a colour of its own, as in the list; orange beams end on the "
                "vehicle",
            ),
            (BY_CHANNEL, "Channel", "From the lowest channel, dark, to the highest, bright"),
        ),
    )
    beam_length: float = _value(
        8.0, LENGTH, "Length", "Drawn length of beams that hit nothing", soft_max=200.0
    )
    beam_limit: int = _value(
        5_000, COUNT, "Maximum",
        "Maximum number of drawn beams, evenly chosen; more beams make the view slow",
        soft_max=200_000,
    )  # fmt: skip
    rings: bool = _switch(True, "On the Ground", "Draw the rings in which channels meet the ground")
    show_heat: bool = _switch(
        False, "Occluded Beams", "Colour the vehicle where it occludes beams, by their number"
    )
    show_axles: bool = _switch(
        True,
        "Axles",
        "Show the axles, if they are known, and the axes on the ground under the rear axle: the "
        "origin of other programs",
    )
    show_front: bool = _switch(
        True,
        "Front",
        "Show with an arrow where the front of the vehicle is, until there is a sensor",
    )
    show_ghosts: bool = _switch(
        True, "Other Variant", "Show the variant whose ghost is switched on in the list of variants"
    )
    ghost_key: int = _value(0, KEY, "Ghost", "Key of the variant that is shown; 0: none")
    wipe: bool = _switch(
        False,
        "Wipe",
        "Show ground map, blind ground and reach of the other variant left of a line in the view, "
        "and those of the present sensors right of it",
    )
    wipe_at: float = _value(
        0.5, SHARE, "At", "Where the line is, as a share of the view's width", when="wipe"
    )
    show_place: bool = _switch(True, "Queried Location", "Mark the queried location")
    show_where: bool = _switch(
        True, "Where?", "Colour the body by the figure that the rig has with one more sensor there"
    )
    show_region: bool = _switch(
        True, "Free Region", "Tint the part of its mount on which the sensor may go"
    )
    region_loss: float = _value(
        0.0, studies.Number(0.0), "Loss",
        "How much the figure may lose, in its unit: the region follows at once; 0: as asked",
        precision=3, step=0.1,
    )  # fmt: skip
    show_steepest: bool = _switch(
        False,
        "Best Way",
        "Show in which direction the selected sensor gains most, along its mount and turned, and "
        "the best place within 20 cm: M moves it there. Nothing is shown that might be noise",
    )
    show_labels: bool = _switch(True, "Names", "Write each sensor's name beside it")
    show_bodies: bool = _switch(
        True, "Test Bodies", "Write beside each test body which sensors see it, and with how much"
    )
    show_cameras: bool = _switch(
        False,
        "Camera Strip",
        "Show what every camera sees along the lower edge of the 3D view; a click on a picture "
        "looks through that camera",
    )
    show_birds_eye: bool = _switch(
        False,
        "Bird's-Eye View",
        "Show the ground round the vehicle from above, stitched from the pictures of all cameras; "
        "ground that no camera sees is hatched",
    )
    birds_eye_within: float = _value(
        10.0, studies.Number(1.0, 30.0, unit="m"), "Distance",
        "How far from the vehicle's body the ground is shown",
    )  # fmt: skip
    show_legend: bool = _switch(True, "Legend", "Explain the colours in the lower right corner")
    layers: frozenset[str] = frozenset()

    @property
    def ground_height_m(self) -> float | None:
        """Height of the ground map [m]; None: the average of all heights."""
        return HEIGHTS_M[self.ground_height]

    @property
    def blind_height_m(self) -> float:
        """Height of an object on blind ground [m]."""
        return HEIGHTS_M[self.blind_height] or 0.0


@dataclass(frozen=True, slots=True)
class LiveSettings:
    """The live score of a scene."""

    on: bool = _switch(
        False,
        "Live",
        "Update a score, on a sample of voxels, while a sensor moves. Score evaluates all voxels",
    )
    against: int = _value(
        BEFORE_MOVE, studies.Whole(0), "Compared With",
        "Reference of the live score: 0, the sensors before the last move; otherwise the "
        "key of a variant",
    )  # fmt: skip
    figures: bool = _switch(
        True,
        "Blind Ground, Reach, AP",
        "Add blind ground, reach ahead and AP when the scene is idle, for the height and the class "
        "that the 3D view shows",
    )

"""What a rig sees, place by place: the ground map, blind ground round the vehicle, reach."""

from .blind import BlindGround, BlindSpot, shown_end, shown_start
from .ground import GroundSight
from .outline import outlines
from .reach import Reach
from .reach_line import ReachLine, ends_with_space, reach_line
from .shares import SeenShares
from .sight import Sight, expected_ap

__all__ = [
    "BlindGround",
    "BlindSpot",
    "GroundSight",
    "Reach",
    "ReachLine",
    "SeenShares",
    "Sight",
    "ends_with_space",
    "expected_ap",
    "outlines",
    "reach_line",
    "shown_end",
    "shown_start",
]

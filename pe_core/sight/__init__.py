"""What a rig sees, place by place: the ground map, blind ground round the vehicle, reach."""

from .blind import BlindGround, BlindSpot, shown_end, shown_start
from .ground import GroundSight
from .outline import outlines
from .reach import Reach
from .shares import SeenShares
from .sight import Sight, expected_ap

__all__ = [
    "BlindGround",
    "BlindSpot",
    "GroundSight",
    "Reach",
    "SeenShares",
    "Sight",
    "expected_ap",
    "outlines",
    "shown_end",
    "shown_start",
]

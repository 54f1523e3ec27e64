"""Searches for better placements."""

from .areas import MountArea
from .axes import AXES, POSITION_AXES, pose_from_values, pose_values
from .coding import Candidate, Coding
from .feasible import first_allowed
from .mounts import AnyMount, Constraints, Mounting, NoGo, Slot, SlotMount, SurfaceMount
from .optimize import Step, optimize
from .schedule import Schedule
from .search_space import PAPER_FREE, SearchSpace, checked_axes, checked_bounds

__all__ = [
    "AXES",
    "PAPER_FREE",
    "POSITION_AXES",
    "AnyMount",
    "Candidate",
    "Coding",
    "Constraints",
    "MountArea",
    "Mounting",
    "NoGo",
    "Schedule",
    "SearchSpace",
    "Slot",
    "SlotMount",
    "Step",
    "SurfaceMount",
    "checked_axes",
    "checked_bounds",
    "first_allowed",
    "optimize",
    "pose_from_values",
    "pose_values",
]

"""Searches for better placements."""

from .axes import AXES, POSITION_AXES, pose_from_values, pose_values
from .coding import Candidate, Coding
from .feasible import first_allowed
from .mounts import Constraints, Mount, Mounting, NoGo, Slot, Slots, Surface
from .optimize import Step, optimize
from .schedule import Schedule
from .search_space import PAPER_FREE, SearchSpace, checked_axes, checked_bounds

__all__ = [
    "AXES",
    "PAPER_FREE",
    "POSITION_AXES",
    "Candidate",
    "Coding",
    "Constraints",
    "Mount",
    "Mounting",
    "NoGo",
    "Schedule",
    "SearchSpace",
    "Slot",
    "Slots",
    "Step",
    "Surface",
    "checked_axes",
    "checked_bounds",
    "first_allowed",
    "optimize",
    "pose_from_values",
    "pose_values",
]

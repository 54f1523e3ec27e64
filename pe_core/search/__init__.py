"""Searches for better placements."""

from .areas import MountArea
from .axes import AXES, POSITION_AXES, pose_from_values, pose_values
from .batch import judge_all
from .coding import Candidate, Coding
from .feasible import first_allowed
from .methods import DEFAULT_METHOD, METHODS, Method, checked_method
from .mounts import AnyMount, Constraints, Mounting, NoGo, Slot, SlotMount, SurfaceMount
from .objective import Judgement, Objective
from .optimize import Step, optimize
from .processes import Processes, live_as_long_as_the_parent, started
from .schedule import Schedule
from .search_space import PAPER_FREE, SearchSpace, checked_axes, checked_bounds

__all__ = [
    "AXES",
    "DEFAULT_METHOD",
    "METHODS",
    "PAPER_FREE",
    "POSITION_AXES",
    "AnyMount",
    "Candidate",
    "Coding",
    "Constraints",
    "Judgement",
    "Method",
    "MountArea",
    "Mounting",
    "NoGo",
    "Objective",
    "Processes",
    "Schedule",
    "SearchSpace",
    "Slot",
    "SlotMount",
    "Step",
    "SurfaceMount",
    "checked_axes",
    "checked_bounds",
    "checked_method",
    "first_allowed",
    "judge_all",
    "live_as_long_as_the_parent",
    "optimize",
    "pose_from_values",
    "pose_values",
    "started",
]

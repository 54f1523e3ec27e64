"""Searches for better placements."""

from .areas import MountArea
from .axes import AXES, POSITION_AXES, pose_from_values, pose_values
from .batch import judge_all
from .coding import Candidate, Coding
from .feasible import first_allowed
from .journal import Journal, JudgedRig
from .methods import DEFAULT_METHOD, METHODS, Method, checked_method
from .mounts import AnyMount, Constraints, Mounting, NoGo, Slot, SlotMount, SurfaceMount
from .objective import Judgement, Objective
from .optimize import Step, optimize
from .processes import Processes, live_as_long_as_the_parent, started
from .robust import RobustObjective, objective_of
from .schedule import Schedule
from .search_space import (
    PAPER_FREE,
    SearchSpace,
    checked_axes,
    checked_bounds,
    default_bounds,
)
from .seating import seated
from .tolerance import Tolerance

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
    "Journal",
    "JudgedRig",
    "Judgement",
    "Method",
    "MountArea",
    "Mounting",
    "NoGo",
    "Objective",
    "Processes",
    "RobustObjective",
    "Schedule",
    "SearchSpace",
    "Slot",
    "SlotMount",
    "Step",
    "SurfaceMount",
    "Tolerance",
    "checked_axes",
    "checked_bounds",
    "checked_method",
    "default_bounds",
    "first_allowed",
    "judge_all",
    "live_as_long_as_the_parent",
    "objective_of",
    "optimize",
    "pose_from_values",
    "pose_values",
    "seated",
    "started",
]

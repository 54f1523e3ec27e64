"""Searches for better placements."""

from .areas import MountArea
from .axes import AXES, POSITION_AXES, pose_from_values, pose_values
from .batch import judge_all
from .coding import Candidate, Coding
from .designs import DesignSpace, Picks
from .domains import seat_of
from .feasible import first_allowed
from .journal import Journal, JudgedRig
from .methods import DEFAULT_METHOD, METHODS, SCHEDULED_METHOD, Method, checked_method
from .mounts import AnyMount, Constraints, Mounting, NoGo, Slot, SlotMount, SurfaceMount
from .objective import Judgement, Objective
from .optimize import Step, optimize
from .pareto import DesignSearch, above_front, pareto_front
from .processes import Processes, live_as_long_as_the_parent, started
from .robust import RobustObjective, objective_of
from .robustness import Robustness, Stands, robustness
from .schedule import Schedule
from .search_space import (
    PAPER_FREE,
    SearchSpace,
    checked_axes,
    checked_bounds,
    default_bounds,
)
from .seating import seated
from .selection import Choice, Option, Selection
from .sites import Site
from .ties import mirrored
from .tolerance import Tolerance, mounted_off

__all__ = [
    "AXES",
    "DEFAULT_METHOD",
    "METHODS",
    "PAPER_FREE",
    "POSITION_AXES",
    "SCHEDULED_METHOD",
    "AnyMount",
    "Candidate",
    "Choice",
    "Coding",
    "Constraints",
    "DesignSearch",
    "DesignSpace",
    "Journal",
    "JudgedRig",
    "Judgement",
    "Method",
    "MountArea",
    "Mounting",
    "NoGo",
    "Objective",
    "Option",
    "Picks",
    "Processes",
    "RobustObjective",
    "Robustness",
    "Schedule",
    "SearchSpace",
    "Selection",
    "Site",
    "Slot",
    "SlotMount",
    "Stands",
    "Step",
    "SurfaceMount",
    "Tolerance",
    "above_front",
    "checked_axes",
    "checked_bounds",
    "checked_method",
    "default_bounds",
    "first_allowed",
    "judge_all",
    "live_as_long_as_the_parent",
    "mirrored",
    "mounted_off",
    "objective_of",
    "optimize",
    "pareto_front",
    "pose_from_values",
    "pose_values",
    "robustness",
    "seat_of",
    "seated",
    "started",
]

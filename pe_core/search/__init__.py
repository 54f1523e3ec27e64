"""Searches for better placements."""

from .optimize import Step, optimize
from .schedule import Schedule
from .search_space import AXES, PAPER_FREE, SearchSpace, pose_from_values, pose_values

__all__ = [
    "AXES",
    "PAPER_FREE",
    "Schedule",
    "SearchSpace",
    "Step",
    "optimize",
    "pose_from_values",
    "pose_values",
]

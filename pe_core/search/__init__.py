"""Searches for better placements."""

from ..scoring.protocol import Evaluation, Objective
from .design_space import DesignSearch, DesignSpace, Picks, above_front, pareto_front
from .design_variable import AXES, POSITION_AXES, pose_from_values, pose_values
from .dispatch import evaluate_all, shared_parts
from .domains import snap_to_mount, standoff_point
from .goals import Front, Goals, Start, Stop
from .journal import EvaluatedRig, Journal
from .linkage import mirrored
from .methods import (
    DEFAULT_METHOD,
    METHODS,
    PARTS,
    SCHEDULED_METHOD,
    Method,
    checked_method,
    method_named,
)
from .mounts import AnyMount, Constraints, MountArea, Mounting, NoGo, Slot, SlotMount, SurfaceMount
from .optimize import Step, optimize
from .parametrization import Candidate, Parametrization, feasible_start
from .payload import Payload, Unreadable, send_payload
from .processes import LazyProcesses, Processes, no_processes, start_processes
from .robustness import RigRobustness, Robustness, RobustObjective, objective_of, robustness
from .search_space import (
    PAPER_FREE,
    Schedule,
    SearchSpace,
    checked_axes,
    checked_bounds,
    default_bounds,
)
from .selection import Choice, Option, Selection
from .tolerance import Tolerance, mounted_off
from .worker_pool import Call, WorkerDied, run_tasks

__all__ = [
    "AXES",
    "DEFAULT_METHOD",
    "METHODS",
    "PAPER_FREE",
    "PARTS",
    "POSITION_AXES",
    "SCHEDULED_METHOD",
    "AnyMount",
    "Call",
    "Candidate",
    "Choice",
    "Constraints",
    "DesignSearch",
    "DesignSpace",
    "EvaluatedRig",
    "Evaluation",
    "Front",
    "Goals",
    "Journal",
    "LazyProcesses",
    "Method",
    "MountArea",
    "Mounting",
    "NoGo",
    "Objective",
    "Option",
    "Parametrization",
    "Payload",
    "Picks",
    "Processes",
    "RigRobustness",
    "RobustObjective",
    "Robustness",
    "Schedule",
    "SearchSpace",
    "Selection",
    "Slot",
    "SlotMount",
    "Start",
    "Step",
    "Stop",
    "SurfaceMount",
    "Tolerance",
    "Unreadable",
    "WorkerDied",
    "above_front",
    "checked_axes",
    "checked_bounds",
    "checked_method",
    "default_bounds",
    "evaluate_all",
    "feasible_start",
    "method_named",
    "mirrored",
    "mounted_off",
    "no_processes",
    "objective_of",
    "optimize",
    "pareto_front",
    "pose_from_values",
    "pose_values",
    "robustness",
    "run_tasks",
    "send_payload",
    "shared_parts",
    "snap_to_mount",
    "standoff_point",
    "start_processes",
]

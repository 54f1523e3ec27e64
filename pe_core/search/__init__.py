"""Searches for better placements."""

from ..scoring.score import Evaluation, Objective
from .ask_tell import SearchRun
from .dispatch import Call, WorkerDied, evaluate_all, run_tasks, shared_parts
from .domains import (
    AXES,
    POSITION_AXES,
    pose_from_values,
    pose_values,
    snap_to_mount,
    standoff_point,
)
from .goals import Front, Goals, Start, Stop
from .journal import EvaluatedRig, Journal
from .methods import DEFAULT_METHOD, METHODS, SCHEDULED_METHOD, Method, checked_method
from .mounts import AnyMount, Constraints, MountArea, Mounting, NoGo, Slot, SlotMount, SurfaceMount
from .optimize import Step, optimize
from .parametrization import Candidate, Parametrization, feasible_start, mirrored
from .payload import Payload, Unreadable, send_payload
from .places import MountingPlaces, SurfacePlace, outward_yaw
from .processes import LazyProcesses, Processes, no_processes, start_processes
from .search_space import (
    PAPER_FREE,
    Schedule,
    SearchSpace,
    checked_axes,
    checked_bounds,
    default_bounds,
)
from .selection import (
    Choice,
    DesignSearch,
    DesignSpace,
    Option,
    Picks,
    Selection,
    above_front,
    pareto_front,
)
from .tolerance import (
    RigRobustness,
    Robustness,
    RobustObjective,
    Tolerance,
    mounted_off,
    objective_of,
    robustness,
)

__all__ = ["AXES", "DEFAULT_METHOD", "METHODS", "PAPER_FREE", "POSITION_AXES", "SCHEDULED_METHOD"]
__all__ += ["AnyMount", "Call", "Candidate", "Choice", "Constraints", "DesignSearch"]
__all__ += ["DesignSpace", "EvaluatedRig", "Evaluation", "Front", "Goals", "Journal"]
__all__ += ["LazyProcesses", "Method", "MountArea", "Mounting", "MountingPlaces", "NoGo"]
__all__ += ["Objective", "Option", "Parametrization", "Payload", "Picks", "Processes"]
__all__ += ["RigRobustness", "RobustObjective", "Robustness", "Schedule", "SearchRun"]
__all__ += ["SearchSpace", "Selection", "Slot", "SlotMount", "Start", "Step", "Stop"]
__all__ += ["SurfaceMount", "SurfacePlace", "Tolerance", "Unreadable", "WorkerDied"]
__all__ += ["above_front", "checked_axes", "checked_bounds", "checked_method", "default_bounds"]
__all__ += ["evaluate_all", "feasible_start", "mirrored", "mounted_off", "outward_yaw"]
__all__ += ["no_processes", "objective_of", "optimize", "pareto_front"]
__all__ += ["pose_from_values", "pose_values", "robustness", "run_tasks", "send_payload"]
__all__ += ["shared_parts", "snap_to_mount", "standoff_point", "start_processes"]

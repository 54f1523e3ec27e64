"""Searches for better placements."""

from ..scoring.score import Objective
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
from .key_figures import KEPT, KEY_FIGURES, FigureOfMerit, KeyFigures, Reading, Wanted, dashboard
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

__all__ = ["AXES", "DEFAULT_METHOD", "KEPT", "KEY_FIGURES", "METHODS", "PAPER_FREE"]
__all__ += ["POSITION_AXES", "SCHEDULED_METHOD", "AnyMount", "Call", "Candidate", "Choice"]
__all__ += ["Constraints", "DesignSearch", "DesignSpace", "EvaluatedRig"]
__all__ += ["FigureOfMerit", "Front", "Goals", "Journal", "KeyFigures", "LazyProcesses", "Method"]
__all__ += ["MountArea", "Mounting", "MountingPlaces", "NoGo", "Objective", "Option"]
__all__ += ["Parametrization", "Payload", "Picks", "Processes", "Reading", "RigRobustness"]
__all__ += ["RobustObjective", "Robustness", "Schedule", "SearchRun", "SearchSpace", "Selection"]
__all__ += ["Slot", "SlotMount", "Start", "Step", "Stop", "SurfaceMount", "SurfacePlace"]
__all__ += ["Tolerance", "Unreadable", "Wanted", "WorkerDied", "above_front", "checked_axes"]
__all__ += ["checked_bounds", "checked_method", "dashboard", "default_bounds", "evaluate_all"]
__all__ += ["feasible_start", "mirrored", "mounted_off", "no_processes", "objective_of"]
__all__ += ["optimize", "outward_yaw", "pareto_front", "pose_from_values", "pose_values"]
__all__ += ["robustness", "run_tasks", "send_payload", "shared_parts", "snap_to_mount"]
__all__ += ["standoff_point", "start_processes"]

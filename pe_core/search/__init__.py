"""Searches for better placements."""

from ..lazy_faces import lazy_face

with lazy_face(__name__):
    from .ask_tell import SearchRun
    from .build_figures import BUILD_FIGURES
    from .dispatch import Call, WorkerDied, evaluate_all, run_tasks
    from .domains import (
        AXES,
        POSITION_AXES,
        POSITION_DECIMALS,
        ROUNDING_M,
        MountSurface,
        pose_from_values,
        pose_values,
        snap_to_mount,
        standoff_point,
    )
    from .figure import HIGHER, LOWER, NO_FIGURE, Figure
    from .figures import AP_RINGS, ENTROPY, FIGURES, KEPT, ON_FRONT, REQUIREMENTS, SHOWN, figure_of
    from .goals import Front, Goals, Start, Stop
    from .journal import EvaluatedRig, Journal, checked_entries
    from .key_figures import KeyFigures, Reading, ReadingRow, dashboard, shown_figures
    from .limit import Limit, LimitRule
    from .limits import LIMITED, NUMBERED, Limits
    from .methods import DEFAULT_METHOD, METHODS, SCHEDULED_METHOD, Method, checked_method
    from .methods.portfolio import default_budget
    from .mounting_grid import GridWalk, MountingGrid, OnGrid
    from .mounts import (
        AnyMount,
        Constraints,
        MountArea,
        Mounting,
        NoGo,
        Slot,
        SlotMount,
        SurfaceMount,
    )
    from .objective import NO_VALUE, FeasibilityRule, Leader, Objective, Value, violation_sum
    from .optimize import Step, optimize
    from .own_places import OwnPlaces, PathPoint, PlacedRig
    from .parametrization import Candidate, Parametrization, feasible_start, mirrored, rig_on_mounts
    from .payload import Payload, Unreadable, send_payload
    from .places import MountingPlaces, SurfacePlace, outward_yaw
    from .processes import LazyProcesses, Processes, no_processes, start_processes
    from .race import as_objective
    from .rig_view import RigView
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
        RobustFigure,
        Robustness,
        Tolerance,
        mounted_off,
        objective_of,
        robustness,
    )

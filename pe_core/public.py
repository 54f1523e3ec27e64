"""The names of the engine that other programs use."""

from . import catalog
from .base.errors import InputError
from .metric import ApCurve
from .prior import Boxes, BoxReport, Focus, ObjectClass, Prior
from .scene import (
    DataSheet,
    Housing,
    Motion,
    Objects,
    PerceptionSpace,
    Pose,
    Reference,
    Rig,
    Sensor,
    State,
    Vehicle,
    cuts_body,
    guessed_reference,
)
from .scene.mesh import Mesh, MeshAxes
from .scoring import (
    Evaluator,
    GroundMap,
    ObjectScore,
    PartScore,
    RigEvaluator,
    Scatter,
    Score,
    SensorScore,
    requirements,
)
from .scoring.sight import BlindGround, GroundSight, Reach, Sight
from .scoring.targets import ObjectEvaluator, TargetRule
from .search import (
    METHODS,
    Choice,
    Constraints,
    Front,
    Goals,
    Limit,
    Limits,
    Method,
    MountArea,
    Mounting,
    MountingGrid,
    NoGo,
    Objective,
    Option,
    Schedule,
    SearchRun,
    SearchSpace,
    Selection,
    Slot,
    SlotMount,
    Start,
    Step,
    Stop,
    SurfaceMount,
    Tolerance,
    Value,
    optimize,
    snap_to_mount,
)
from .sensors import (
    BeamField,
    BrownConrady,
    Camera,
    FTheta,
    KannalaBrandt,
    Lidar,
    PerceptionModel,
    Pinhole,
    Weather,
    beam_field,
    measure,
    measure_objects,
)
from .study import (
    Conditions,
    Edge,
    Search,
    Study,
    load_study,
    save_study,
    study_from_dict,
    study_to_dict,
)
from .version import __version__

__all__ = ["METHODS", "ApCurve", "BeamField", "BlindGround", "BoxReport", "Boxes", "BrownConrady"]
__all__ += ["Camera", "Choice", "Conditions", "Constraints", "DataSheet", "Edge", "Evaluator"]
__all__ += ["FTheta", "Focus", "Front", "Goals", "GroundMap", "GroundSight", "Housing"]
__all__ += ["InputError", "KannalaBrandt", "Lidar", "Limit", "Limits", "Mesh", "MeshAxes"]
__all__ += ["Method", "Motion"]
__all__ += ["MountArea", "Mounting", "MountingGrid", "NoGo", "ObjectClass", "ObjectEvaluator"]
__all__ += ["ObjectScore", "Objective", "Objects", "Option", "PartScore", "PerceptionModel"]
__all__ += ["PerceptionSpace"]
__all__ += ["Pinhole", "Pose", "Prior", "Reach", "Reference", "Rig", "RigEvaluator", "Scatter"]
__all__ += ["Schedule", "Score", "Search", "SearchRun", "SearchSpace", "Selection", "Sensor"]
__all__ += ["SensorScore", "Sight", "Slot", "SlotMount", "Start", "State", "Step", "Stop", "Study"]
__all__ += ["SurfaceMount", "TargetRule", "Tolerance", "Value", "Vehicle", "Weather"]
__all__ += ["__version__", "beam_field", "catalog", "cuts_body", "guessed_reference", "load_study"]
__all__ += ["measure", "measure_objects", "optimize", "requirements", "save_study"]
__all__ += ["snap_to_mount", "study_from_dict", "study_to_dict"]

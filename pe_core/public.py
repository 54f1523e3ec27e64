"""The names of the engine that other programs use."""

from . import advice, catalog
from .advice import Advice
from .errors import InputError
from .formats import Mesh, read_boxes, read_mesh, write_boxes, write_mesh
from .kinds import BeamField, Camera, Lidar, PerceptionModel, beam_field, measure
from .metric import ApCurve
from .prior import Boxes, BoxReport, Focus, ObjectClass, Prior
from .scene import Housing, PerceptionSpace, Pose, Rig, Sensor, Vehicle, cuts_body
from .scoring import Evaluator, Glance, GroundMap, PartScore, Score, SensorScore
from .search import Schedule, SearchSpace, Step, optimize
from .sight import BlindGround, GroundSight, Reach, Sight
from .study import (
    Job,
    OptimizeJob,
    Outcome,
    Progress,
    ScoreJob,
    Search,
    Study,
    export_study,
    load_study,
    prepare_folder,
    result_dict,
    save_study,
    study_from_dict,
    study_to_dict,
    write_outcome,
)
from .version import __version__

__all__ = [
    "Advice",
    "ApCurve",
    "BeamField",
    "BlindGround",
    "BoxReport",
    "Boxes",
    "Camera",
    "Evaluator",
    "Focus",
    "Glance",
    "GroundMap",
    "GroundSight",
    "Housing",
    "InputError",
    "Job",
    "Lidar",
    "Mesh",
    "ObjectClass",
    "OptimizeJob",
    "Outcome",
    "PartScore",
    "PerceptionModel",
    "PerceptionSpace",
    "Pose",
    "Prior",
    "Progress",
    "Reach",
    "Rig",
    "Schedule",
    "Score",
    "ScoreJob",
    "Search",
    "SearchSpace",
    "Sensor",
    "SensorScore",
    "Sight",
    "Step",
    "Study",
    "Vehicle",
    "__version__",
    "advice",
    "beam_field",
    "catalog",
    "cuts_body",
    "export_study",
    "load_study",
    "measure",
    "optimize",
    "prepare_folder",
    "read_boxes",
    "read_mesh",
    "result_dict",
    "save_study",
    "study_from_dict",
    "study_to_dict",
    "write_boxes",
    "write_mesh",
    "write_outcome",
]

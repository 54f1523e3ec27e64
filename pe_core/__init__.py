"""Perception entropy of a vehicle's LiDARs and cameras: the engine, pure NumPy.

The metric is from Ma, Liu and Li, "Perception Entropy: A Metric for Multiple Sensors Configuration
Evaluation and Design", ICRA 2021. Lower is better.
"""

from . import catalog
from .box_files import read_boxes, write_boxes
from .boxes import Boxes, BoxReport
from .entropy import ApCurve, PerceptionModel
from .errors import InputError
from .evaluate import Evaluator
from .geometry import Pose
from .jobs import Job, OptimizeJob, Outcome, Progress, ScoreJob
from .measurement import measure
from .mesh_io import Mesh, read_mesh, write_mesh
from .occlusion import BeamField, beam_field
from .optimize import Schedule, SearchSpace, Step, optimize
from .prior import Focus, ObjectClass, Prior
from .results import export_study, prepare_folder, result_dict, write_outcome
from .score import GroundMap, PartScore, Score, SensorScore
from .sensors import Camera, Lidar, Rig, Sensor
from .space import PerceptionSpace
from .study import Search, Study
from .study_file import load_study, save_study, study_from_dict, study_to_dict
from .vehicle import Vehicle
from .version import __version__

__all__ = [
    "ApCurve",
    "BeamField",
    "BoxReport",
    "Boxes",
    "Camera",
    "Evaluator",
    "Focus",
    "GroundMap",
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
    "Rig",
    "Schedule",
    "Score",
    "ScoreJob",
    "Search",
    "SearchSpace",
    "Sensor",
    "SensorScore",
    "Step",
    "Study",
    "Vehicle",
    "__version__",
    "beam_field",
    "catalog",
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

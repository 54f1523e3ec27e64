"""Scores of a rig: on all voxels, or on a sample of them."""

from .evaluator import Evaluator
from .judge import RigJudge
from .object_score import FoundClass, ObjectScore
from .sampled import Judgement
from .sampling import VoxelSample, draw
from .scatter import Scatter
from .score import Glance, GroundMap, PartScore, Score, ScoreStopped, SensorScore

__all__ = [
    "Evaluator",
    "FoundClass",
    "Glance",
    "GroundMap",
    "Judgement",
    "ObjectScore",
    "PartScore",
    "RigJudge",
    "Scatter",
    "Score",
    "ScoreStopped",
    "SensorScore",
    "VoxelSample",
    "draw",
]

"""Scores of a rig: on all voxels, or on a sample of them."""

from .evaluator import Evaluator
from .sampled import Judgement
from .sampling import VoxelSample, draw
from .score import Glance, GroundMap, PartScore, Score, ScoreStopped, SensorScore

__all__ = [
    "Evaluator",
    "Glance",
    "GroundMap",
    "Judgement",
    "PartScore",
    "Score",
    "ScoreStopped",
    "SensorScore",
    "VoxelSample",
    "draw",
]

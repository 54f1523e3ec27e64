"""Scores of a rig: on all voxels, or on a sample of them."""

from .evaluator import Evaluator
from .protocol import Judgement, Objective, RigJudge
from .sampling import VoxelSample, draw
from .scatter import Scatter
from .score import (
    FoundClass,
    GroundMap,
    ObjectScore,
    PartScore,
    Score,
    ScoreStopped,
    SensorScore,
    SummaryScore,
)

__all__ = [
    "Evaluator",
    "FoundClass",
    "GroundMap",
    "Judgement",
    "ObjectScore",
    "Objective",
    "PartScore",
    "RigJudge",
    "Scatter",
    "Score",
    "ScoreStopped",
    "SensorScore",
    "SummaryScore",
    "VoxelSample",
    "draw",
]

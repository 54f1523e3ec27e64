"""Scores of a rig: on all voxels, or on a sample of them."""

from .evaluator import Evaluator
from .protocol import Evaluation, RigEvaluator
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

__all__ = ["Evaluation", "Evaluator", "FoundClass", "GroundMap", "ObjectScore", "PartScore"]
__all__ += ["RigEvaluator", "Scatter", "Score", "ScoreStopped", "SensorScore", "SummaryScore"]
__all__ += ["VoxelSample", "draw"]

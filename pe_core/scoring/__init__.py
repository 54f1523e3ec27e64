"""Scores of a rig: on all voxels, or on a sample of them."""

from ..lazy_faces import lazy_face

with lazy_face(__name__):
    from .evaluator import Evaluator
    from .sampling import VoxelSample, draw
    from .score import (
        NO_DIFFERENCE,
        FoundClass,
        GroundMap,
        ObjectScore,
        PartScore,
        RigEvaluator,
        Scatter,
        Score,
        ScoreStopped,
        SensorScore,
        is_noise,
        paired_error,
    )

"""Objects as targets: sampled from the prior, placed in scenes, and the score of rigs on them."""

from .lone_objects import LoneObjects
from .object_evaluator import ObjectEvaluator
from .object_sampling import SampledObjects, sample_objects
from .target_rule import OBJECTS, TARGETS, VOXELS, TargetRule

__all__ = [
    "OBJECTS",
    "TARGETS",
    "VOXELS",
    "LoneObjects",
    "ObjectEvaluator",
    "SampledObjects",
    "TargetRule",
    "sample_objects",
]

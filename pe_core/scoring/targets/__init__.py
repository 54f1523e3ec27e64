"""Objects as targets: drawn from the prior, set in scenes, and what rigs are worth on them."""

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

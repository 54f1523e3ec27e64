"""Objects as targets: sampled from the prior, placed in scenes, and the score of rigs on them."""

from .object_evaluator import ObjectEvaluator
from .object_sampling import SampledObjects, sample_objects
from .target_rule import OBJECTS, TargetRule

__all__ = ["OBJECTS", "ObjectEvaluator", "SampledObjects", "TargetRule", "sample_objects"]

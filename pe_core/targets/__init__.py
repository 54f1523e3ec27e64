"""Objects as targets: drawn from the prior, set in scenes, and what rigs are worth on them."""

from .drawing import DrawnObjects, drawn_objects
from .evaluator import ObjectEvaluator
from .lone import LoneObjects
from .rule import OBJECTS, TARGETS, VOXELS, TargetRule

__all__ = [
    "OBJECTS",
    "TARGETS",
    "VOXELS",
    "DrawnObjects",
    "LoneObjects",
    "ObjectEvaluator",
    "TargetRule",
    "drawn_objects",
]

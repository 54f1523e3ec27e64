"""Objects as targets: drawn from the prior, set in scenes, and what rigs are worth on them."""

from .drawing import DrawnObjects, drawn_objects
from .evaluator import ObjectEvaluator
from .targets import OBJECTS, TARGETS, VOXELS, Targets

__all__ = [
    "OBJECTS",
    "TARGETS",
    "VOXELS",
    "DrawnObjects",
    "ObjectEvaluator",
    "Targets",
    "drawn_objects",
]

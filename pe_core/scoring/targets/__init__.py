"""Objects as targets: sampled from the prior, placed in scenes, and the score of rigs on them."""

from ...lazy_faces import lazy_face

with lazy_face(__name__):
    from .object_evaluator import ObjectEvaluator
    from .object_metric import FusedObjects
    from .object_sampling import OBJECTS, SampledObjects, TargetRule, sample_objects

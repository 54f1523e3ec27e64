"""Requirements with a verdict: zones round the vehicle, test bodies, criteria, margins."""

from ...lazy_faces import lazy_face

with lazy_face(__name__):
    from .bodies import BODIES, Body
    from .checker import CheckStep, RequirementChecker, checkable
    from .criteria import Criterion, Requirement, RobustTo, checked_requirements
    from .definition import body_met, placed, sees
    from .planes import VehiclePlanes
    from .verdict import (
        FARTHEST_M,
        Reason,
        Samples,
        Verdict,
        VerdictRow,
        VerdictSummary,
        margin_of,
        part_in_the_way,
    )
    from .zones import PlacedZone, Zone, signed_distance

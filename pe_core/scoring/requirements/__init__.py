"""Requirements with a verdict: zones round the vehicle, test bodies, criteria, margins."""

from .bodies import BODIES, Body
from .checker import RequirementChecker
from .criteria import Criterion, Requirement, Under, body_met, checked_requirements, sees
from .planes import VehiclePlanes
from .redundancy import Redundancy, RedundancyMap
from .verdict import Samples, Verdict, margin_of
from .zones import PlacedZone, Zone, signed_distance

__all__ = [
    "BODIES",
    "Body",
    "Criterion",
    "PlacedZone",
    "Redundancy",
    "RedundancyMap",
    "Requirement",
    "RequirementChecker",
    "Samples",
    "Under",
    "VehiclePlanes",
    "Verdict",
    "Zone",
    "body_met",
    "checked_requirements",
    "margin_of",
    "sees",
    "signed_distance",
]

"""What a study judges a rig on: the voxels of the paper, or objects."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import InputError, shown
from ..text.values import Whole, choice

VOXELS, OBJECTS = "voxels", "objects"
TARGETS = (VOXELS, OBJECTS)
SCENES = 256
"""By default; a standard error of about 0.1 nats on the road."""
COUNT = Whole(8, 20_000, "scenes")
"""More would take minutes and gigabytes for a standard error below 0.01 nats."""


@dataclass(frozen=True, slots=True)
class TargetRule:
    """What is judged, and how.

    Parameters
    ----------
    targets : {"voxels", "objects"}
    traffic : bool
        Whether the objects of a scene hide each other.
    scenes : int
        How many scenes objects stand in; the expected score is their mean.

    Raises
    ------
    InputError
        When a value is none of these, or voxels are to have traffic.
    """

    targets: str = VOXELS
    traffic: bool = False
    scenes: int = SCENES

    def __post_init__(self) -> None:
        choice("metric", "targets", self.targets, TARGETS)
        if not isinstance(self.traffic, bool):
            raise InputError("metric", "traffic", "true or false", shown(self.traffic))
        if self.traffic and not self.are_objects:
            raise InputError("metric", "traffic", f"targets = {OBJECTS!r} beside it", self.targets)
        object.__setattr__(self, "scenes", COUNT.checked("metric", "scenes", self.scenes))

    @property
    def are_objects(self) -> bool:
        """Whether objects are judged, not voxels."""
        return self.targets == OBJECTS

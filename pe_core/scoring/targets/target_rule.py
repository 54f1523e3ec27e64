"""The targets on which a study scores rigs: the voxels of the paper, or objects."""

from __future__ import annotations

from dataclasses import dataclass

from ...base.errors import InputError
from ...base.setting import FLAG, OneOf, Panel, check_settings, setting
from ...base.values import Whole

VOXELS, OBJECTS = "voxels", "objects"
TARGETS = (VOXELS, OBJECTS)
MENU = (
    ("Voxels", "How well each voxel is measured: perception entropy, as in the paper"),
    ("Objects", "How well objects of the prior are detected: expected AP, and range"),
)
"""How Blender's panel shows `TARGETS`."""
SCENES = 256
"""The default; it gives a standard error of about 0.1 nats on the road."""
COUNT = Whole(8, 20_000, "scenes")
"""More would take minutes and gigabytes for a standard error below 0.01 nats."""


@dataclass(frozen=True, slots=True)
class TargetRule:
    """The targets of a score, and how objects are placed.

    Raises
    ------
    InputError
        When a value is not valid, or traffic is requested for voxels.
    """

    targets: str = setting(
        VOXELS,
        OneOf(TARGETS),
        "What a rig is scored on: all voxels, or objects of the prior",
        Panel("targets", "Targets", menu=MENU),
        scored=True,
    )
    traffic: bool = setting(
        False,
        FLAG,
        "Objects of a scene occlude each other from every sensor",
        Panel("traffic", "Traffic", when="targets=objects"),
        scored=True,
    )
    scenes: int = setting(
        SCENES,
        COUNT,
        "Number of scenes with objects; the expected score is their mean",
        Panel("scenes", "Scenes", soft_max=4096, when="targets=objects"),
        scored=True,
    )

    def __post_init__(self) -> None:
        check_settings(self, "metric")
        if self.traffic and not self.are_objects:
            raise InputError("metric", "traffic", f"targets = {OBJECTS!r} with it", self.targets)

    @property
    def are_objects(self) -> bool:
        """Whether objects are scored, not voxels."""
        return self.targets == OBJECTS

"""Where the sensors of a rig are on a vehicle, as both studies have it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

import pe_core as pe
from pe_core.geometry import Pose
from pe_core.scene.rig import SensorModel

PoseValues = tuple[float, ...]
"""x, y, z, roll, pitch, yaw of a sensor [m, deg], rounded as in a file."""


@dataclass(frozen=True, slots=True)
class PosedSensors:
    """Where the sensors of a rig are on a vehicle.

    Attributes
    ----------
    name : str
        Design, vehicle and number: ``fixed-sedan-01``.
    vehicle : str
    poses : tuple of PoseValues
        Of each sensor.
    all_round : bool
        Whether a point near the ground is seen in each direction.
    """

    name: str
    vehicle: str
    poses: tuple[PoseValues, ...]
    all_round: bool

    @property
    def hardware(self) -> str:
        """What is equal in all placements of one rig."""
        return str(len(self.poses))

    @property
    def mean_height(self) -> float:
        """Mean height of the sensors above the ground [m]."""
        return float(np.mean([pose[2] for pose in self.poses]))

    def rig_of(self, model: SensorModel) -> pe.Rig:
        """Return the rig with sensors of one model, all fused early."""
        sensors = [
            pe.Sensor(f"{model.kind} {k}", model, pose_of(p)) for k, p in enumerate(self.poses)
        ]
        return pe.Rig(sensors)


P = TypeVar("P", bound=PosedSensors)


def first_of_each(drawn: Iterator[P], count: Mapping[bool, int]) -> list[P]:
    """Return the first placements that see all round, and then the first that do not.

    Parameters
    ----------
    drawn : iterator of PosedSensors
    count : mapping
        How many there are of each, by whether they see all round.
    """
    kept: list[P] = []
    for placement in drawn:
        if sum(p.all_round == placement.all_round for p in kept) < count[placement.all_round]:
            kept.append(placement)
        if len(kept) == sum(count.values()):
            break
    return sorted(kept, key=lambda p: not p.all_round)


def numbered(kept: Sequence[P]) -> list[P]:
    """Return placements with their number after their name."""
    return [replace(p, name=f"{p.name}-{k:02}") for k, p in enumerate(kept, 1)]


def pose_of(values: PoseValues) -> Pose:
    """Return the pose of values that are rounded as in a file."""
    x, y, z, *angles = values
    roll, pitch, yaw = (math.radians(a) for a in angles)
    return Pose((x, y, z), (roll, pitch, yaw))


def pose_texts(placement: PosedSensors) -> dict[str, list[str]]:
    """Return the poses of a placement as JSON data, for people."""
    texts = [" ".join(f"{w:g}" for w in pose) for pose in placement.poses]
    return {"x y z roll pitch yaw": texts}

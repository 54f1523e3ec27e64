"""Design variables of a search: coordinates of a pose by name, their rounding and their ranges."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..geometry.poses import Pose

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
POSITION_AXES = AXES[:3]
POSITION_DECIMALS = 5
ANGLE_DECIMALS_DEG = 4
"""Placements are rounded to 0.01 mm and 0.0001 deg, so that a file, or Blender's single precision,
holds exactly the placement that was scored."""
ROUNDING_M = 0.5 * 10.0**-POSITION_DECIMALS
ROUNDING_RAD = math.radians(0.5 * 10.0**-ANGLE_DECIMALS_DEG)
"""Rounding may move a placement at a bound so far beyond it."""


def pose_values(pose: Pose) -> dict[str, float]:
    """Return a pose by axis: x, y, z [m], roll, pitch, yaw [rad]."""
    return dict(zip(AXES, (*pose.position, *pose.rpy), strict=True))


def pose_from_values(values: Mapping[str, float]) -> Pose:
    """Return the pose with coordinates by axis [m, rad], rounded as placements are."""
    position = [round(values[a], POSITION_DECIMALS) + 0.0 for a in POSITION_AXES]
    degrees = [round(math.degrees(values[a]), ANGLE_DECIMALS_DEG) + 0.0 for a in AXES[3:]]
    return Pose.from_degrees(position, degrees)


def rounded(pose: Pose) -> Pose:
    """Return a pose, rounded as placements are."""
    return pose_from_values(pose_values(pose))


METRE, RADIAN, SHARE = "m", "rad", "share"


@dataclass(frozen=True, slots=True)
class DesignVariable:
    """A number that a search varies.

    Parameters
    ----------
    low, high : float
        Its range; both ends belong to it.
    unit : {"m", "rad", "share"}
        A share, from 0 to 1, selects an element of a list; it is cyclic.
    """

    low: float
    high: float
    unit: str

    def clipped(self, value: float) -> float:
        """Return a value clipped to the range; a share is taken modulo 1."""
        if self.unit == SHARE:
            return value % 1.0
        return min(max(value, self.low), self.high)


def variable_of(axis: str, bounds: tuple[float, float]) -> DesignVariable:
    """Return the design variable of a coordinate, with its bounds [m or rad]."""
    return DesignVariable(*bounds, METRE if axis in POSITION_AXES else RADIAN)

"""The coordinates of a pose by name, and how finely a placement is told."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..scene.geometry import Pose

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
POSITION_AXES = AXES[:3]
POSITION_DECIMALS = 5
ANGLE_DECIMALS_DEG = 4
"""Placements are rounded to 0.01 mm and 0.0001 deg: a file, or Blender's single precision, then
holds exactly the placement that was scored."""
HELD_M = 0.5 * 10.0**-POSITION_DECIMALS
HELD_RAD = math.radians(0.5 * 10.0**-ANGLE_DECIMALS_DEG)
"""A placement at a bound may be rounded to this far beyond it."""


def pose_values(pose: Pose) -> dict[str, float]:
    """Return a pose by axis: x, y, z [m], roll, pitch, yaw [rad]."""
    return dict(zip(AXES, (*pose.position, *pose.rpy), strict=True))


def pose_from_values(values: Mapping[str, float]) -> Pose:
    """Pose from its axes, rounded as placements are."""
    position = [round(values[a], POSITION_DECIMALS) + 0.0 for a in POSITION_AXES]
    degrees = [round(math.degrees(values[a]), ANGLE_DECIMALS_DEG) + 0.0 for a in AXES[3:]]
    return Pose.from_degrees(position, degrees)


def rounded(pose: Pose) -> Pose:
    """Return a pose rounded as placements are."""
    return pose_from_values(pose_values(pose))

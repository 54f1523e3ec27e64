"""Sensors of one kind at one place: alternatives that a file lists side by side, each counted."""

import math
from collections.abc import Sequence

import numpy as np

from ..scene.rig import Sensor
from .kind import kind_of

SAME_PLACE_M = 0.01  # Origins nearer than this [m] cannot be of two devices
SAME_AXIS_RAD = math.radians(30.0)
"""Cameras that look apart by more than this may be at one point: a drawing often has them so."""


def coinciding(sensors: Sequence[Sensor]) -> list[tuple[Sensor, ...]]:
    """Return the groups of sensors of one kind whose origins are within 1 cm of the group's first;
    cameras count only if their axes are within 30 degrees, too."""
    if len(sensors) < 2:
        return []
    places = np.array([sensor.pose.position for sensor in sensors])
    axes = np.array([sensor.pose.ground_from_sensor[:, 0] for sensor in sensors])
    grouped: set[int] = set()
    groups = []
    for first, sensor in enumerate(sensors):
        if first in grouped:
            continue
        near = np.flatnonzero(np.linalg.norm(places - places[first], axis=1) < SAME_PLACE_M)
        group = [
            k
            for k in near.tolist()
            if k >= first
            and k not in grouped
            and sensors[k].kind == sensor.kind
            and (not kind_of(sensor).has_top or _along(axes[first], axes[k]))
        ]
        if len(group) > 1:
            grouped |= set(group)
            groups.append(tuple(sensors[k] for k in group))
    return groups


def _along(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(a @ b >= math.cos(SAME_AXIS_RAD))

"""What ultrasonic sensors add to the kernels of sensors with a fan of rays."""

from __future__ import annotations

import numpy as np

from ...base.arrays import Flags, Floats
from ...geometry.poses import dot
from ...scene.rig import Sensor
from ..object_kernel import NUDGE_M, ObjectView
from ..ray_fan import RayFan
from ..ray_fan_kernels import FanRules
from .definition import in_cone, measure_voxels, objects_heard, returns_echo
from .model import ultrasonic_of


def cone_of(sensor: Sensor, fan: RayFan) -> Flags:
    """Return which rays (E, A) of a fan are in the cone."""
    elevations, azimuths = fan.angles
    return in_cone(ultrasonic_of(sensor), azimuths[None, :], elevations[:, None])


def reached_by_balls(sensor: Sensor, centers: Floats, balls: Floats) -> Flags:
    """Whether balls (N,) round points (N, 3) [m] may be in range; never too few."""
    offsets = centers - np.asarray(sensor.pose.position)
    reach = ultrasonic_of(sensor).max_range + balls
    return np.asarray(dot(offsets, offsets) <= reach * reach)


def measure_columns(
    sensor: Sensor, columns: Floats, heights: Floats, side: float, fan: RayFan
) -> Floats:
    """Return m (C, Z) of cubes in columns (C, 2) at heights (Z,) [m]: 1 or 0."""
    up, across = len(heights), len(columns)
    centers = np.column_stack([np.repeat(columns, up, axis=0), np.tile(heights, across)])
    return measure_voxels(sensor, centers, side, fan).reshape(across, up)


def hears_points(sensor: Sensor, points: Floats, fan: RayFan) -> Flags:
    """Whether points (N, 3) of posts return an echo: sound meets a post level."""
    offsets = points - (np.asarray(sensor.pose.position) + NUDGE_M)
    steepest = min(ultrasonic_of(sensor).max_incidence, np.pi / 2.0 - 1e-9)
    flat = np.sqrt((offsets[:, :2] ** 2).sum(axis=1))
    level = np.abs(offsets[:, 2]) <= np.tan(steepest) * flat
    return returns_echo(sensor, fan, offsets) & level


def measure_view(sensor: Sensor, view: ObjectView, fan: RayFan) -> Floats:
    """Return m (N,) of objects: 1 or 0."""
    return objects_heard(sensor, view.objects, fan, view.traffic)


RULES = FanRules(
    through_covers=False,
    field=cone_of,
    reached=reached_by_balls,
    voxels=measure_voxels,
    columns=measure_columns,
    posts=hears_points,
    objects=measure_view,
)

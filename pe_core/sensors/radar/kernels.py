"""What radars add to the kernels of sensors with a fan of rays."""

from __future__ import annotations

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...geometry.poses import dot
from ...scene.rig import Sensor
from ..boxes import NUDGE_M, PlacedBoxes, Rivals
from ..kernels import ObjectView
from ..ray_fan import RayFan, angles_of
from ..ray_fan_kernels import BALL_MARGIN_M, FanRules
from .definition import (
    NEAR_M,
    measure_directions,
    measure_voxels,
    mode_signal,
    objects_seen,
    reached_by_balls,
    seen_through,
)
from .detection import LOW_DBSM
from .model import radar_of


def measure_view(sensor: Sensor, view: ObjectView, fan: RayFan) -> Floats:
    """Return m (N,) of the objects whose balls reach into the field of view, 0 of others."""
    objects = view.objects
    boxes = PlacedBoxes.of(objects, sensor.pose.position)
    balls = np.sqrt(dot(objects.sizes, objects.sizes)) / 2.0 + BALL_MARGIN_M
    which = np.flatnonzero(reached_by_balls(sensor, objects.centers, balls))
    alone = np.arange(len(objects))

    def near(own: Ints) -> Rivals:
        if not view.traffic:
            return Rivals.of(alone, own)
        return Rivals.near(boxes, objects.scenes, balls, own)

    return objects_seen(sensor, objects, fan, boxes, which, near)


def measure_columns(
    sensor: Sensor, columns: Floats, heights: Floats, side: float, fan: RayFan
) -> Floats:
    """Return m (C, Z) of cubes in columns (C, 2) at heights (Z,) [m].

    What depends on the column alone is computed once a column; so does the azimuth of a level
    radar. Sums are in the order of `rotate` and `dot`: the same bits as of single cubes.
    """
    position = np.asarray(sensor.pose.position) + NUDGE_M
    x, y = (columns - position[:2]).T[:, :, None]
    z = heights - position[2]
    ahead, left, up = (
        row[0] * x + row[1] * y + (row[2] * z if row[2] else 0.0)
        for row in sensor.pose.ground_from_sensor.T
    )
    angles = np.arctan2(left, ahead), np.arctan2(up, np.sqrt(ahead * ahead + left * left))
    distance = np.maximum(np.sqrt(x * x + y * y + z * z), NEAR_M)
    return measure_directions(radar_of(sensor), angles, distance, side, fan)


def detects_points(sensor: Sensor, points: Floats, fan: RayFan) -> Flags:
    """Whether points (N, 3) of posts are detected with the probability of the data sheet.

    A post has the RCS in one cell that 95 % of all pedestrians exceed, the weakest class.
    """
    radar = radar_of(sensor)
    offsets = points - (np.asarray(sensor.pose.position) + NUDGE_M)
    distance = np.maximum(np.sqrt(dot(offsets, offsets)), NEAR_M)
    angles = angles_of(sensor, offsets)
    free, loss = seen_through(fan, angles, distance)
    rcs = np.full(len(points), 10.0 ** (LOW_DBSM["pedestrian"] / 10.0))
    found = np.zeros(len(points), bool)
    for mode in radar.modes:
        pd = mode_signal(radar, mode, angles, distance, rcs, loss)
        found |= pd >= radar.detection_probability * (1.0 - 1e-12)
    return found & free


def field_of(sensor: Sensor, fan: RayFan) -> Flags:
    """Return which rays (E, A) of a fan are in the field of any mode."""
    elevations, azimuths = fan.angles
    shape = fan.distance.shape
    across = np.broadcast_to(azimuths, shape).reshape(-1)
    up = np.broadcast_to(elevations[:, None], shape).reshape(-1)
    modes = radar_of(sensor).modes
    inside = np.logical_or.reduce([mode.reach(across, up) > 0.0 for mode in modes])
    return np.asarray(inside).reshape(shape)


RULES = FanRules(
    through_covers=True,
    field=field_of,
    reached=reached_by_balls,
    voxels=measure_voxels,
    columns=measure_columns,
    posts=detects_points,
    objects=measure_view,
)

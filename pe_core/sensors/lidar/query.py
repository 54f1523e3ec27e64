"""Queries about one location: the beams of a LiDAR that reach it, or why none does."""

from __future__ import annotations

import math

import numpy as np

from ...base.arrays import Floats
from ...geometry.poses import rotate
from ...scene.rig import Sensor
from ..kind import BETWEEN_BEAMS, OUT_OF_RANGE, OUT_OF_VIEW
from .definition import BALL, beam_directions, cube_crossing
from .model import Lidar, lidar_of
from .tie_rules import offsets_in_voxels

WIDE_GAP_RAD = math.radians(5.0)
"""A gap between azimuths wider than this, and than 1.5 steps, bounds a field of view [rad]."""


def sample_beams(sensor: Sensor, max_count: int) -> Floats:
    """Return the directions (R, 3) of at most `max_count` beams, ground frame, evenly picked."""
    directions = lidar_of(sensor).directions
    if len(directions) > max_count:
        directions = directions[np.linspace(0, len(directions) - 1, max_count).astype(np.int64)]
    return rotate(sensor.pose.ground_from_sensor, directions)


def beams_to(sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
    """Return the directions (R, 3) of beams through a cube in range, and where they enter [m]."""
    directions, enter, leave = _through(sensor, center, side)
    lidar = lidar_of(sensor)
    in_range = (enter <= lidar.max_range / side) & (leave >= lidar.min_range / side)
    return directions[in_range], enter[in_range] * side


def reason_missed(sensor: Sensor, center: Floats, side: float) -> str:
    """Return why no beam passes through a cube: out of range, out of view or between beams."""
    lidar = lidar_of(sensor)
    offset = center - np.asarray(sensor.pose.position)
    gap = np.maximum(np.abs(offset) - side / 2.0, 0.0)
    if float(np.sqrt((gap * gap).sum())) > lidar.max_range:
        return OUT_OF_RANGE
    if len(_through(sensor, center, side)[0]):
        return OUT_OF_RANGE
    return BETWEEN_BEAMS if _in_view(lidar, sensor, offset, side) else OUT_OF_VIEW


def _through(sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats, Floats]:
    """Directions of beams through a cube, and where they enter and leave it, in sides."""
    directions = beam_directions(sensor)
    offset = offsets_in_voxels(center[None], sensor.pose.position, side)
    enter, leave = cube_crossing(np.broadcast_to(offset, directions.shape), directions)
    through = enter < leave
    return directions[through], enter[through], leave[through]


def _in_view(lidar: Lidar, sensor: Sensor, offset: Floats, side: float) -> bool:
    """Whether a cube lies between the lowest and highest channel, and among the azimuths."""
    x, y, z = rotate(sensor.pose.ground_from_sensor.T, offset).tolist()
    distance, flat = math.hypot(x, y, z), math.hypot(x, y)
    if distance <= BALL * side:
        return True
    margin = math.asin(BALL * side / distance)
    low, high = float(lidar.elevations.min()), float(lidar.elevations.max())
    if not low - margin <= math.atan2(z, flat) <= high + margin:
        return False
    half_width = math.asin(min(1.0, BALL * side / flat)) if flat else math.pi
    return _distance_to_azimuths(lidar, math.atan2(y, x)) <= half_width


def _distance_to_azimuths(lidar: Lidar, azimuth: float) -> float:
    """Angle from an azimuth to the field of view, sensor frame [rad]; 0 inside."""
    beams = lidar.directions
    azimuths = np.unique(np.arctan2(beams[:, 1], beams[:, 0]))
    distances = np.abs((azimuths - azimuth + math.pi) % (2.0 * math.pi) - math.pi)
    before = float(np.min((azimuth - azimuths) % (2.0 * math.pi)))
    after = float(np.min((azimuths - azimuth) % (2.0 * math.pi)))
    step = lidar.azimuth_step if lidar.azimuth_count > 1 else 0.0
    inside = before + after <= max(WIDE_GAP_RAD, 1.5 * step)
    return 0.0 if inside else float(distances.min())

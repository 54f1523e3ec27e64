"""What a LiDAR answers when it is asked about one place: its beams there, or why it has none."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import rotate
from ...scene.sensors import Sensor
from ..kind import BETWEEN_BEAMS, OUT_OF_RANGE, OUT_OF_VIEW
from .definition import BALL, beam_directions, cube_crossing
from .model import Lidar
from .ties import offsets_in_voxels

Floats = NDArray[np.float64]

WIDE_GAP_RAD = math.radians(5.0)
"""Azimuths farther apart than this, and than a step and a half, are the end of a field of view."""


def some_beams(sensor: Sensor, most: int) -> Floats:
    """(R, 3) unit directions, ground frame: all beams, or so many of them, evenly picked."""
    directions = cast(Lidar, sensor.model).directions
    if len(directions) > most:
        directions = directions[np.linspace(0, len(directions) - 1, most).astype(np.int64)]
    return rotate(sensor.pose.ground_from_sensor, directions)


def beams_to(sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
    """(R, 3) directions of the beams that pass through a cube in range, (R,) where they enter."""
    directions, enter, leave = _through(sensor, center, side)
    lidar = cast(Lidar, sensor.model)
    near = (enter <= lidar.max_range / side) & (leave >= lidar.min_range / side)
    return directions[near], enter[near] * side


def missed(sensor: Sensor, center: Floats, side: float) -> str:
    """Say why no beam passes through a cube: out of range, out of view, between beams."""
    lidar = cast(Lidar, sensor.model)
    offset = center - np.asarray(sensor.pose.position)
    beyond = np.maximum(np.abs(offset) - side / 2.0, 0.0)
    if float(np.sqrt((beyond * beyond).sum())) > lidar.max_range:
        return OUT_OF_RANGE
    if len(_through(sensor, center, side)[0]):
        return OUT_OF_RANGE
    return BETWEEN_BEAMS if _in_view(lidar, sensor, offset, side) else OUT_OF_VIEW


def _through(sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats, Floats]:
    """Beams through a cube, where they enter and leave it, in sides, as the definition has them."""
    directions = beam_directions(sensor)
    offset = offsets_in_voxels(center[None], sensor.pose.position, side)
    enter, leave = cube_crossing(np.broadcast_to(offset, directions.shape), directions)
    through = enter < leave
    return directions[through], enter[through], leave[through]


def _in_view(lidar: Lidar, sensor: Sensor, offset: Floats, side: float) -> bool:
    """Whether a cube lies between the highest and lowest channel, and where azimuths are."""
    x, y, z = rotate(sensor.pose.ground_from_sensor.T, offset).tolist()
    distance, flat = math.hypot(x, y, z), math.hypot(x, y)
    if distance <= BALL * side:
        return True
    margin = math.asin(BALL * side / distance)
    low, high = float(lidar.elevations.min()), float(lidar.elevations.max())
    if not low - margin <= math.atan2(z, flat) <= high + margin:
        return False
    aside = math.asin(min(1.0, BALL * side / flat)) if flat else math.pi
    return _distance_to_azimuths(lidar, math.atan2(y, x)) <= aside


def _distance_to_azimuths(lidar: Lidar, azimuth: float) -> float:
    """Angle from an azimuth to the field of view, sensor frame [rad]; 0 inside."""
    beams = lidar.directions
    known = np.unique(np.arctan2(beams[:, 1], beams[:, 0]))
    away = np.abs((known - azimuth + math.pi) % (2.0 * math.pi) - math.pi)
    before = float(np.min((azimuth - known) % (2.0 * math.pi)))
    after = float(np.min((known - azimuth) % (2.0 * math.pi)))
    step = lidar.azimuth_step if lidar.azimuth_count > 1 else 0.0
    inside = before + after <= max(WIDE_GAP_RAD, 1.5 * step)
    return 0.0 if inside else float(away.min())

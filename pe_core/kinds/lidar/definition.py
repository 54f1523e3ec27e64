"""The measurement of a LiDAR as it is defined: every beam, no tricks."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot, rotate
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from .model import Lidar
from .ties import offsets_in_voxels, without_zeros

Floats = NDArray[np.float64]

BEAM_TESTS_AT_ONCE = 1 << 23
"""Memory bound: beams times voxels looked at together."""
CULL_MARGIN_RAD = 1e-6
BALL = np.sqrt(3.0) / 2.0
"""Radius of the ball around a cube, in sides."""


def beam_directions(sensor: Sensor) -> Floats:
    """(B, 3) unit directions of a LiDAR's beams in the ground frame, eq. 1."""
    return rotate(sensor.pose.ground_from_sensor, cast(Lidar, sensor.model).directions)


def beam_ends(sensor: Sensor, directions: Floats, vehicle: Vehicle | None) -> Floats:
    """(B,) distance at which each beam ends: the vehicle or the maximum range [m]."""
    max_range = cast(Lidar, sensor.model).max_range
    if vehicle is None:
        return np.full(len(directions), max_range)
    glass = sensor.model.sees_through_glass
    hits = vehicle.first_hit(sensor.pose.position, directions, glass)
    return np.minimum(hits.distance, max_range)


def count_beams(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    directions = beam_directions(sensor)
    ends = beam_ends(sensor, directions, vehicle) / side
    nearest = cast(Lidar, sensor.model).min_range / side
    offsets = offsets_in_voxels(centers, sensor.pose.position, side)
    counts = np.zeros(len(centers))
    portion = max(1, BEAM_TESTS_AT_ONCE // len(directions))
    for start in range(0, len(centers), portion):
        some = offsets[start : start + portion]
        voxel, beam = _near_pairs(some, directions)
        enter, leave = cube_crossing(some[voxel], directions[beam])
        through = (enter < leave) & (enter <= ends[beam])
        through &= np.minimum(leave, ends[beam]) >= nearest
        counts[start : start + portion] = np.bincount(voxel[through], minlength=len(some))
    return counts


def _near_pairs(offsets: Floats, directions: Floats) -> tuple[NDArray, NDArray]:
    """(voxel, beam) pairs where the beam meets the ball around the cube; the rest can't touch."""
    distance = np.sqrt(dot(offsets, offsets))
    safe = np.maximum(distance, BALL)
    least = np.where(distance > BALL, np.cos(np.arcsin(BALL / safe) + CULL_MARGIN_RAD), -2.0)
    cosine = offsets @ directions.T / safe[:, None]
    voxel, beam = np.nonzero(cosine >= least[:, None])
    return voxel, beam


def cube_crossing(offsets: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Distances (P,) at which rays from the origin enter and leave unit cubes centred at offsets.

    Enter is at least 0; enter >= leave where the ray misses.
    """
    step = without_zeros(directions)
    t0, t1 = (offsets - 0.5) / step, (offsets + 0.5) / step
    enter, leave = np.minimum(t0, t1), np.maximum(t0, t1)
    return np.maximum(enter.max(axis=1), 0.0), leave.min(axis=1)

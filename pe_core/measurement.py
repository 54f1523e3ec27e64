"""The measurement m = f(s, q) as it is defined: every beam, every pixel, no tricks.

This is what the scoring kernels are held against. It is written to be read; use an `Evaluator` for
many voxels.
"""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError
from .geometry import dot, rotate
from .kernels.camera_area import clipped_pixel_area
from .kernels.ties import offsets_in_voxels, without_zeros
from .sensors import Camera, Lidar, Sensor
from .vehicle import Vehicle

Floats = NDArray[np.float64]

BEAM_TESTS_AT_ONCE = 1 << 23
"""Memory bound: beams times voxels looked at together."""
CULL_MARGIN_RAD = 1e-6
BALL = np.sqrt(3.0) / 2.0
"""Radius of the ball around a cube, in sides."""


def measure(
    sensor: Sensor, centers: ArrayLike, side: float, vehicle: Vehicle | None = None
) -> Floats:
    """Return the measurement of each voxel by one sensor.

    LiDAR: the number of beams that pass through the cube, entering it no farther than the maximum
    range and not stopped earlier by the vehicle. A cube owns its lower faces: a beam that runs
    exactly along a face belongs to the cube above it (`kernels.ties`).
    Camera: the area in pixels of the cube's image, clipped to the image; 0 when a corner lies
    behind the camera or the vehicle hides the centre.

    Parameters
    ----------
    sensor : Sensor
    centers : (V, 3) float
        Voxel centres, ground frame [m].
    side : float
        Side of the cubes [m].
    vehicle : Vehicle, optional
        Hides what lies behind it.

    Returns
    -------
    (V,) float
        Beams or pixels.

    Raises
    ------
    InputError
        When the centres are not (V, 3) finite numbers.
    """
    centers = np.asarray(centers, dtype=float)
    if centers.ndim != 2 or centers.shape[1] != 3 or not np.isfinite(centers).all():
        raise InputError("measure", "centers", "(V, 3) finite numbers", centers.shape)
    if sensor.kind == "lidar":
        return _count_beams(sensor, centers, side, vehicle)
    return _count_pixels(sensor, centers, side, vehicle)


def beam_directions(sensor: Sensor) -> Floats:
    """(B, 3) unit directions of a LiDAR's beams in the ground frame, eq. 1."""
    return rotate(sensor.pose.ground_from_sensor, cast(Lidar, sensor.model).directions)


def beam_ends(sensor: Sensor, directions: Floats, vehicle: Vehicle | None) -> Floats:
    """(B,) distance at which each beam ends: the vehicle or the maximum range [m]."""
    max_range = cast(Lidar, sensor.model).max_range
    if vehicle is None:
        return np.full(len(directions), max_range)
    return np.minimum(vehicle.first_hit(sensor.pose.position, directions).distance, max_range)


def _count_beams(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    directions = beam_directions(sensor)
    ends = beam_ends(sensor, directions, vehicle) / side
    offsets = offsets_in_voxels(centers, sensor.pose.position, side)
    counts = np.zeros(len(centers))
    portion = max(1, BEAM_TESTS_AT_ONCE // len(directions))
    for start in range(0, len(centers), portion):
        some = offsets[start : start + portion]
        voxel, beam = _near_pairs(some, directions)
        enter, leave = cube_crossing(some[voxel], directions[beam])
        through = (enter < leave) & (enter <= ends[beam])
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


def _count_pixels(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    area = clipped_pixel_area(cast(Camera, sensor.model), sensor.pose, centers, side)
    seen = np.flatnonzero(area)
    if vehicle is not None and len(seen):
        area[seen[hidden_by(vehicle, sensor, centers[seen])]] = 0.0
    return area


def hidden_by(vehicle: Vehicle, sensor: Sensor, centers: Floats) -> NDArray[np.bool_]:
    """Whether the vehicle stands between a camera and each of (V, 3) centres."""
    offsets = centers - np.asarray(sensor.pose.position)
    distance = np.sqrt(dot(offsets, offsets))
    directions = offsets / distance[:, None]
    hits = vehicle.first_hit(sensor.pose.position, directions, sensor.kind)
    return hits.distance < distance

"""Closed-form models of one sensor: a bound on what a camera can do, and expected beam counts.

**The bound** shows that the camera rows cannot come from the printed formula. The image of a cube
of side s, whose nearest point is at distance d, is not larger than the image of the disk that hides
it: its area is at most sqrt(3) s^2 (f / d)^2 / cos^3 of the angle off the axis, and at most that of
the whole image. With AP = a ln m + b this bounds the entropy of each voxel from below, wherever the
camera looks and whatever the cube is behind.

**Expected beam counts** show what counting whole beams does to the perception entropy. The metric
counts whole beams, so between two channels that are far away there are voxels with m = 0. If the
beams of a channel were spread evenly over half the gap to each neighbour, and those of an azimuth
over its step, a voxel would have m = (its solid angle) x (beams per solid angle) everywhere.
"""

from __future__ import annotations

import math

import numpy as np

from pe_core import ApCurve, Camera, Lidar
from pe_core.base import Floats
from pe_core.metric import H_BLIND, entropy_of, precision_of

MAX_SHADOW = math.sqrt(3.0)
"""The largest shadow of a cube, as a multiple of the area of a face."""
MIN_HALF_HEIGHT_RAD = 1e-4
"""A voxel is taken to have at least this half height, as seen from the sensor: a mean over no
interval has no value."""


def max_pixel_area(camera: Camera, distance: Floats, side: float) -> Floats:
    """Return an upper bound of the pixel area of cubes, (V,).

    The nearest point of a cube is nearer than its centre by up to half the diagonal. A pinhole
    camera enlarges what is off its axis, most of all at the corner of the image. `distance` is that
    of the centres of the cubes (V,) and `side` their side [m].
    """
    nearest = np.maximum(distance - MAX_SHADOW / 2.0 * side, 1e-3)
    corner = math.hypot(camera.width, camera.height) / 2.0 / camera.focal_px
    off_axis = (1.0 + corner**2) ** 1.5
    area = MAX_SHADOW * side**2 * (camera.focal_px / nearest) ** 2 * off_axis
    return np.minimum(area, float(camera.width * camera.height))


def min_entropy(camera: Camera, distance: Floats, side: float, curve: ApCurve) -> Floats:
    """Return a lower bound of the entropy of voxels at (V,) distances [m], (V,) [nats]."""
    return entropy_of(precision_of(max_pixel_area(camera, distance, side), curve))


def max_distance_for(camera: Camera, entropy: float, side: float, curve: ApCurve) -> float:
    """Return the distance [m] beyond which no voxel has an entropy as low as that [nats]."""
    low = 0.01
    high = 1000.0
    for _ in range(60):
        middle = (low + high) / 2.0
        if min_entropy(camera, np.array([middle]), side, curve)[0] <= entropy:
            low = middle
        else:
            high = middle
    return low


def max_unseen_share(entropy: float, camera: Camera, curve: ApCurve) -> float:
    """Return the largest share of the prior that may be unseen at a perception entropy [nats].

    It is the share if every voxel that is seen filled the whole image.
    """
    best = float(entropy_of(precision_of(float(camera.width * camera.height), curve)))
    return (entropy - best) / (H_BLIND - best)


def expected_beams(lidar: Lidar, offsets: Floats, side: float) -> Floats:
    """Return the mean number of beams of a level LiDAR through cubes, taken for points, (V,).

    `offsets` are the centres of the cubes, relative to the sensor (V, 3), `side` their side [m].
    """
    distance = np.sqrt((offsets**2).sum(axis=1))
    direction = offsets / distance[:, None]
    solid_angle = side**2 * np.abs(direction).sum(axis=1) / distance**2
    elevation = np.arcsin(direction[:, 2])
    half = np.maximum(np.sqrt(solid_angle) / 2.0, MIN_HALF_HEIGHT_RAD)
    edges = _channel_edges(lidar)
    channels = np.arange(len(edges), dtype=float)
    crossed = np.interp(elevation + half, edges, channels)
    crossed -= np.interp(elevation - half, edges, channels)
    per_radian = crossed / (2.0 * half)
    beams: Floats = solid_angle / np.cos(elevation) / lidar.azimuth_step * per_radian
    return np.where(distance <= lidar.max_range, beams, 0.0)


def expected_entropy(
    lidar: Lidar, position: tuple[float, float, float], centers: Floats, side: float, curve: ApCurve
) -> float:
    """Return the mean entropy [nats] of voxels that were sampled from the prior.

    `position` of the level LiDAR and `centers` of the voxels (V, 3) are in the ground frame [m];
    `curve` is AP of a voxel by its number of beams.
    """
    m = expected_beams(lidar, centers - np.asarray(position), side)
    return float(np.mean(entropy_of(precision_of(m, curve))))


def _channel_edges(lidar: Lidar) -> Floats:
    """Return the (C + 1,) elevations between the channels [rad].

    The outermost ones are as far from their channel as that channel's other edge.
    """
    e = np.sort(lidar.elevations)
    middles = (e[1:] + e[:-1]) / 2.0
    return np.concatenate([[2.0 * e[0] - middles[0]], middles, [2.0 * e[-1] - middles[-1]]])

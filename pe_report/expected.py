"""Expected beam counts: m as a continuous number, to see what counting whole beams does to PE.

The metric counts whole beams, so between two channels far away lie voxels with m = 0. Were the
beams of a channel spread evenly over half the gap to each neighbour, and those of an azimuth over
its step, a voxel would hold m = (its solid angle) x (beams a solid angle) everywhere.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pe_core import ApCurve, Lidar
from pe_core.metric import entropy_of, precision_of

Floats = NDArray[np.float64]

LEAST_HALF_RAD = 1e-4
"""No voxel is taken for less high than this, seen from the sensor: a mean over nothing."""


def expected_beams(lidar: Lidar, offsets: Floats, side: float) -> Floats:
    """Mean number of beams through cubes at (V, 3) offsets from a level LiDAR [m], seen as points.

    Parameters
    ----------
    lidar : Lidar
    offsets : (V, 3) float
        Centres of the cubes, seen from the sensor [m].
    side : float
        Side of the cubes [m].

    Returns
    -------
    (V,) float
    """
    distance = np.sqrt((offsets**2).sum(axis=1))
    toward = offsets / distance[:, None]
    solid_angle = side**2 * np.abs(toward).sum(axis=1) / distance**2
    elevation = np.arcsin(toward[:, 2])
    half = np.maximum(np.sqrt(solid_angle) / 2.0, LEAST_HALF_RAD)
    edges = _channel_edges(lidar)
    channels = np.arange(len(edges), dtype=float)
    between = np.interp(elevation + half, edges, channels)
    between -= np.interp(elevation - half, edges, channels)
    per_radian = between / (2.0 * half)
    beams: Floats = solid_angle / np.cos(elevation) / lidar.azimuth_step * per_radian
    return np.where(distance <= lidar.max_range, beams, 0.0)


def expected_entropy(
    lidar: Lidar, position: tuple[float, float, float], centers: Floats, side: float, curve: ApCurve
) -> float:
    """Mean entropy [nats] of voxels drawn from the prior, by expected counts."""
    m = expected_beams(lidar, centers - np.asarray(position), side)
    return float(np.mean(entropy_of(precision_of(m, curve))))


def _channel_edges(lidar: Lidar) -> Floats:
    """(C + 1,) elevations between the channels, the outermost as far out as their neighbours."""
    e = np.sort(lidar.elevations)
    middles = (e[1:] + e[:-1]) / 2.0
    return np.concatenate([[2.0 * e[0] - middles[0]], middles, [2.0 * e[-1] - middles[-1]]])

"""Beams as lines, and the rings in which channels meet the ground.

The vehicle has to stay visible. So a free beam is faint near the vehicle, strongest where it leaves
the vehicle's surroundings, and fades out from there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats
from pe_core.scene import Sensor

from .beams import Beams, Cast
from .primitives import Primitives
from .sensor_images import lidar_of

Colors = NDArray[np.floating]

BoxBounds = tuple[Floats, Floats]
"""Lowest and highest corner, (3,) each [m]."""

OVER_THE_CAR = 0.06
"""How strong a free beam is over the vehicle, beside where it leaves its surroundings."""
SURROUNDINGS_M = 0.5
STUB_M = 0.7
RING_AZIMUTHS, RING_FAR_M = 360, 45.0
"""Places along a ring on the ground, and where rings have faded to nothing."""
RING_JUMP = 1.35
"""Neighbours on a ring whose distances differ by more than this factor are not joined."""


def free_lines(
    sensor: Sensor,
    beams: Beams,
    length_m: float,
    colors: Colors,
    around: BoxBounds | None = None,
) -> Primitives:
    """Lines of the free beams, two pieces each, in (N, 4) colours.

    The lines end at the range, the ground (z = 0) or `length_m`, and fade out towards that length.
    Inside the box `around` they are faint.
    """
    free = ~beams.stopped
    directions = beams.directions[free]
    ends = np.minimum(np.minimum(beams.ends[free], length_m), ground_distance(sensor, directions))
    leave = np.minimum(_housing_exits(sensor, directions, around), ends)
    points = np.empty((len(ends), 4, 3))
    points[:] = sensor.pose.position
    points[:, 1:3] += (directions * leave[:, None])[:, None]
    points[:, 3] += directions * ends[:, None]
    shown = np.repeat(np.asarray(colors[free], np.float32)[:, None], 4, axis=1)
    shown[:, 0, 3] *= OVER_THE_CAR
    shown[:, 1:3, 3] *= (1.0 - leave / length_m)[:, None]
    shown[:, 3, 3] *= 1.0 - ends / length_m
    return Primitives.of(points, shown)


def stopped_lines(sensor: Sensor, beams: Beams, colors: Colors) -> Primitives:
    """Lines of the occluded beams, one piece each, in (N, 4) colours.

    A shorter line is drawn `STUB_M` long, because it would not be visible otherwise.
    """
    stopped = beams.stopped
    ends = np.maximum(beams.ends[stopped], STUB_M)
    points = np.empty((len(ends), 2, 3))
    points[:] = sensor.pose.position
    points[:, 1] += beams.directions[stopped] * ends[:, None]
    return Primitives.of(points, np.repeat(colors[stopped], 2, axis=0))


def ground_rings(found: Cast, rows: NDArray[np.int64], colors: Colors) -> Primitives:
    """Rings where whole channels meet the ground, without occluded parts, in (R, 4) colours.

    `rows` (R,) are numbers of channels; channels that were not cast are left out.
    """
    width = len(found.columns)
    if not width:
        return Primitives.empty()
    kept = np.flatnonzero(np.isin(rows, found.rows))
    lines = np.searchsorted(found.rows, rows[kept])
    columns = np.unique(np.linspace(0, width - 1, min(RING_AZIMUTHS, width)).round().astype(int))
    beams = lines[:, None] * width + columns
    distance = ground_distance(found.sensor, found.directions[beams.ravel()]).reshape(beams.shape)
    meets = (found.face[beams] < 0) & (distance <= lidar_of(found.sensor).max_range)
    far = np.where(meets, distance, np.inf)
    return _joined(found, beams, far, colors[kept])


def ground_distance(sensor: Sensor, directions: Floats) -> Floats:
    """(N,) distance along each direction to z = 0 [m]; inf for a beam that does not meet it."""
    height, down = sensor.pose.position[2], -directions[:, 2]
    if height <= 0.0:
        return np.full(len(directions), np.inf)
    distance = np.full(len(directions), np.inf)
    return np.divide(height, down, out=distance, where=down > 0.0)


def _joined(found: Cast, beams: NDArray[np.int64], far: Floats, colors: Colors) -> Primitives:
    """Join near neighbours of each ring (R, K), and the last point with the first."""
    circle = len(lidar_of(found.sensor).azimuth_steps) == lidar_of(found.sensor).azimuth_count
    after = np.roll(far, -1, axis=1)
    near = np.maximum(far, after) < RING_JUMP * np.minimum(far, after)
    near &= np.minimum(far, after) < RING_FAR_M
    near[:, -1] &= circle
    row, column = np.nonzero(near)
    following = (column + 1) % far.shape[1]
    ends = np.stack([beams[row, column], beams[row, following]], axis=1)
    distance = np.stack([far[row, column], far[row, following]], axis=1)
    points = np.asarray(found.sensor.pose.position) + (found.directions[ends] * distance[..., None])
    shown = np.repeat(np.asarray(colors[row], np.float32)[:, None], 2, axis=1)
    shown[..., 3] *= np.clip(1.0 - distance / RING_FAR_M, 0.0, 1.0)
    return Primitives.of(points, shown)


def _housing_exits(sensor: Sensor, directions: Floats, around: BoxBounds | None) -> Floats:
    """(N,) distance at which directions leave a box and its surroundings; 0 outside of it [m]."""
    if around is None or not len(directions):
        return np.zeros(len(directions))
    place = np.asarray(sensor.pose.position)
    low, high = around[0] - SURROUNDINGS_M, around[1] + SURROUNDINGS_M
    with np.errstate(divide="ignore", invalid="ignore"):
        walls = np.stack([(low - place) / directions, (high - place) / directions])
    enter = np.nanmax(walls.min(axis=0), axis=1)
    leave = np.nanmin(walls.max(axis=0), axis=1)
    return np.where((leave > 0.0) & (leave >= enter), leave, 0.0)

"""Views of sensors with a fan of rays: a picture of range over azimuth, and the field as a mesh."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Flags, Floats
from ..geometry.poses import rotate
from ..scene.rig import Sensor
from .field_of_view import FREE, ViewPatch, grid_faces
from .ray_fan import AngleWindow, RayFan, directions, shape_of

MAX_STEPS = 720
"""Of a patch, along a side."""
PICTURE_ROWS, PICTURE_COLUMNS = 180, 241
"""Ranges and azimuths of a picture; one of the azimuths is the middle."""


@dataclass(frozen=True, slots=True)
class FieldPicture:
    """What a sensor detects of a target by range and azimuth.

    Attributes
    ----------
    values : (R, A) float
        m of the target, farthest range first, leftmost azimuth first; 0 where it is not detected.
    hidden : (R, A) bool
        Whether it would be detected if the vehicle did not hide it.
    ranges, azimuths : (R,) and (A,) float
        Of the target's centre, over the ground [m] and from the sensor's heading [rad], descending.
    height_m : float
        Height of the target's centre above the ground.
    target : str
        What the target is.
    """

    values: Floats
    hidden: Flags
    ranges: Floats
    azimuths: Floats
    height_m: float
    target: str


def field_picture_of(
    sensor: Sensor,
    window: AngleWindow,
    max_range: float,
    target: tuple[str, float],
    measured: Callable[[Floats], tuple[Floats, Floats]],
) -> FieldPicture:
    """Return a picture; `target` is a name and the height of a centre [m].

    `measured` takes centres (N, 3), ground frame, and returns m with the vehicle and without it.
    """
    (right, left), _ = window
    azimuths = left - (np.arange(PICTURE_COLUMNS) + 0.5) * (left - right) / PICTURE_COLUMNS
    step = max_range / PICTURE_ROWS
    ranges = max_range - step * (np.arange(PICTURE_ROWS) + 0.5)
    ahead = sensor.pose.ground_from_sensor[:2, 0]
    heading = math.atan2(float(ahead[1]), float(ahead[0]))
    angles = [(math.cos(heading + a), math.sin(heading + a)) for a in azimuths.tolist()]
    flat = ranges[:, None, None] * np.array(angles)
    x, y, _ = sensor.pose.position
    height = np.full((*flat.shape[:2], 1), target[1])
    centers = np.concatenate([flat + np.array([x, y]), height], axis=-1).reshape(-1, 3)
    seen, free = (m.reshape(PICTURE_ROWS, PICTURE_COLUMNS) for m in measured(centers))
    return FieldPicture(seen, (free > 0.0) & (seen <= 0.0), ranges, azimuths, target[1], target[0])


def patch_of(window: AngleWindow, step: float) -> ViewPatch:
    """Return a window of azimuths and elevations as triangles of about `step` [rad]."""
    (left, right), (low, high) = window
    closed = right - left >= 2.0 * math.pi - 1e-9
    columns = min(max(math.ceil((right - left) / step), 3 if closed else 1), MAX_STEPS)
    rows = min(max(math.ceil((high - low) / step), 1), MAX_STEPS) + 1
    azimuths = np.linspace(left, right, columns + 1)[: columns if closed else None]
    up, across = np.meshgrid(np.linspace(low, high, rows), azimuths, indexing="ij")
    vectors = [np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.sin(up)]
    index = np.arange(up.size).reshape(up.shape)
    return ViewPatch(np.stack(vectors, axis=-1).reshape(-1, 3), grid_faces(index, closed=closed))


def fan_rays(sensor: Sensor, window: AngleWindow, inside: Flags, most: int) -> Floats:
    """Return at most `most` directions (R, 3) of the rays `inside` (E, A), ground frame."""
    rays = directions(window, shape_of(window))[inside.reshape(-1)]
    if len(rays) > most:
        rays = rays[np.linspace(0, len(rays) - 1, most).astype(np.int64)]
    return rotate(sensor.pose.ground_from_sensor, rays)


def free_fan(window: AngleWindow) -> RayFan:
    """Return a fan whose rays are all free."""
    shape = shape_of(window)
    part = np.full(shape, FREE, np.int32)
    return RayFan(window, np.full(shape, np.inf), part, np.zeros(shape))

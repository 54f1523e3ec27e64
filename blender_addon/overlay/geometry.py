"""Beams and frustums as plain arrays: no scene, no GPU. The viewport and the review share them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .beams import Beams
from .colors import VIEWPORT, Palette, Rgba

if TYPE_CHECKING:
    from ..engine import pe

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

FULL_ROOM_SR = 2.4e-3
"""A beam with this solid angle to itself (2 by 4 degrees) is drawn in full colour, closer ones
fainter: dense channels do not become a wall, and sparse ones still show."""
LEAST_SHARE = 0.05
FACE_CORNERS = ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1))
EDGES = ((0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 5))
RING_POINTS, TICK_SHARE = 48, 0.35
"""Corners of a ring, and the length of its tick in units of its radius."""
MARK_GAP, MARK_HEIGHT, MARK_HALF_WIDTH = 0.08, 0.25, 0.2
"""The mark over a picture's upper edge, in units of half the picture's height."""


@dataclass(frozen=True, slots=True)
class Primitives:
    """Lines (two points each) or triangles (three): `points` (P, 3) [m], `colors` (P, 4) sRGB."""

    points: Floats32
    colors: Floats32

    @classmethod
    def empty(cls) -> Primitives:
        """Nothing, in arrays of the right shape."""
        return cls(np.empty((0, 3), np.float32), np.empty((0, 4), np.float32))

    @classmethod
    def joined(cls, several: Sequence[Primitives]) -> Primitives:
        """All of them, drawn in this order."""
        if not several:
            return cls.empty()
        points = np.concatenate([each.points for each in several])
        return cls(points, np.concatenate([each.colors for each in several]))


@dataclass(frozen=True, slots=True)
class OverlayGeometry:
    """What is drawn for one sensor or a whole rig: `lines` and translucent `faces`."""

    lines: Primitives
    faces: Primitives


def beam_lines(
    sensor: pe.Sensor, beams: Beams, length_m: float, palette: Palette = VIEWPORT
) -> Primitives:
    """Lines from the sensor along its beams.

    Free beams end at the range, the ground (z = 0) or `length_m`, and fade to nothing towards
    that length. Stopped ones end on the vehicle and come last: they are drawn over the free ones.
    """
    free, stopped = beams[~beams.stopped], beams[beams.stopped]
    ends = np.minimum(np.minimum(free.ends, length_m), ground_distance(sensor, free.directions))
    share = np.clip(free.room / FULL_ROOM_SR, LEAST_SHARE, 1.0)
    free_lines = _rays(sensor, free.directions, ends, palette.free)
    free_lines.colors[0::2, 3] *= share
    free_lines.colors[1::2, 3] *= share * (1.0 - ends / length_m)
    return Primitives.joined(
        [free_lines, _rays(sensor, stopped.directions, stopped.ends, palette.stopped)]
    )


def ground_distance(sensor: pe.Sensor, directions: Floats) -> Floats:
    """(N,) distance along each direction to z = 0 [m]; inf for a beam that never gets there."""
    height, down = sensor.pose.position[2], -directions[:, 2]
    if height <= 0.0:
        return np.full(len(directions), np.inf)
    distance = np.full(len(directions), np.inf)
    return np.divide(height, down, out=distance, where=down > 0.0)


def frustum_points(sensor: pe.Sensor, length_m: float) -> Floats:
    """(8, 3) pinhole, picture corners and up mark of a camera, ground frame [m].

    Corners: upper left, upper right, lower right, lower left as the camera sees them, `length_m`
    from the pinhole. The mark's left, right and tip follow, above the upper edge.
    """
    camera = sensor.model
    side = np.tan(camera.hfov / 2.0)
    up = side * camera.height / camera.width
    base, tip = up * (1.0 + MARK_GAP), up * (1.0 + MARK_GAP + MARK_HEIGHT)
    mark = up * MARK_HALF_WIDTH
    across = [side, -side, -side, side, mark, -mark, 0.0]
    above = [up, up, -up, -up, base, base, tip]
    points = np.column_stack([np.ones(7), across, above])
    points *= length_m / np.sqrt(1.0 + side**2 + up**2)
    points = np.vstack([np.zeros(3), points])
    return points @ sensor.pose.ground_from_sensor.T + np.asarray(sensor.pose.position)


def frustum_lines(sensor: pe.Sensor, length_m: float, palette: Palette = VIEWPORT) -> Primitives:
    """Edges of a camera's view: pyramid, picture, and a small triangle above that says: up."""
    points = frustum_points(sensor, length_m)[np.array(EDGES).ravel()]
    return _colored(points, palette.camera)


def frustum_faces(sensor: pe.Sensor, length_m: float, palette: Palette = VIEWPORT) -> Primitives:
    """Sides of a camera's view: four triangles from the pinhole."""
    points = frustum_points(sensor, length_m)[np.array(FACE_CORNERS).ravel()]
    return _colored(points, palette.camera_face)


def ring_lines(sensor: pe.Sensor, radius_m: float, palette: Palette = VIEWPORT) -> Primitives:
    """Ring around a sensor in its own level plane, and a tick where it looks ahead."""
    angles = np.linspace(0.0, 2.0 * np.pi, RING_POINTS + 1)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    tick = np.array([[1.0, 0.0, 0.0], [1.0 + TICK_SHARE, 0.0, 0.0]])
    points = np.vstack([np.stack([ring[:-1], ring[1:]], axis=1).reshape(-1, 3), tick]) * radius_m
    points = points @ sensor.pose.ground_from_sensor.T + np.asarray(sensor.pose.position)
    return _colored(points, palette.other)


def _rays(sensor: pe.Sensor, directions: Floats, ends: Floats, color: Rgba) -> Primitives:
    """Lines from the sensor along (N, 3) directions to (N,) ends [m]."""
    points = np.empty((len(ends), 2, 3))
    points[:, 0] = sensor.pose.position
    points[:, 1] = sensor.pose.position + directions * ends[:, None]
    return _colored(points.reshape(-1, 3), color)


def _colored(points: Floats, color: Rgba) -> Primitives:
    return Primitives(points.astype(np.float32), np.tile(np.float32(color), (len(points), 1)))

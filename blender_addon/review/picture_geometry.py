"""Geometry of the review picture: its view, and lines and faces as polygons."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics

Floats = NDArray[np.float64]

AZIMUTH_DEG, ELEVATION_DEG = 33.0, 19.0
"""From the vehicle's front left, slightly above."""
HFOV_DEG = 32.0
DESIGN_HEIGHT = 900
"""Sizes of letters and lines are given for a picture of this height, and scaled to others [px]."""


@dataclass(frozen=True, slots=True)
class Frame:
    """The picture's size, and the part of it that the subject may fill [px, from the top left]."""

    width: int
    height: int
    left: float
    right: float
    top: float
    bottom: float

    @property
    def scale(self) -> float:
        """Scale of the picture relative to its design size."""
        return self.height / DESIGN_HEIGHT

    @property
    def tangent_per_px(self) -> float:
        """Width of a pixel at one metre [m]."""
        return 2.0 * math.tan(math.radians(HFOV_DEG) / 2.0) / self.width


@dataclass(frozen=True, slots=True)
class View:
    """A camera: `position` (3,) [m]; rows of `axes` (3, 3) are right, up and backward in ground."""

    position: Floats
    axes: Floats
    frame: Frame

    @property
    def matrix(self) -> Floats:
        """(4, 4) matrix, ground from camera, for Blender."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.axes.T, self.position
        return matrix

    def depth(self, points: Floats) -> Floats:
        """(N,) distance of points (N, 3) before the camera, along its axis [m]."""
        return -((points - self.position) @ self.axes[2])

    def pixels(self, points: Floats) -> Floats:
        """(N, 2) positions of points (N, 3) in the picture, from its top left [px]."""
        local = (points - self.position) @ self.axes.T
        across = local[:, :2] / -local[:, 2:] / self.frame.tangent_per_px
        return across * [1.0, -1.0] + [self.frame.width / 2, self.frame.height / 2]


def look_at(points: Floats, frame: Frame) -> View:
    """Return the nearest view with all points (N, 3) inside the frame.

    The four sides of that part are planes through the camera; each point bounds them, so the
    distance follows from the extremes without a search.
    """
    axes = _axes()
    local = points @ axes.T
    center = np.array([frame.width, frame.height]) / 2
    low = (np.array([frame.left, frame.height - frame.bottom]) - center) * frame.tangent_per_px
    high = (np.array([frame.right, frame.height - frame.top]) - center) * frame.tangent_per_px
    across, depth = local[:, :2], -local[:, 2:]
    above, below = (across - high * depth).max(axis=0), (low * depth - across).max(axis=0)
    far = np.max((above + below) / (high - low))  # distance of the camera behind depth 0
    middle = (above - high * far - (below + low * far)) / 2.0
    return View(np.array([*middle, far]) @ axes, axes, frame)


def _axes() -> Floats:
    azimuth, elevation = math.radians(AZIMUTH_DEG), math.radians(ELEVATION_DEG)
    level = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    backward = math.cos(elevation) * level + [0.0, 0.0, math.sin(elevation)]
    right = np.array([-level[1], level[0], 0.0])
    return np.array([right, np.cross(backward, right), backward])


FADE_STEPS = 12
"""Pieces of a line whose colour changes along it."""
RING_POINTS = 160


@dataclass(frozen=True, slots=True)
class Faces:
    """Polygons of k corners: `corners` (N, k, 3) [m], `colors` (N, 4) sRGB with alpha."""

    corners: Floats
    colors: Floats


def ribbons(lines: graphics.Primitives, view: View, width_px: float) -> Faces:
    """Lines as strips that face the camera, with the same width at any distance."""
    ends, colors = _fading_pieces(lines)
    along = ends[:, 1] - ends[:, 0]
    side = np.cross(along, ends.mean(axis=1) - view.position)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    width = (
        width_px
        * view.frame.scale
        * view.frame.tangent_per_px
        * view.depth(ends.reshape(-1, 3)).reshape(-1, 2)
    )
    half = side[:, None] * width[..., None] / 2.0
    right, left = ends + half, ends - half  # the winding order makes their front face the camera
    return Faces(np.stack([right[:, 0], left[:, 0], left[:, 1], right[:, 1]], axis=1), colors)


def starting_farther(lines: graphics.Primitives, distance_m: float) -> graphics.Primitives:
    """Lines shortened at their start by a distance; a shorter line has length 0."""
    points = lines.points.reshape(-1, 2, 3).astype(float)
    along = points[:, 1] - points[:, 0]
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    points[:, 0] += along * np.minimum(distance_m / length, 1.0)
    return graphics.Primitives(points.reshape(-1, 3).astype(np.float32), lines.colors)


def triangles(faces: graphics.Primitives) -> Faces:
    """Translucent triangles in the colour of their first corner."""
    return Faces(faces.points.reshape(-1, 3, 3).astype(float), faces.colors[::3].astype(float))


def ground_ring(radius_m: float, color: graphics.Rgba) -> graphics.Primitives:
    """Return a circle on the ground about the origin."""
    angles = np.linspace(0.0, 2.0 * np.pi, RING_POINTS + 1)
    circle = radius_m * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    points = np.stack([circle[:-1], circle[1:]], axis=1).reshape(-1, 3)
    return graphics.Primitives(
        points.astype(np.float32), np.tile(np.asarray(color, np.float32), (len(points), 1))
    )


def _fading_pieces(lines: graphics.Primitives) -> tuple[Floats, Floats]:
    """Cut fading lines into pieces: ends (N, 2, 3) and the mean colour of each (N, 4)."""
    points = lines.points.reshape(-1, 2, 3).astype(float)
    colors = lines.colors.reshape(-1, 2, 4).astype(float)
    fades = (colors[:, 0] != colors[:, 1]).any(axis=1)
    cuts = np.linspace(0.0, 1.0, FADE_STEPS + 1)[:, None, None]
    cut = points[fades, 0] * (1.0 - cuts) + points[fades, 1] * cuts
    pieces = np.stack([cut[:-1], cut[1:]], axis=2).reshape(-1, 2, 3)
    cuts = (cuts[:-1] + cuts[1:]) / 2.0
    tints = (colors[fades, 0] * (1.0 - cuts) + colors[fades, 1] * cuts).reshape(-1, 4)
    return np.concatenate([pieces, points[~fades]]), np.concatenate([tints, colors[~fades, 0]])


def shadow(low: Floats, high: Floats, color: graphics.Rgba, layers: int) -> Faces:
    """Return a soft shadow on the ground under a box: layers of rounded rectangles, growing."""
    angles = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    outline = np.sign(circle) * np.abs(circle) ** 0.45
    center, half = (low + high)[:2] / 2.0, (high - low)[:2] / 2.0
    grown = half - 0.15 + 0.35 * np.linspace(0.0, 1.0, layers)[:, None]
    corners = np.zeros((layers, len(outline), 3))
    corners[:, :, :2] = center + outline * grown[:, None]
    return _in_one_color(corners, color)


def _in_one_color(corners: Floats, color: graphics.Rgba) -> Faces:
    return Faces(corners, np.tile(color, (len(corners), 1)))

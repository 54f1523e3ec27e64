"""Where the picture is taken from: numbers alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
        """How much larger than designed the picture is."""
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
        """(4, 4) ground from camera, as Blender wants it."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.axes.T, self.position
        return matrix

    def depth(self, points: Floats) -> Floats:
        """(N,) distance of points (N, 3) before the camera, along its axis [m]."""
        return -((points - self.position) @ self.axes[2])

    def pixels(self, points: Floats) -> Floats:
        """(N, 2) places of points (N, 3) in the picture, from its top left [px]."""
        local = (points - self.position) @ self.axes.T
        across = local[:, :2] / -local[:, 2:] / self.frame.tangent_per_px
        return across * [1.0, -1.0] + [self.frame.width / 2, self.frame.height / 2]


def look_at(points: Floats, frame: Frame) -> View:
    """Return the nearest view in which all of the points (N, 3) lie in the frame's part.

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
    far = np.max((above + below) / (high - low))  # how far the camera stands behind depth 0
    middle = (above - high * far - (below + low * far)) / 2.0
    return View(np.array([*middle, far]) @ axes, axes, frame)


def _axes() -> Floats:
    azimuth, elevation = math.radians(AZIMUTH_DEG), math.radians(ELEVATION_DEG)
    level = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    backward = math.cos(elevation) * level + [0.0, 0.0, math.sin(elevation)]
    right = np.array([-level[1], level[0], 0.0])
    return np.array([right, np.cross(backward, right), backward])

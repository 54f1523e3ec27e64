"""Where a picture is taken from, and which way each of its places looks."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
RaysThrough = Callable[[Floats, Floats], Floats]
"""Places in the picture, right and down [px], to unit directions (N, 3) in the ground frame; NaN
where nothing is shown."""


@dataclass(frozen=True, eq=False)
class Viewshot:
    """A picture to be taken.

    Attributes
    ----------
    eye : (3,) float
        Ground frame [m].
    width, height : int
        [px]
    look : callable
    pixel_rad : float
        Angle between two pixels about the middle [rad].
    from_sensor : bool
        Whether it is a camera on the vehicle that takes it, and looks through its glass.
    """

    eye: Floats
    width: int
    height: int
    look: RaysThrough
    pixel_rad: float
    from_sensor: bool = False

    def directions(self) -> Floats:
        """(H * W, 3) unit directions through the middles of the pixels, row by row."""
        down, right = np.mgrid[: self.height, : self.width] + 0.5
        return self.look(right.ravel(), down.ravel())


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """A point of view: from where, at what, how wide. Metres and degrees, ground frame."""

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    fov_deg: float = 30.0

    @property
    def axes(self) -> Floats:
        """(3, 3) rows: ahead, right, up."""
        ahead = np.subtract(self.target, self.eye)
        ahead = ahead / math.sqrt(float(ahead @ ahead))
        right = np.array([ahead[1], -ahead[0], 0.0])
        right = right / max(math.sqrt(float(right @ right)), 1e-9)
        return np.stack([ahead, right, np.cross(right, ahead)])

    def shot(self, width: int, height: int) -> Viewshot:
        """Return the picture of that size; the field of view is its width."""
        ahead, right, up = self.axes
        focal = self.focal_px(width)

        def look(across: Floats, down: Floats) -> Floats:
            x, y = (across - width / 2.0) / focal, (height / 2.0 - down) / focal
            rays = ahead + x[:, None] * right + y[:, None] * up
            return rays / np.sqrt((rays * rays).sum(axis=1))[:, None]

        return Viewshot(np.array(self.eye), width, height, look, 1.0 / focal)

    def focal_px(self, width: int) -> float:
        """Focal length of a picture so wide [px]."""
        return width / 2.0 / math.tan(math.radians(self.fov_deg) / 2.0)

    def project(self, points: Floats, width: int, height: int) -> tuple[Floats, Floats]:
        """Places (right, down) [px] of points (N, 3) before the eye; NaN behind it."""
        depth, x, y = self.axes @ (np.asarray(points, float) - np.array(self.eye)).T
        scale = self.focal_px(width) / np.where(depth > 1e-6, depth, np.nan)
        return width / 2.0 + x * scale, height / 2.0 - y * scale

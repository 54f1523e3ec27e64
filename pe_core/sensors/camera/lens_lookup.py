"""Lookup tables of a lens: image positions and pixel density of far voxels.

A lens depends only on the cosine of the angle from its axis. Tables over it need neither an arc
tangent nor a polynomial for each voxel. They are exact to a few parts in ten thousand.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from .lens import Lens
from .lens_models import BrownConrady
from .model import Camera

Array = NDArray[np.floating]

ENTRIES = 1 << 15
BEYOND = 0.12
"""Angle beyond the picture up to which a lens is tabulated [rad]."""
NEAREST_RAD = 0.06
"""Maximum angular radius of a voxel for the tables."""
MEAN_OFF = 0.07
"""A quarter of the mean squared distance of points in a cube's image, as a share of s^2 / r^2."""
ANGLES = 4096
"""Number of angles at which the unevenness of the density is computed."""
BORDER_PLACES = 33
"""Points on each side of the picture, to find the maximum angle from the axis."""


class Imaged(NamedTuple):
    """Voxels through a lens: image position right and down [px], and pixels per steradian.

    `stretch` is the maximum of pixels per radian between the axis and the far side of a voxel.
    `uneven`, times the squared angular width of a voxel [rad^2], bounds how far the density at its
    centre is from the mean over the voxel, relative to that mean.
    """

    right: Array
    down: Array
    density: Array
    stretch: Array
    uneven: Array


class QuickLens:
    """A camera's lens in tables.

    `outer` is the maximum angle from the axis that the picture shows [rad].
    """

    def __init__(self, camera: Camera) -> None:
        lens = self._lens = camera.projection
        self.outer = min(lens.edge, _widest_in(camera))
        last = min(self.outer + BEYOND, math.pi - 1e-3)
        self._per_cosine = (ENTRIES - 1) / (1.0 - math.cos(last))
        cosine = 1.0 - (np.arange(ENTRIES) + 0.5) / self._per_cosine
        theta = np.maximum(np.arccos(np.clip(cosine, -1.0, 1.0)), 1e-6)
        inside, sine = np.minimum(theta, lens.edge), np.sin(theta)
        slope = lens.slope(inside)
        around = (lens.radius(inside) + slope * (theta - inside)) / sine
        most = np.maximum.accumulate(np.maximum(around, slope)) * max(lens.fx, lens.fy)
        farther = np.minimum(theta + NEAREST_RAD, theta[-1])
        self._stretch = (1.1 * np.interp(farther, theta, most)).astype(np.float32)
        self._around = around.astype(np.float32)
        self._density = (lens.fx * lens.fy * around * slope).astype(np.float32)
        self._uneven = np.interp(theta, *_unevenness(lens, last)).astype(np.float32)
        self._tilt = self._tilted(lens, inside) if isinstance(lens, BrownConrady) else None

    def _tilted(self, lens: BrownConrady, theta: Floats) -> Array | None:
        """Density added by the tangential part, per unit of p1 times down plus p2 times right."""
        if not lens.shifts:
            return None
        r = np.tan(theta)
        both = 6.0 * lens.radius(theta) / r + 2.0 * lens.slope(theta) / (1.0 + r * r)
        added = lens.fx * lens.fy * (1.0 + r * r) ** 1.5 * both * r / np.sin(theta)
        return np.asarray(added.astype(np.float32))

    def seen(self, cosine: Array, depth: Array, left: Array, up: Array, per: Array) -> Imaged:
        """Return the images of voxels from the cosine of their angle; `per` is 1 / distance."""
        lens = self._lens
        entry = ((1.0 - cosine) * np.float32(self._per_cosine)).astype(np.int32)
        around = np.take(self._around, entry, mode="clip") * per
        x, y = around * -left, around * -up
        density = np.take(self._density, entry, mode="clip")
        if self._tilt is not None and isinstance(lens, BrownConrady):
            tilt = np.take(self._tilt, entry, mode="clip")
            density -= tilt * per * (np.float32(lens.p1) * up + np.float32(lens.p2) * left)
            dx, dy = _shifts(lens, depth, left, up)
            x, y = x + dx, y + dy
        focal = np.float32(lens.fx), np.float32(lens.fy)
        right, down = np.float32(lens.cx) + focal[0] * x, np.float32(lens.cy) + focal[1] * y
        tables = (self._stretch, self._uneven)
        return Imaged(right, down, density, *(np.take(t, entry, mode="clip") for t in tables))


def _unevenness(lens: Lens, last: float) -> tuple[Floats, Floats]:
    """Angles up to the last, and the curvature of the density near them, relative to the density.

    The mean of the density over the image of a cube differs from the density at its middle by
    about 0.07 (s / r)^2 times the sum of the second derivatives, with the side s and the distance
    r. The largest value counts.
    """
    theta = (np.arange(ANGLES) + 0.5) * (last / ANGLES)
    inside = np.minimum(theta, lens.edge)
    density = lens.radius(inside) * lens.slope(inside) / np.sin(inside)
    first = np.gradient(density, theta)
    bend = np.abs(np.gradient(first, theta)) + np.abs(first / np.tan(inside))
    rate = MEAN_OFF * bend / np.maximum(density, 1e-12 * density.max())
    reach = int(NEAREST_RAD / (last / ANGLES)) + 1
    padded = np.concatenate([rate, np.full(reach, rate[-1])])
    most = np.lib.stride_tricks.sliding_window_view(padded, reach + 1).max(axis=1)
    return theta, most


def _shifts(lens: BrownConrady, depth: Array, left: Array, up: Array) -> tuple[Array, Array]:
    safe = np.maximum(depth, np.float32(1e-3))
    x, y = -left / safe, -up / safe
    square, both = x * x + y * y, np.float32(2.0) * x * y
    p1, p2 = np.float32(lens.p1), np.float32(lens.p2)
    return p1 * both + p2 * (square + 2 * x * x), p1 * (square + 2 * y * y) + p2 * both


def _widest_in(camera: Camera) -> float:
    """Maximum angle from the axis of a point on the border of the picture [rad]."""
    share = np.linspace(0.0, 1.0, BORDER_PLACES)
    none, all_ = np.zeros_like(share), np.ones_like(share)
    right = np.concatenate([share, share, none, all_]) * camera.width
    down = np.concatenate([none, all_, share, share]) * camera.height
    depth = camera.projection.unproject(right, down)[:, 0]
    edge = camera.projection.edge
    angles = np.where(np.isnan(depth), edge, np.arccos(np.clip(depth, -1.0, 1.0)))
    return min(float(angles.max()) + 0.01, edge)

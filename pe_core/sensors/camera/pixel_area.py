"""Pixel area of a cube's image, clipped to the image: exact, and vectorised over voxels.

The image of a cube is the union of its visible faces. There are at most three, and they do not
overlap, so the area of the cube is the sum of their areas. Polygons need not be clipped: by Green's
theorem the area of a face inside the picture is the sum over its edges of the integral of y dx,
with x and y clamped to the picture. The integral of each edge has a closed form.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from .model import Camera
from .tie_rules import IN_FRONT

SensorAxes = tuple[Floats, Floats, Floats]
"""Depth (forward), left and up of points, each (V,) [m]."""

QUAD = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
"""Corners of a face, in order, in half sides along its two axes."""
ROUNDING_PX = 1e-6
"""Areas are sums of terms as large as the picture: a smaller result is only rounding."""


def clipped_pixel_area(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    """(V,) pixels covered by cubes of side `side` [m].

    0 where a corner of the cube is not in front of the camera.

    Parameters
    ----------
    camera : Camera
    axes : (3, 3) float
        Rotation from the camera's frame to the ground frame (`tie_rules.axes_of`).
    offsets : (V, 3) float
        The cubes' centres from the camera, ground axes (`tie_rules.offsets_of`) [m].
    side : float
    """
    depth, left, up = in_sensor_frame(axes, offsets)
    area = np.zeros(len(offsets))
    near = np.flatnonzero(in_view(camera, depth, left, up, side))
    if len(near):
        area[near] = _area_in_view(camera, axes, offsets[near], side)
    return area


def in_sensor_frame(axes: Floats, offsets: Floats) -> SensorAxes:
    """Convert offsets (V, 3) from the ground axes to the camera's axes."""
    x, y, z = (offsets[:, k] for k in range(3))
    depth, left, up = (x * a + y * b + z * c for a, b, c in axes.T)
    return depth, left, up


def frustum_distance(camera: Camera, depth: Floats, left: Floats, up: Floats) -> Floats:
    """Signed distance to the nearest side of the frustum [m]; positive inside."""
    lens = camera.projection
    side = _inside(depth, left, lens.fx, (lens.cx, camera.width - lens.cx))
    top = _inside(depth, up, lens.fy, (lens.cy, camera.height - lens.cy))
    return np.minimum(side, top)


def _inside(depth: Floats, aside: Floats, focal: float, room: tuple[float, float]) -> Floats:
    """Distance to the nearer of two sides, which are `room` [px] from the axis."""
    this, other = room
    if this == other:
        return np.asarray((this * depth - focal * np.abs(aside)) / np.sqrt(this**2 + focal**2))
    near = (this * depth - focal * aside) / np.sqrt(this**2 + focal**2)
    return np.minimum(near, (other * depth + focal * aside) / np.sqrt(other**2 + focal**2))


def in_view(
    camera: Camera, depth: Floats, left: Floats, up: Floats, side: float
) -> NDArray[np.bool_]:
    """Whether cubes may touch the picture; true for every cube that does."""
    radius = side * np.sqrt(3.0) / 2.0
    return (depth > 0.0) & (frustum_distance(camera, depth, left, up) > -radius)


def _area_in_view(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    half = side / 2.0
    reach = half * np.abs(axes[:, 0]).sum() + IN_FRONT * side
    depth, left, up = in_sensor_frame(axes, offsets)
    area = np.zeros(len(offsets))
    for k in range(3):  # row k of the axes: depth, left and up of ground axis k
        toward = -np.sign(offsets[:, k]) * half  # the face on the camera's side
        face = (depth + toward * axes[k, 0], left + toward * axes[k, 1], up + toward * axes[k, 2])
        i, j = (k + 1) % 3, (k + 2) % 3
        corners = [
            _project(camera, face, (a * half) * axes[i] + (b * half) * axes[j]) for a, b in QUAD
        ]
        area += np.where(np.abs(offsets[:, k]) > half, _clipped_quad_area(corners, camera), 0.0)
    return np.where((depth > reach) & (area > ROUNDING_PX), area, 0.0)


def _project(camera: Camera, face: SensorAxes, corner: Floats) -> tuple[Floats, Floats]:
    """Image position [px], right and down, of the faces' corner at (3,) from their centres."""
    depth, left, up = (center + along for center, along in zip(face, corner, strict=True))
    lens, safe = camera.projection, np.where(depth > 0.0, depth, 1.0)
    scale = lens.fx / safe
    high = scale if lens.fx == lens.fy else lens.fy / safe
    return lens.cx - left * scale, lens.cy - up * high


def _clipped_quad_area(corners: list[tuple[Floats, Floats]], camera: Camera) -> Floats:
    total = np.zeros_like(corners[0][0])
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        total += clamped_integral(x0, y0, x1, y1, float(camera.width), float(camera.height))
    return np.abs(total)


def clamped_integral(
    x0: Floats, y0: Floats, x1: Floats, y1: Floats, width: float, height: float
) -> Floats:
    """Integral over an edge of clamp(y, 0, height) dx, for x in [0, width]."""
    run = x1 - x0
    level = run == 0.0
    slope = (y1 - y0) / np.where(level, 1.0, run)
    xa, xb = np.clip(x0, 0.0, width), np.clip(x1, 0.0, width)
    ya, yb = y0 + slope * (xa - x0), y0 + slope * (xb - x0)
    ca, cb = np.clip(ya, 0.0, height), np.clip(yb, 0.0, height)
    # Between ya and yb the clamped line is a ramp with level ends, each weighted by its share of y.
    rise = yb - ya
    flat = np.abs(rise) < 1e-12
    steep = np.where(flat, 1.0, rise)
    ramp = (cb - ca) / steep * (ca + cb) / 2.0
    above = (np.maximum(yb, height) - np.maximum(ya, height)) / steep * height
    mean = np.where(flat, ca, ramp + above)
    return np.where(level, 0.0, mean * (xb - xa))

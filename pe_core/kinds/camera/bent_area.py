"""Pixel area of a cube's image through a lens that bends straight lines: the definition.

As through a pinhole (`camera.area`) the image of a cube is the union of its visible faces. An edge
of a face is taken for PIECES straight ones, whose ends are projected as they are; what of a face
lies in the picture and inside the edge of the field is found by Green's theorem, edge by edge. So
a cube that reaches behind a fisheye's shoulders, or across the edge of its field, counts by the
part that is seen.

Against the sides of cubes in small patches, each projected by itself, areas are within 0.5 %; of
images that the picture or the edge of the field cuts, within 0.1 % of a side of the cube on the
lens's axis besides.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot
from .aperture import aperture_of
from .area import QUAD, ROUNDING_PX, SensorAxes
from .lens import Lens
from .model import Camera

Floats = NDArray[np.float64]
PIECES = 8
"""Straight pieces that an edge of a face is taken for."""
BESIDE_SIDES, BESIDE_PIECES = 4.0, 32
"""Nearer than so many sides, where an edge takes 15 degrees and more, it is taken for so many."""
BALL = math.sqrt(3.0) / 2.0
"""Radius of the ball round a cube, in sides."""
RIGHT_BEHIND = math.pi - 1e-3
"""A cube whose ball reaches the direction opposite to the view has no outline to tell [rad]."""
CUBES_AT_ONCE = 4096


def bent_pixel_area(
    camera: Camera, axes: Floats, offsets: Floats, side: float, pieces: int = PIECES
) -> Floats:
    """(V,) pixels covered by cubes of side `side` [m] through a camera's lens.

    0 where the camera is inside the ball round a cube, or that ball reaches right behind it.

    Parameters
    ----------
    camera : Camera
    axes : (3, 3) float
        Rotation from the camera's frame to the ground frame (`ties.axes_of`).
    offsets : (V, 3) float
        The cubes' centres from the camera, ground axes (`ties.offsets_of`) [m].
    side : float
    pieces : int
        Of an edge; fewer are enough from afar.
    """
    area = np.zeros(len(offsets))
    shown = in_reach(camera.projection, axes, offsets, side)
    beside = dot(offsets, offsets) < (BESIDE_SIDES * side) ** 2
    for which, count in ((shown & beside, max(pieces, BESIDE_PIECES)), (shown & ~beside, pieces)):
        near = np.flatnonzero(which)
        for start in range(0, len(near), CUBES_AT_ONCE):
            some = near[start : start + CUBES_AT_ONCE]
            area[some] = _area(camera, axes, offsets[some], side, count)
    return area


def in_reach(lens: Lens, axes: Floats, offsets: Floats, side: float) -> NDArray[np.bool_]:
    """Whether cubes may be seen by the angle from the axis; never false for one that is."""
    distance = np.sqrt(dot(offsets, offsets))
    outside = distance > BALL * side
    safe = np.where(outside, distance, 1.0)
    theta = np.arccos(np.clip(dot(offsets, axes[:, 0]) / safe, -1.0, 1.0))
    half = np.arcsin(np.minimum(BALL * side / safe, 1.0))
    return outside & (theta - half < lens.edge) & (theta + half < RIGHT_BEHIND)


def _area(camera: Camera, axes: Floats, offsets: Floats, side: float, pieces: int) -> Floats:
    half, aperture = side / 2.0, aperture_of(camera)
    area = np.zeros(len(offsets))
    for k in range(3):
        toward = -np.sign(offsets[:, k]) * half  # the face on the camera's side
        face = offsets.copy()
        face[:, k] += toward
        outline = _outline(k, half, pieces)
        points = face[:, None, :] + outline[None]
        places = camera.projection.project(*_seen(points, axes))
        area += np.where(np.abs(offsets[:, k]) > half, aperture.area(places), 0.0)
    return np.where(area > ROUNDING_PX, area, 0.0)


def _outline(axis: int, half: float, pieces: int) -> Floats:
    """(4 pieces, 3) points round a face across an axis, from its centre."""
    share = np.arange(pieces) / pieces
    points = np.zeros((4, pieces, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    for n, ((a0, b0), (a1, b1)) in enumerate(zip(QUAD, QUAD[1:] + QUAD[:1], strict=True)):
        points[n, :, i] = (a0 + (a1 - a0) * share) * half
        points[n, :, j] = (b0 + (b1 - b0) * share) * half
    return points.reshape(-1, 3)


def _seen(points: Floats, axes: Floats) -> SensorAxes:
    """Points (..., 3), ground axes, as the camera sees them."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    depth, left, up = (x * a[0] + y * a[1] + z * a[2] for a in axes.T)
    return depth, left, up

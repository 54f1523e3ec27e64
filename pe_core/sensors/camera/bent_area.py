"""Pixel area of a cube's image through a lens with distortion: the definition.

The image of a cube is the union of its visible faces. Each edge of a face is split into PIECES
straight pieces, and the ends of the pieces are projected. The aperture is the picture, cut by the
edge of the lens's field. The part of a face inside the aperture follows from Green's theorem, edge
by edge. A cube that is partly outside the field counts by its visible part.

The reference are cubes whose faces are split into small patches. Areas differ from it by at most
0.5 %. Images that the aperture cuts may differ by another 0.1 % of the area of a face on the lens's
axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from ...geometry.poses import dot
from .lens import Lens
from .model import Camera
from .pixel_area import QUAD, ROUNDING_PX, SensorAxes, clamped_integral

ImagePoints = tuple[Floats, Floats]
"""Image positions, right and down [px]."""


@dataclass(frozen=True)
class Aperture:
    """A picture of `width` by `height` [px] that lies inside the lens's field."""

    width: float
    height: float

    def area(self, places: ImagePoints) -> Floats:
        """Area (V,) inside the picture of outlines with corners (V, N) each."""
        x0, y0 = places
        x1, y1 = _next(places)
        parts = clamped_integral(x0, y0, x1, y1, self.width, self.height)
        return np.asarray(np.abs(parts.sum(axis=1)))


@dataclass(frozen=True)
class RoundAperture(Aperture):
    """A picture cut by the edge of the field, an ellipse of half axes `wide` and `high` [px].

    Tangential distortion shifts the ellipse, differently on each side of the picture. An outline
    is cut by the ellipse with the shift at the outline.
    """

    lens: Lens
    wide: float
    high: float

    def area(self, places: ImagePoints) -> Floats:
        """Area (V,) inside picture and ellipse of outlines with corners (V, N) each.

        Parts outside the picture are first moved onto its border, where they have no area.
        """
        x, y = places
        inside = ((x >= 0.0) & (x <= self.width) & (y >= 0.0) & (y <= self.height)).all(axis=1)
        area, centers = np.empty(len(x)), self._centers(places)
        for some, folds in ((inside, False), (~inside, True)):
            held = x[some], y[some]
            area[some] = self._in_ellipse(self._folded(held) if folds else held, centers[some])
        return area

    def _centers(self, places: ImagePoints) -> Floats:
        """(V, 2) centres of the ellipse with the shift at each outline [px]."""
        lens = self.lens
        centers = np.broadcast_to([lens.cx, lens.cy], (len(places[0]), 2))
        if not lens.shifts:
            return centers
        x, y = (
            (w.mean(axis=1) - c) / f
            for w, c, f in zip(places, (lens.cx, lens.cy), (lens.fx, lens.fy), strict=True)
        )
        away = np.maximum(np.hypot(x, y), 1e-12)
        moved = lens.shift(np.full(len(x), lens.edge), x / away, y / away)
        return centers + np.stack(moved, axis=1) * (lens.fx, lens.fy)

    def _in_ellipse(self, places: ImagePoints, centers: Floats) -> Floats:
        (x, y), (cx, cy) = places, centers.T[..., None]
        circle = _area_in_circle(((x - cx) / self.wide, (y - cy) / self.high))
        return circle * (self.wide * self.high)

    def _folded(self, places: ImagePoints) -> ImagePoints:
        """Outlines clamped to the picture, with corners where they cross its sides: (V, 5 N)."""
        starts, ends, shares = places, _next(places), [np.zeros_like(places[0])]
        for a, b, most in zip(starts, ends, (self.width, self.height), strict=True):
            run = np.where(a == b, np.inf, b - a)
            shares += [np.clip((side - a) / run, 0.0, 1.0) for side in (0.0, most)]
        share = np.sort(np.stack(shares, axis=2), axis=2)
        x, y = (
            np.clip(a[..., None] + (b - a)[..., None] * share, 0.0, most).reshape(
                len(a), 5 * a.shape[1]
            )
            for a, b, most in zip(starts, ends, (self.width, self.height), strict=True)
        )
        return x, y


def aperture_of(camera: Camera) -> Aperture:
    """Return the part of a camera's image that counts."""
    lens, (width, height) = camera.projection, (float(camera.width), float(camera.height))
    reach = float(lens.radius(np.asarray(lens.edge)))
    wide, high = lens.fx * reach, lens.fy * reach
    x, y = max(lens.cx, width - lens.cx), max(lens.cy, height - lens.cy)
    if (x / wide) ** 2 + (y / high) ** 2 <= 1.0:
        return Aperture(width, height)
    return RoundAperture(width, height, lens, wide, high)


def _next(places: ImagePoints) -> ImagePoints:
    """The next corner of each corner."""
    x, y = places
    return np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)


def _area_in_circle(places: ImagePoints) -> Floats:
    """Area (V,) inside the unit circle, of outlines with corners (V, N) each.

    Sums over the edges the triangle of edge and centre, cut by the circle: a sector where the edge
    is outside the circle, a triangle where it is inside.
    """
    a, b = places, _next(places)
    step = b[0] - a[0], b[1] - a[1]
    length = np.maximum(step[0] ** 2 + step[1] ** 2, 1e-300)
    along = a[0] * step[0] + a[1] * step[1]
    root = along**2 - length * (a[0] ** 2 + a[1] ** 2 - 1.0)
    half = np.sqrt(np.maximum(root, 0.0))
    enter, leave = (np.clip((-along + s * half) / length, 0.0, 1.0) for s in (-1.0, 1.0))
    p = a[0] + enter * step[0], a[1] + enter * step[1]
    q = a[0] + leave * step[0], a[1] + leave * step[1]
    twice = _angle(a, p) + (p[0] * q[1] - p[1] * q[0]) + _angle(q, b)
    return np.asarray(np.abs(twice.sum(axis=1)) / 2.0)


def _angle(a: ImagePoints, b: ImagePoints) -> Floats:
    """Angle from one direction to another [rad]."""
    return np.asarray(np.arctan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]))


PIECES = 8
"""Straight pieces of an edge of a face."""
BESIDE_SIDES, BESIDE_PIECES = 4.0, 32
"""Nearer than this many sides an edge covers 15 degrees and more: it has this many pieces."""
BALL = math.sqrt(3.0) / 2.0
"""Radius of the ball round a cube, in sides."""
RIGHT_BEHIND = math.pi - 1e-3
"""A cube whose ball reaches the direction opposite to the view has no outline [rad]."""
CUBES_AT_ONCE = 4096


def bent_pixel_area(
    camera: Camera, axes: Floats, offsets: Floats, side: float, pieces: int = PIECES
) -> Floats:
    """(V,) pixels covered by cubes of side `side` [m] through a camera's lens.

    0 where the camera is inside the ball round a cube, or the ball reaches the direction opposite
    to the view. Parameters are those of `clipped_pixel_area`, and `pieces` of an edge: fewer are
    enough for distant cubes.
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
    """Whether cubes may be visible, by their angle from the axis; true for every visible cube."""
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
        toward = -np.sign(offsets[:, k]) * half  # the face that faces the camera
        face = offsets.copy()
        face[:, k] += toward
        outline = _outline(k, half, pieces)
        points = face[:, None, :] + outline[None]
        places = camera.projection.project(*_seen(points, axes))
        area += np.where(np.abs(offsets[:, k]) > half, aperture.area(places), 0.0)
    return np.where(area > ROUNDING_PX, area, 0.0)


def _outline(axis: int, half: float, pieces: int) -> Floats:
    """(4 pieces, 3) points on the border of a face, normal along `axis`, from its centre."""
    share = np.arange(pieces) / pieces
    points = np.zeros((4, pieces, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    for n, ((a0, b0), (a1, b1)) in enumerate(zip(QUAD, QUAD[1:] + QUAD[:1], strict=True)):
        points[n, :, i] = (a0 + (a1 - a0) * share) * half
        points[n, :, j] = (b0 + (b1 - b0) * share) * half
    return points.reshape(-1, 3)


def _seen(points: Floats, axes: Floats) -> SensorAxes:
    """Points (..., 3) along ground axes, converted to the camera's axes."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    depth, left, up = (x * a[0] + y * a[1] + z * a[2] for a in axes.T)
    return depth, left, up

"""What of an image counts: what is inside the picture, and inside the edge of the lens's field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .area import clamped_integral
from .lens import Lens
from .model import Camera

Floats = NDArray[np.float64]
ImagePoints = tuple[Floats, Floats]
"""Image positions, right and down [px]."""


@dataclass(frozen=True)
class Aperture:
    """A picture of `width` by `height` [px], all of which is inside the field."""

    width: float
    height: float

    def area(self, places: ImagePoints) -> Floats:
        """Area (V,) inside, of outlines with corners (V, N) each."""
        x0, y0 = places
        x1, y1 = _next(places)
        parts = clamped_integral(x0, y0, x1, y1, self.width, self.height)
        return np.asarray(np.abs(parts.sum(axis=1)))


@dataclass(frozen=True)
class RoundAperture(Aperture):
    """A picture that the edge of the field runs through: an ellipse of half axes `wide`, `high`.

    A lens that shifts its image moves the ellipse, by another way on each side: an outline is cut
    by the ellipse as it is moved where the outline is.
    """

    lens: Lens
    wide: float
    high: float

    def area(self, places: ImagePoints) -> Floats:
        """Area (V,) inside both, of outlines with corners (V, N) each.

        What sticks out of the picture is first folded flat onto its border.
        """
        x, y = places
        inside = ((x >= 0.0) & (x <= self.width) & (y >= 0.0) & (y <= self.height)).all(axis=1)
        area, centers = np.empty(len(x)), self._centers(places)
        for some, folds in ((inside, False), (~inside, True)):
            held = x[some], y[some]
            area[some] = self._in_ellipse(self._folded(held) if folds else held, centers[some])
        return area

    def _centers(self, places: ImagePoints) -> Floats:
        """(V, 2) middles of the ellipse, as moved on the side that outlines are on."""
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
        """Outlines held inside the picture, with corners where they cross its sides: (V, 5 N)."""
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
    """Return what of a camera's image counts."""
    lens, (width, height) = camera.projection, (float(camera.width), float(camera.height))
    reach = float(lens.radius(np.asarray(lens.edge)))
    wide, high = lens.fx * reach, lens.fy * reach
    x, y = max(lens.cx, width - lens.cx), max(lens.cy, height - lens.cy)
    if (x / wide) ** 2 + (y / high) ** 2 <= 1.0:
        return Aperture(width, height)
    return RoundAperture(width, height, lens, wide, high)


def _next(places: ImagePoints) -> ImagePoints:
    """The corners that follow."""
    x, y = places
    return np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)


def _area_in_circle(places: ImagePoints) -> Floats:
    """Area (V,) inside the unit circle, of outlines with corners (V, N) each.

    The sum over edges of the triangle with the centre, cut by the circle: a sector where the edge
    is outside, a triangle where it is inside.
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

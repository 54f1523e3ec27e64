"""Bins of directions: a raster on one face of the cube round a sensor, and what shows in it.

On a face a direction is (1, u, v): the depth along the face's axis, and the other two coordinates
over it. The raster is where the mesh can be seen, so from afar it is small; it is cut into
`count` by `count` bins, rows along u, and a row's bins along v.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .numbering import count_up

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Spans = tuple[Floats, Floats]
"""Least and greatest of something, each (G,)."""

MARGIN = 1e-9
"""What may be seen is taken this much wider in u and v, against rounding."""
BOX_MARGIN = 2e-9
"""The same of boxes, so that a box shows wherever what is in it does."""
SIDE_MARGIN = 1e-11
"""Rounding of a plane through two corners, over the square of the farthest corner's distance."""


@dataclass(frozen=True, slots=True)
class CubeFace:
    """A face of the cube: axes of depth, u and v; `sign` is -1 where depth runs against its own."""

    axes: tuple[int, int, int]
    sign: float

    def split(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Depth, and the coordinates along u and v, of points (3, ...)."""
        depth, u, v = (points[axis] for axis in self.axes)
        return depth if self.sign > 0.0 else -depth, u, v


FACES = tuple(
    CubeFace((a, (a + 1) % 3, (a + 2) % 3), sign) for a in range(3) for sign in (1.0, -1.0)
)
"""Faces towards +x, -x, +y, -y, +z, -z."""


@dataclass(frozen=True, slots=True)
class Raster:
    """Bins over ``u[0] <= u <= u[1], v[0] <= v <= v[1]``, `count` along each side."""

    u: tuple[float, float]
    v: tuple[float, float]
    count: int

    def rows(self, u: Floats) -> NDArray[np.int32]:
        """Row of bins; what is outside goes to the nearest."""
        return _bins(u, self.u, self.count)

    def columns(self, v: Floats) -> NDArray[np.int32]:
        """Bin within a row; what is outside goes to the nearest."""
        return _bins(v, self.v, self.count)

    def touches(self, u: Spans, v: Spans) -> NDArray[np.bool_]:
        """Whether rectangles reach into the raster."""
        inside = (u[0] <= self.u[1]) & (u[1] >= self.u[0])
        inside &= (v[0] <= self.v[1]) & (v[1] >= self.v[0])
        return inside

    def ends_of_rows(self, rows: NDArray) -> Spans:
        """Least and greatest u of what is put in rows."""
        step = (self.u[1] - self.u[0]) / self.count
        low = self.u[0] + rows * step
        return low - MARGIN, low + (step + MARGIN)


def _bins(w: Floats, ends: tuple[float, float], count: int) -> NDArray[np.int32]:
    scale = count / max(ends[1] - ends[0], MARGIN)
    bins = (w - ends[0]) * scale
    np.maximum(bins, 0.0, out=bins)
    np.minimum(bins, count - 1, out=bins)
    return bins.astype(np.int32)


def spans_of_boxes(near: Floats, far: Floats, low: Floats, high: Floats) -> Spans:
    """Where boxes ``near <= depth <= far, low <= w <= high`` lie in w / depth, clipped to -1..1."""
    front = near > 0.0
    first, last = np.where(front, near, 1.0), np.where(far > 0.0, far, 1.0)
    least = np.where(low >= 0.0, low / last, np.where(front, low / first, -1.0))
    most = np.where(high <= 0.0, high / last, np.where(front, high / first, 1.0))
    return np.maximum(least - BOX_MARGIN, -1.0), np.minimum(most + BOX_MARGIN, 1.0)


def spans_of_triangles(depth: Floats, w: Floats) -> Spans:
    """Where triangles of corners (3, G) lie in w / depth, clipped to -1..1.

    Where a corner is behind, the part in front is bounded by its farthest depth: a surface that
    lies wholly to one side stays on that side.
    """
    least, most, farthest = least_of(w), greatest_of(w), greatest_of(depth)
    farthest = np.where(farthest > 0.0, farthest, 1.0)
    behind = least_of(depth) <= 0.0
    ratio = w / np.where(depth > 0.0, depth, 1.0)
    low = np.where(behind, np.where(least > 0.0, least / farthest, -1.0), least_of(ratio))
    high = np.where(behind, np.where(most < 0.0, most / farthest, 1.0), greatest_of(ratio))
    return np.maximum(low - MARGIN, -1.0), np.minimum(high + MARGIN, 1.0)


def least_of(corners: Floats) -> Floats:
    """Least of three corners (3, G); three times as fast as ``min(axis=0)``."""
    return np.minimum(np.minimum(corners[0], corners[1]), corners[2])


def greatest_of(corners: Floats) -> Floats:
    """Greatest of three corners (3, G)."""
    return np.maximum(np.maximum(corners[0], corners[1]), corners[2])


@dataclass(frozen=True, slots=True)
class RowSpans:
    """Runs of bins: `item` (R,) shows in `row` (R,) from bin `first` to bin `last` (R,)."""

    item: Ints
    row: Ints
    first: Ints
    last: Ints


TALL = 2
"""From so many rows on, a shape's sides are asked where they cross each row."""


def row_spans(
    raster: Raster,
    within: tuple[Spans, Spans],
    sides: list[Floats],
    reach: Floats,
    cut: NDArray[np.bool_],
) -> RowSpans:
    """Bins of a raster that convex shapes may show in.

    Parameters
    ----------
    raster : Raster
    within : (u, v) spans
        Rectangles (G,) that the shapes lie in.
    sides : list of (3, G) float
        A shape is where ``side . (1, u, v) >= 0`` for all its sides; a side of zeros says nothing.
    reach : (G,) float
        Square of the farthest corner's distance [m^2], the measure of the sides' rounding.
    cut : (G,) bool
        Which shapes are worth asking where their sides run; the others get their rectangles.
    """
    u, v = within
    top, bottom = raster.rows(u[0]).astype(np.int64), raster.rows(u[1]).astype(np.int64)
    left, right = raster.columns(v[0]).astype(np.int64), raster.columns(v[1]).astype(np.int64)
    n = bottom - top + 1
    item = np.repeat(np.arange(len(n)), n)
    row = top[item] + count_up(n)
    first, last = left[item], right[item]
    shaped = np.flatnonzero(((n > TALL) & cut & (left < right))[item])
    if len(shaped):
        some = item[shaped]
        low, high = _crossed(raster, row[shaped], some, sides, reach)
        low, high = np.maximum(low, v[0][some]), np.minimum(high, v[1][some])
        first[shaped] = raster.columns(low)
        last[shaped] = np.where(low > high, -1, raster.columns(high))
    shown = np.flatnonzero(first <= last)
    return RowSpans(item[shown], row[shown], first[shown], last[shown])


def _crossed(raster: Raster, row: Ints, item: Ints, sides: list[Floats], reach: Floats) -> Spans:
    """Least and greatest v that shapes have within rows."""
    u0, u1 = raster.ends_of_rows(row)
    low, high = np.full(len(row), -2.0), np.full(len(row), 2.0)
    slack = (reach * SIDE_MARGIN)[item]
    for side in sides:
        a, b, c = side[:, item]
        most = a + np.maximum(b * u0, b * u1) + slack
        steep = np.abs(c) > slack
        bound = -most / np.where(steep, c, 1.0)
        np.maximum(low, bound, out=low, where=steep & (c > 0.0))
        np.minimum(high, bound, out=high, where=steep & (c < 0.0))
    return low - MARGIN, high + MARGIN

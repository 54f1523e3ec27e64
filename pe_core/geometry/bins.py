"""Bins of directions: a raster on one face of a cube round a sensor, and projections onto it.

On a face a direction is (1, u, v): the other two coordinates are divided by the depth, which is the
coordinate along the face's axis. The raster covers the directions of the mesh only. It has `count`
by `count` bins: the rows follow one another along u, the bins of a row along v.

Index arrays are ranges counted up side by side, or cut into blocks.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints

Spans = tuple[Floats, Floats]
"""Minimum and maximum of a coordinate of G shapes, each (G,)."""
MARGIN = 1e-9  # Projections are enlarged by this in u and v, against rounding errors
BOX_MARGIN = 2e-9
"""The same for boxes; larger, so that the projection of a box contains that of its content."""
SIDE_MARGIN = 1e-11
"""Rounding error of a plane through two corners, relative to the farthest corner's distance^2."""
TALL = 2  # Shapes over more rows than this are cut row by row along their sides


def count_up(counts: Ints) -> Ints:
    """Return ``0 .. c0 - 1, 0 .. c1 - 1, ...`` in one array."""
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    return np.arange(total) - np.repeat(ends - counts, counts)


def stable_order(keys: Ints) -> Ints:
    """Return the stable order of keys in 0 .. 2^32 - 1; NumPy's radix sort wants 16-bit keys."""
    order = np.argsort(keys.astype(np.uint16), kind="stable")
    return order[np.argsort((keys >> 16).astype(np.uint16)[order], kind="stable")]


def blocks(total: int, size: int) -> Iterator[slice]:
    """Yield slices of at most `size` that cover ``range(total)``: blocks that fit the cache."""
    for start in range(0, total, size):
        yield slice(start, min(start + size, total))


@dataclass(frozen=True, slots=True)
class CubeFace:
    """A face of the cube: axes of depth, u and v; `sign` is -1 if depth is along -axis."""

    axes: tuple[int, int, int]
    sign: float

    def split(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return depth, and the coordinates along u and v, of points (3, ...), each (...)."""
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
        """Return the row of bins for each u; values outside get the nearest row."""
        return _bins(u, self.u, self.count)

    def columns(self, v: Floats) -> NDArray[np.int32]:
        """Return the bin within its row for each v; values outside get the nearest bin."""
        return _bins(v, self.v, self.count)

    def touches(self, u: Spans, v: Spans) -> NDArray[np.bool_]:
        """Whether each rectangle (G,) overlaps the raster."""
        inside = (u[0] <= self.u[1]) & (u[1] >= self.u[0])
        inside &= (v[0] <= self.v[1]) & (v[1] >= self.v[0])
        return inside


def _bins(w: Floats, ends: tuple[float, float], count: int) -> NDArray[np.int32]:
    scale = count / max(ends[1] - ends[0], MARGIN)
    bins = (w - ends[0]) * scale
    np.maximum(bins, 0.0, out=bins)
    np.minimum(bins, count - 1, out=bins)
    return bins.astype(np.int32)


def spans_of_boxes(near: Floats, far: Floats, low: Floats, high: Floats) -> Spans:
    """Range of w / depth in boxes ``near <= depth <= far, low <= w <= high``, clipped to -1..1."""
    front = near > 0.0
    min_depth = np.where(front, near, 1.0)
    max_depth = np.where(far > 0.0, far, 1.0)
    minimum = np.where(low >= 0.0, low / max_depth, np.where(front, low / min_depth, -1.0))
    maximum = np.where(high <= 0.0, high / max_depth, np.where(front, high / min_depth, 1.0))
    return np.maximum(minimum - BOX_MARGIN, -1.0), np.minimum(maximum + BOX_MARGIN, 1.0)


def spans_of_triangles(depth: Floats, w: Floats) -> Spans:
    """Range of w / depth in triangles with corners (3, G), clipped to -1..1. If a corner is behind
    the sensor, the maximum depth bounds the part in front: a triangle with w > 0 at all corners
    keeps a positive range, and the same holds for w < 0."""
    minimum = corner_min(w)
    maximum = corner_max(w)
    farthest = corner_max(depth)
    farthest = np.where(farthest > 0.0, farthest, 1.0)
    behind = corner_min(depth) <= 0.0
    ratio = w / np.where(depth > 0.0, depth, 1.0)
    low = np.where(behind, np.where(minimum > 0.0, minimum / farthest, -1.0), corner_min(ratio))
    high = np.where(behind, np.where(maximum < 0.0, maximum / farthest, 1.0), corner_max(ratio))
    return np.maximum(low - MARGIN, -1.0), np.minimum(high + MARGIN, 1.0)


def corner_min(corners: Floats) -> Floats:
    """Minimum over three corners (3, G); three times as fast as ``min(axis=0)``."""
    return np.minimum(np.minimum(corners[0], corners[1]), corners[2])


def corner_max(corners: Floats) -> Floats:
    """Maximum over three corners (3, G)."""
    return np.maximum(np.maximum(corners[0], corners[1]), corners[2])


@dataclass(frozen=True, slots=True)
class RowSpans:
    """Runs of bins: shape `item` (R,) may cover the bins `first` to `last` (R,) of `row` (R,)."""

    item: Ints
    row: Ints
    first: Ints
    last: Ints


def row_spans(
    raster: Raster,
    within: tuple[Spans, Spans],
    sides: list[Floats],
    reach: Floats,
    cut: NDArray[np.bool_],
) -> RowSpans:
    """Return the bins of a raster that convex shapes may cover.

    `within` are bounding rectangles (G,) along u and v. A shape is the set ``side . (1, u, v) >=
    0`` for all its `sides` (3, G); zeros are no condition. `reach` (G,) is the square of the
    farthest corner's distance [m^2]: scale of the sides' rounding errors. Shapes in `cut` (G,) are
    cut along their sides; the others get their whole rectangles.
    """
    u, v = within
    top = raster.rows(u[0]).astype(np.int64)
    bottom = raster.rows(u[1]).astype(np.int64)
    left = raster.columns(v[0]).astype(np.int64)
    right = raster.columns(v[1]).astype(np.int64)
    n = bottom - top + 1
    item = np.repeat(np.arange(len(n)), n)
    row = top[item] + count_up(n)
    first = left[item]
    last = right[item]
    cut_runs = np.flatnonzero(((n > TALL) & cut & (left < right))[item])
    if len(cut_runs):
        cut_item = item[cut_runs]
        low, high = _crossed(raster, row[cut_runs], cut_item, sides, reach=reach)
        low = np.maximum(low, v[0][cut_item])
        high = np.minimum(high, v[1][cut_item])
        first[cut_runs] = raster.columns(low)
        last[cut_runs] = np.where(low > high, -1, raster.columns(high))
    not_empty = np.flatnonzero(first <= last)
    return RowSpans(item[not_empty], row[not_empty], first[not_empty], last[not_empty])


def _crossed(raster: Raster, row: Ints, item: Ints, sides: list[Floats], reach: Floats) -> Spans:
    """Minimum and maximum v of shapes within rows."""
    step = (raster.u[1] - raster.u[0]) / raster.count
    u0 = raster.u[0] + row * step
    u1 = u0 + (step + MARGIN)
    u0 = u0 - MARGIN
    low = np.full(len(row), -2.0)
    high = np.full(len(row), 2.0)
    slack = (reach * SIDE_MARGIN)[item]
    for side in sides:
        a, b, c = side[:, item]
        side_max = a + np.maximum(b * u0, b * u1) + slack
        steep = np.abs(c) > slack
        bound = -side_max / np.where(steep, c, 1.0)
        np.maximum(low, bound, out=low, where=steep & (c > 0.0))
        np.minimum(high, bound, out=high, where=steep & (c < 0.0))
    return low - MARGIN, high + MARGIN

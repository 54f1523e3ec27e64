"""Which parts of a camera's picture the vehicle may hide: a coarse map, never too small."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...scene.bins import Raster, greatest_of, least_of, spans_of_triangles
from ...scene.geometry import rotate
from ...scene.numbering import count_up
from .model import Camera

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Extent = tuple[Ints, Ints]
"""First and last bin of triangles along one coordinate."""

CELLS = 64
"""Bins along a side of the map."""
MAP = Raster((-1.0, 1.0), (-1.0, 1.0), CELLS)

ROOM_PX = 1e-3
"""Rectangles are taken this much larger, against rounding."""
BORDER = 1.05
"""The map reaches this far beyond the picture's edges, for voxels that only touch the picture."""


class ShadowMap:
    """Bins of a picture, CELLS by CELLS, that a triangle may touch.

    Parameters
    ----------
    camera : Camera
    axes : (3, 3) float
        Rotation from the camera's frame to the ground frame (`ties.axes_of`).
    triangles : (F, 3, 3) float
        Corners relative to the camera, ground axes [m].
    """

    def __init__(self, camera: Camera, axes: Floats, triangles: Floats) -> None:
        self._lens = lens = camera.projection
        width, height = camera.width, camera.height
        self._wide = BORDER * (2.0 * max(lens.cx, width - lens.cx)) / 2.0 / lens.fx
        self._high = BORDER * (2.0 * max(lens.cy, height - lens.cy)) / 2.0 / lens.fy
        corners = rotate(axes.T, triangles).transpose(2, 1, 0)
        depth, left, up = np.ascontiguousarray(corners)
        (i0, i1), (j0, j1) = _bins(depth, left / self._wide, up / self._high)
        high = j1 - j0 + 1
        n = (i1 - i0 + 1) * high
        step, rows = count_up(n), np.repeat(high, n)
        row = step // rows
        self._hit = np.zeros(CELLS * CELLS, bool)
        bins = (np.repeat(i0, n) + row) * CELLS + np.repeat(j0, n) + (step - row * rows)
        self._hit[bins] = True
        self.empty = not len(bins)

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and greatest left / depth, and up / depth, of the bins that may be touched."""
        hit = self._hit.reshape(CELLS, CELLS)
        ends = (np.flatnonzero(hit.any(axis=axis))[[0, -1]] for axis in (1, 0))
        (i0, i1), (j0, j1) = ((a * 2.0 / CELLS - 1.0, (b + 1) * 2.0 / CELLS - 1.0) for a, b in ends)
        return (i0 * self._wide, i1 * self._wide), (j0 * self._high, j1 * self._high)

    def may_hide(self, depth: Floats, left: Floats, up: Floats) -> NDArray[np.bool_]:
        """Whether the vehicle may stand in the way of points in front of the camera, each (V,)."""
        u = left / (depth * self._wide)
        v = up / (depth * self._high)
        bins = self._bin(u) * CELLS + self._bin(v)
        outside = np.maximum(np.abs(u), np.abs(v)) > 1.0
        return self._hit[bins] | outside

    def may_hide_in(self, low: Floats, high: Floats) -> NDArray[np.bool_]:
        """Whether the vehicle may show in upright rectangles of the picture, corners (V, 2) [px].

        Right and down; False of those without places.
        """
        shown = (low <= high).all(axis=1)
        ends = np.where(shown[:, None], low, 0.0), np.where(shown[:, None], high, 0.0)
        (x0, y0), (x1, y1) = (
            (p + room).T for p, room in zip(ends, (-ROOM_PX, ROOM_PX), strict=True)
        )
        lens = self._lens
        i0, i1 = (self._bin((lens.cx - x) / lens.fx / self._wide) for x in (x1, x0))
        j0, j1 = (self._bin((lens.cy - y) / lens.fy / self._high) for y in (y1, y0))
        sums = np.zeros((CELLS + 1, CELLS + 1), np.int32)
        sums[1:, 1:] = self._hit.reshape(CELLS, CELLS).cumsum(axis=0).cumsum(axis=1)
        inside = sums[i1 + 1, j1 + 1] - sums[i0, j1 + 1] - sums[i1 + 1, j0] + sums[i0, j0]
        return shown & (inside > 0)

    @staticmethod
    def _bin(u: Floats) -> NDArray[np.int32]:
        return np.clip((u + 1.0) * (CELLS / 2), 0, CELLS - 1).astype(np.int32)


def _bins(depth: Floats, u: Floats, v: Floats) -> tuple[Extent, Extent]:
    """First and last bin along u and v of triangles, of corners (3, F), that may show in the map.

    Never fewer bins than a triangle touches.
    """
    index = np.flatnonzero(_may_be_seen(depth, u, v))
    depth = depth[:, index]
    i0, i1 = (MAP.rows(w).astype(np.int64) for w in spans_of_triangles(depth, u[:, index]))
    j0, j1 = (MAP.columns(w).astype(np.int64) for w in spans_of_triangles(depth, v[:, index]))
    return (i0, i1), (j0, j1)


def _may_be_seen(depth: Floats, u: Floats, v: Floats) -> NDArray[np.bool_]:
    """Whether no side of the map's pyramid has all three corners (3, F) outside."""
    seen: NDArray[np.bool_] = greatest_of(depth) > 0.0
    for w in (u, v):
        seen &= (least_of(w - depth) <= 0.0) & (greatest_of(w + depth) >= 0.0)
    return seen

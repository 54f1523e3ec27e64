"""First hits as they were found before meshes had trees: bins of 64 by 64, kept for tests alone."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pe_core.geometry.poses import cross, dot

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Window = tuple[Ints, Ints]

CELLS = 64
"""Bins along a side of a cube face: 6 * 64**2 fits 16 bits, which NumPy sorts by radix."""
CELL_MARGIN = 1e-9
"""Bins are widened by this (in units of a face's half side) against rounding."""
PAIRS_AT_ONCE = 1 << 15
FIRST_LOOK = 4
"""Triangles a ray is tested against before it is asked whether to go on; doubled each time."""


@dataclass(frozen=True, slots=True)
class Hits:
    """First hits of B rays: `distance` (B,) [m], inf for a miss; `face` (B,) index, -1 then."""

    distance: Floats
    face: Ints


def cell_of(directions: Floats) -> NDArray[np.int32]:
    """(B,) cube-map bin of each of (B, 3) directions (any length but zero)."""
    size = np.abs(directions)
    axis = np.argmax(size, axis=1)
    rows = np.arange(len(directions))
    depth = directions[rows, axis]
    u = directions[rows, (axis + 1) % 3] / np.abs(depth)
    v = directions[rows, (axis + 2) % 3] / np.abs(depth)
    face = 2 * axis + (depth < 0)
    return ((face * CELLS + _bin(u)) * CELLS + _bin(v)).astype(np.int32)


def _bin(u: Floats) -> Ints:
    return np.clip(((u + 1.0) * (CELLS / 2)).astype(np.int64), 0, CELLS - 1)


class VisibleTriangles:
    """A mesh as seen from one point: which triangles may lie in which direction bin.

    Inside a bin the triangles are sorted by how near they may be, so that a ray need not look
    behind what it has hit.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Corners relative to the rays' common origin, in the rays' frame [m].
    """

    def __init__(self, triangles: Floats) -> None:
        self.triangles = triangles
        nearest = _least_distance(triangles)
        self._order = np.argsort(nearest, kind="stable")
        self._nearest = nearest[self._order]
        triangles = triangles[self._order]
        a, b, c = (triangles[:, i] for i in range(3))
        self._edge_planes = [cross(a, b), cross(b, c), cross(c, a)]
        self._normals = cross(b - a, c - a)
        self._offsets = dot(self._normals, a)
        cells, faces = _cells_of_triangles(triangles)
        order = np.argsort(cells.astype(np.uint16), kind="stable")
        self._faces = faces[order]
        self._starts = np.searchsorted(cells[order], np.arange(6 * CELLS * CELLS + 1))

    def first_hit(self, directions: Floats) -> Hits:
        """First triangle hit by each of (B, 3) unit directions."""
        cells = cell_of(directions)
        hits = Hits(np.full(len(directions), np.inf), np.full(len(directions), -1))
        rays = np.flatnonzero(self._starts[cells + 1] > self._starts[cells])
        at, end = self._starts[cells[rays]], self._starts[cells[rays] + 1]
        depth = FIRST_LOOK
        while len(rays):
            n = np.minimum(end - at, depth)
            for some in _portions(n):
                self._test(directions, rays[some], at[some], n[some], hits)
            at = at + n
            left = np.flatnonzero(at < end)
            behind = self._nearest[self._faces[at[left]]] > hits.distance[rays[left]]
            left = left[~behind]
            rays, at, end, depth = rays[left], at[left], end[left], 2 * depth
        found = hits.face >= 0
        hits.face[found] = self._order[hits.face[found]]
        return hits

    def _test(self, directions: Floats, rays: Ints, at: Ints, n: Ints, hits: Hits) -> None:
        """Test rays against `n` triangles each, from entry `at` on; keep what is nearer."""
        ray, face = np.repeat(rays, n), self._faces[np.repeat(at, n) + ranges(n)]
        ray, face, distance = self._crossings(directions, ray, face)
        better = (distance > 0.0) & (distance < hits.distance[ray])
        ray, face, distance = ray[better], face[better], distance[better]
        order = np.lexsort((self._order[face], distance, ray))  # ties go to the lowest triangle
        first = order[np.flatnonzero(np.diff(ray[order], prepend=-1))]
        hits.distance[ray[first]] = distance[first]
        hits.face[ray[first]] = face[first]

    def _crossings(self, directions: Floats, ray: Ints, face: Ints) -> tuple[Ints, Ints, Floats]:
        """Keep the (ray, face) pairs that cross; with the distance along the ray."""
        d = directions[ray]
        side = dot(self._edge_planes[0][face], d)
        low, high = side, side
        for k in (1, 2):
            side = dot(self._edge_planes[k][face], d)
            low, high = np.minimum(low, side), np.maximum(high, side)
        inside = np.flatnonzero((low >= 0.0) | (high <= 0.0))
        ray, face, d = ray[inside], face[inside], d[inside]
        toward = dot(self._normals[face], d)
        real = toward != 0.0  # edge-on and zero-area triangles stop nothing
        ray, face, toward = ray[real], face[real], toward[real]
        return ray, face, self._offsets[face] / toward


def ranges(counts: Ints) -> Ints:
    """``[0..c0), [0..c1), ...`` in one row."""
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    return np.arange(total) - np.repeat(ends - counts, counts)


def _portions(counts: Ints) -> list[slice]:
    """Cut a row of counts into runs of about PAIRS_AT_ONCE, to stay in the cache and in memory."""
    portion = np.cumsum(counts) // PAIRS_AT_ONCE
    edges = [0, *(np.flatnonzero(np.diff(portion)) + 1).tolist(), len(counts)]
    return [slice(a, b) for a, b in pairwise(edges)]


def _least_distance(triangles: Floats) -> Floats:
    """A distance (F,) that no point of the triangle is nearer than: its bounding ball's."""
    center = (triangles[:, 0] + triangles[:, 1] + triangles[:, 2]) / 3.0
    corners = [triangles[:, i] - center for i in range(3)]
    radius = np.sqrt(np.max([dot(c, c) for c in corners], axis=0))
    return np.maximum(np.sqrt(dot(center, center)) - radius * (1.0 + CELL_MARGIN), 0.0)


def _cells_of_triangles(triangles: Floats) -> tuple[Ints, Ints]:
    """All (bin, triangle) pairs where the triangle's projection may touch the bin."""
    corners = np.ascontiguousarray(triangles.transpose(2, 1, 0))  # (axis, corner, F)
    parts = [_cells_on_face(corners, face) for face in range(6)]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def _cells_on_face(corners: Floats, face: int) -> tuple[Ints, Ints]:
    axis, behind = divmod(face, 2)
    depth = -corners[axis] if behind else corners[axis]
    u, v = corners[(axis + 1) % 3], corners[(axis + 2) % 3]
    index, (iu0, iu1), (iv0, iv1) = windows(depth, u, v)
    wide, high = iu1 - iu0 + 1, iv1 - iv0 + 1
    n = wide * high
    step, rows = ranges(n), np.repeat(high, n)
    row = step // rows
    first = (face * CELLS + iu0) * CELLS + iv0
    return np.repeat(first, n) + row * CELLS + (step - row * rows), np.repeat(index, n)


def windows(depth: Floats, u: Floats, v: Floats) -> tuple[Ints, Window, Window]:
    """Triangles, of corners (3, F), that may show in the square |u|, |v| <= depth; and where.

    Returns their indices (G,), and for u and v the first and last bin (G,) of each: never fewer
    bins than the projection touches.
    """
    index = np.flatnonzero(_may_be_visible(depth, u, v))
    depth = depth[:, index]
    return index, _window(depth, u[:, index]), _window(depth, v[:, index])


def _may_be_visible(depth: Floats, u: Floats, v: Floats) -> NDArray[np.bool_]:
    """Whether no side of the face's pyramid has all three corners (3, F) outside."""
    seen: NDArray[np.bool_] = _greatest(depth) > 0.0
    for w in (u, v):
        seen &= (_least(w - depth) <= 0.0) & (_greatest(w + depth) >= 0.0)
    return seen


def _window(depth: Floats, w: Floats) -> Window:
    """First and last bin of (3, F) corners along one coordinate.

    Where a corner is behind, the part in front is bounded by its farthest depth: a surface that
    lies wholly to one side stays on that side.
    """
    behind = _least(depth) <= 0.0
    ratio = w / np.where(depth > 0.0, depth, 1.0)
    least, greatest, farthest = _least(w), _greatest(w), _greatest(depth)
    low = np.where(behind, np.where(least > 0.0, least / farthest, -1.0), _least(ratio))
    high = np.where(behind, np.where(greatest < 0.0, greatest / farthest, 1.0), _greatest(ratio))
    return (
        _bin(np.clip(low - CELL_MARGIN, -1.0, 1.0)),
        _bin(np.clip(high + CELL_MARGIN, -1.0, 1.0)),
    )


def _least(corners: Floats) -> Floats:
    """Least of three corners (3, F); three times as fast as ``min(axis=0)``."""
    return np.minimum(np.minimum(corners[0], corners[1]), corners[2])


def _greatest(corners: Floats) -> Floats:
    """Greatest of three corners (3, F)."""
    return np.maximum(np.maximum(corners[0], corners[1]), corners[2])

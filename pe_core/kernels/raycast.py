"""First hit of many rays from one point on a triangle mesh.

All rays of a sensor start at the same point, so a triangle is seen in a fixed window of directions.
Directions are binned on a cube map (six faces of CELLS x CELLS); a triangle is listed in every bin
its projection may touch; a ray is tested against its own bin's triangles only. The test uses the
planes through the origin and each edge, computed from the two end points alone, so that triangles
sharing an edge leave no gap between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import cross, dot

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CELLS = 64
"""Bins along a side of a cube face: 6 * 64**2 fits 16 bits, which NumPy sorts by radix."""
CELL_MARGIN = 1e-9
"""Bins are widened by this (in units of a face's half side) against rounding."""
PAIRS_AT_ONCE = 1 << 18


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


class SeenTriangles:
    """A mesh as seen from one point: which triangles may lie in which direction bin.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Corners relative to the rays' common origin, in the rays' frame [m].
    """

    def __init__(self, triangles: Floats) -> None:
        a, b, c = (triangles[:, i] for i in range(3))
        self.edge_planes = np.stack([cross(a, b), cross(b, c), cross(c, a)], axis=1)  # (F, 3, 3)
        self.normals = cross(b - a, c - a)
        self.offsets = dot(self.normals, a)
        cells, faces = _cells_of_triangles(triangles)
        order = np.argsort(cells.astype(np.uint16), kind="stable")
        self._faces = faces[order]
        self._starts = np.searchsorted(cells[order], np.arange(6 * CELLS * CELLS + 1))

    def first_hit(
        self, directions: Floats, cells: NDArray[np.int32] | None = None, nearest: float = 0.0
    ) -> Hits:
        """First triangle hit by each ray, beyond the distance `nearest`.

        Parameters
        ----------
        directions : (B, 3) float
            Unit directions.
        cells : (B,) int, optional
            Their bins, where the caller keeps them.
        nearest : float
            Hits at or below this distance are passed over [m].
        """
        cells = cell_of(directions) if cells is None else cells
        hits = Hits(np.full(len(directions), np.inf), np.full(len(directions), -1))
        counts = self._starts[cells + 1] - self._starts[cells]
        rays = np.flatnonzero(counts)
        for some in _portions(rays, counts[rays]):
            self._test(directions, cells, counts, some, nearest, hits)
        return hits

    def _test(
        self,
        directions: Floats,
        cells: NDArray[np.int32],
        counts: Ints,
        rays: Ints,
        nearest: float,
        hits: Hits,
    ) -> None:
        """Test each of the rays against every triangle of its bin; keep the nearest hit."""
        n = counts[rays]
        ray = np.repeat(rays, n)
        face = self._faces[np.repeat(self._starts[cells[rays]], n) + ranges(n)]
        ray, face, distance = self._crossings(directions, ray, face)
        ahead = distance > nearest
        ray, face, distance = ray[ahead], face[ahead], distance[ahead]
        order = np.lexsort((face, distance, ray))  # ties go to the lowest triangle
        first = order[np.flatnonzero(np.diff(ray[order], prepend=-1))]
        hits.distance[ray[first]] = distance[first]
        hits.face[ray[first]] = face[first]

    def _crossings(self, directions: Floats, ray: Ints, face: Ints) -> tuple[Ints, Ints, Floats]:
        """Keep the (ray, face) pairs that cross; with the distance along the ray."""
        d = directions[ray]
        side = dot(self.edge_planes[face, 0], d)
        low, high = side, side
        for k in (1, 2):
            side = dot(self.edge_planes[face, k], d)
            low, high = np.minimum(low, side), np.maximum(high, side)
        inside = np.flatnonzero((low >= 0.0) | (high <= 0.0))
        ray, face, d = ray[inside], face[inside], d[inside]
        toward = dot(self.normals[face], d)
        real = toward != 0.0  # edge-on and zero-area triangles stop nothing
        ray, face, toward = ray[real], face[real], toward[real]
        return ray, face, self.offsets[face] / toward


def ranges(counts: Ints) -> Ints:
    """``[0..c0), [0..c1), ...`` in one row."""
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    return np.arange(total) - np.repeat(ends - counts, counts)


def _portions(rays: Ints, counts: Ints) -> list[Ints]:
    """Cut rays into runs of about PAIRS_AT_ONCE pairs, to stay in the cache and in memory."""
    if not len(rays):
        return []
    portion = np.cumsum(counts) // PAIRS_AT_ONCE
    return np.split(rays, np.flatnonzero(np.diff(portion)) + 1)


def _cells_of_triangles(triangles: Floats) -> tuple[Ints, Ints]:
    """All (bin, triangle) pairs where the triangle's projection may touch the bin."""
    parts = [_cells_on_face(triangles, face) for face in range(6)]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def _cells_on_face(triangles: Floats, face: int) -> tuple[Ints, Ints]:
    axis, sign = face // 2, -1.0 if face % 2 else 1.0
    depth = sign * triangles[..., axis]
    u, v = triangles[..., (axis + 1) % 3], triangles[..., (axis + 2) % 3]
    index = np.flatnonzero(_may_be_seen(depth, u, v))
    depth, u, v = depth[index], u[index], v[index]
    iu0, iu1 = _window(depth, u)
    iv0, iv1 = _window(depth, v)
    wide, high = iu1 - iu0 + 1, iv1 - iv0 + 1
    n = wide * high
    step = ranges(n)
    row, column = step // np.repeat(high, n), step % np.repeat(high, n)
    cells = (face * CELLS + np.repeat(iu0, n) + row) * CELLS + np.repeat(iv0, n) + column
    return cells, np.repeat(index, n)


def _may_be_seen(depth: Floats, u: Floats, v: Floats) -> NDArray[np.bool_]:
    """Whether no side of the face's pyramid has all three corners (F, 3) outside."""
    outside = (depth <= 0.0).all(axis=1)
    for w in (u, v):
        outside |= (w > depth).all(axis=1) | (w < -depth).all(axis=1)
    return ~outside


def _window(depth: Floats, w: Floats) -> tuple[Ints, Ints]:
    """First and last bin of (F, 3) corners along one coordinate; all bins if one is behind."""
    behind = (depth <= 0.0).any(axis=1)
    ratio = w / np.where(depth > 0.0, depth, 1.0)
    low = np.where(behind, -1.0, ratio.min(axis=1) - CELL_MARGIN)
    high = np.where(behind, 1.0, ratio.max(axis=1) + CELL_MARGIN)
    return _bin(np.clip(low, -1.0, 1.0)), _bin(np.clip(high, -1.0, 1.0))

"""Ray-triangle intersection for rays from one point, by the planes of the edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from .bins import CubeFace, Raster, RowSpans, Spans, corner_max, row_spans
from .poses import cross, dot

NEAR_MARGIN = 1e-9
"""Relative enlargement of a triangle's bounding sphere, against rounding errors."""
EDGE_ON = 1e-12
"""Maximum rounding error of a triangle's volume, relative to its farthest corner's distance^3."""


@dataclass(frozen=True, slots=True)
class Facing:
    """Triangles (G,) projected onto one face of the cube round the rays' origin.

    `corners` (G, 3, 3) are relative to the origin [m], `number` (G,) are indices in the tree, `u`,
    `v` are bounding rectangles on the face.
    """

    corners: Floats
    number: Ints
    u: Spans
    v: Spans

    def __getitem__(self, index: NDArray) -> Facing:
        """Return the triangles at `index`."""
        u, v = ((w[0][index], w[1][index]) for w in (self.u, self.v))
        return Facing(self.corners[index], self.number[index], u, v)


class Targets:
    """Triangles with their planes and the planes of their edges.

    Attributes
    ----------
    edges : list of (3, G) float
        Normals of the planes through the origin and each edge.
    normal : (3, G) float
    offset : (G,) float
        A ray intersects the triangle's plane at ``offset / (normal . direction)``.
    """

    def __init__(self, triangles: Facing) -> None:
        self.triangles = triangles
        a, b, c = (triangles.corners[:, i] for i in range(3))
        edges = (cross(a, b), cross(b, c), cross(c, a))
        self.edges = [np.ascontiguousarray(e.T) for e in edges]
        normals = cross(b - a, c - a)
        self.offset = dot(normals, a)
        self.normal = np.ascontiguousarray(normals.T)

    def spans(self, face: CubeFace, raster: Raster, cut: NDArray[np.bool_]) -> RowSpans:
        """Return the bins that triangles may cover, cut along the edges for those in `cut` (G,)."""
        u, v = self.triangles.u, self.triangles.v
        return row_spans(raster, (u, v), self.sides(face), self.reach, cut)

    @property
    def reach(self) -> Floats:
        """(G,) square of the farthest corner's distance [m^2]."""
        corners = self.triangles.corners
        return corner_max(dot(corners, corners).T)

    def sides(self, face: CubeFace) -> list[Floats]:
        """Return the edges' planes, in axes of the face (3, G): positive inside, 0 if edge-on."""
        reach = self.reach
        turned = np.sign(self.offset) * (np.abs(self.offset) > EDGE_ON * reach * np.sqrt(reach))
        return [np.stack(face.split(edge)) * turned for edge in self.edges]

    def met(self, which: Ints, d: tuple[Floats, Floats, Floats]) -> tuple[Ints, Floats]:
        """Return which pairs (P,) of a triangle and a direction intersect, and the distances [m].

        Triangles seen edge-on, or with zero area, are never hit.
        """
        side = _product(self.edges[0], which, d)
        next_side = _product(self.edges[1], which, d)
        low, high = np.minimum(side, next_side), np.maximum(side, next_side)
        pairs = np.flatnonzero((low >= 0.0) | (high <= 0.0))
        x, y, z = (w[pairs] for w in d)
        side = _product(self.edges[2], which[pairs], (x, y, z))
        inside = (np.minimum(low[pairs], side) >= 0.0) | (np.maximum(high[pairs], side) <= 0.0)
        pairs, within = pairs[inside], np.flatnonzero(inside)
        which = which[pairs]
        toward = _product(self.normal, which, (x[within], y[within], z[within]))
        not_parallel = np.flatnonzero(toward)
        return pairs[not_parallel], self.offset[which[not_parallel]] / toward[not_parallel]


def _product(vectors: Floats, which: Ints, d: tuple[Floats, Floats, Floats]) -> Floats:
    """Scalar products, added in the order of x, y, z."""
    total = vectors[0][which] * d[0]
    total += vectors[1][which] * d[1]
    total += vectors[2][which] * d[2]
    return total


def min_distance(triangles: Floats) -> Floats:
    """Return a lower bound of the distance (G,) to triangles (G, 3, 3), by bounding spheres."""
    center = (triangles[:, 0] + triangles[:, 1] + triangles[:, 2]) / 3.0
    offsets = triangles - center[:, None]
    radius = np.sqrt(corner_max(dot(offsets, offsets).T))
    return np.maximum(np.sqrt(dot(center, center)) - radius * (1.0 + NEAR_MARGIN), 0.0)

"""Triangles made ready to be met by rays from one point, and the test whether a ray meets one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .bins import CubeFace, Raster, RowSpans, Spans, greatest_of, row_spans
from .geometry import cross, dot

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAR_MARGIN = 1e-9
"""A triangle's bounding ball is taken this much larger, against rounding."""
EDGE_ON = 1e-12
"""Volume under a triangle, over its farthest corner's distance cubed, that may be rounding."""


@dataclass(frozen=True, slots=True)
class Facing:
    """Triangles (G,) as they show on one face of the cube round the rays' origin.

    `corners` (G, 3, 3) relative to the origin, `number` (G,) in the mesh, `u` and `v` the
    rectangles they lie in on the face.
    """

    corners: Floats
    number: Ints
    u: Spans
    v: Spans

    def __getitem__(self, some: NDArray) -> Facing:
        """Return some of the triangles."""
        u, v = ((w[0][some], w[1][some]) for w in (self.u, self.v))
        return Facing(self.corners[some], self.number[some], u, v)


class Targets:
    """Triangles with their planes.

    Attributes
    ----------
    edges : list of (3, G) float
        Normals of the planes through the origin and each edge.
    normal : (3, G) float
    offset : (G,) float
        A ray meets the triangle's plane at ``offset / (normal . direction)``.
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
        """Bins that the triangles may show in: their rectangles', those `cut` (G,) to shape."""
        u, v = self.triangles.u, self.triangles.v
        return row_spans(raster, (u, v), self.sides(face), self.reach, cut)

    @property
    def reach(self) -> Floats:
        """(G,) square of the farthest corner's distance [m^2]."""
        corners = self.triangles.corners
        return greatest_of(dot(corners, corners).T)

    def sides(self, face: CubeFace) -> list[Floats]:
        """Each edge's plane in the face's axes (3, G), positive inside; 0 seen edge-on."""
        reach = self.reach
        turned = np.sign(self.offset) * (np.abs(self.offset) > EDGE_ON * reach * np.sqrt(reach))
        return [np.stack(face.split(edge)) * turned for edge in self.edges]

    def met(self, which: Ints, d: tuple[Floats, Floats, Floats]) -> tuple[Ints, Floats]:
        """Of pairs (P,) of a triangle and a direction, those that meet; and at what distance [m].

        Edge-on and zero-area triangles stop nothing.
        """
        side = _product(self.edges[0], which, d)
        next_side = _product(self.edges[1], which, d)
        low, high = np.minimum(side, next_side), np.maximum(side, next_side)
        some = np.flatnonzero((low >= 0.0) | (high <= 0.0))
        x, y, z = (w[some] for w in d)
        side = _product(self.edges[2], which[some], (x, y, z))
        inside = (np.minimum(low[some], side) >= 0.0) | (np.maximum(high[some], side) <= 0.0)
        some, within = some[inside], np.flatnonzero(inside)
        which = which[some]
        toward = _product(self.normal, which, (x[within], y[within], z[within]))
        real = np.flatnonzero(toward)
        return some[real], self.offset[which[real]] / toward[real]


def _product(vectors: Floats, which: Ints, d: tuple[Floats, Floats, Floats]) -> Floats:
    """Scalar products, added in the order of x, y, z."""
    total = vectors[0][which] * d[0]
    total += vectors[1][which] * d[1]
    total += vectors[2][which] * d[2]
    return total


def least_distance(triangles: Floats) -> Floats:
    """A distance (G,) that no point of a triangle is nearer than: its bounding ball's."""
    center = (triangles[:, 0] + triangles[:, 1] + triangles[:, 2]) / 3.0
    offsets = triangles - center[:, None]
    radius = np.sqrt(greatest_of(dot(offsets, offsets).T))
    return np.maximum(np.sqrt(dot(center, center)) - radius * (1.0 + NEAR_MARGIN), 0.0)

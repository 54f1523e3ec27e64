"""Boxes and triangles of a mesh that are visible from a point, and tests against rays from it.

A `FaceLook` is the view through one face of a cube round the point. Rays and triangles intersect
by the planes through the point and each edge.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from .bins import (
    BOX_MARGIN,
    CubeFace,
    Raster,
    RowSpans,
    Spans,
    corner_max,
    row_spans,
    spans_of_boxes,
    spans_of_triangles,
)
from .poses import cross, dot
from .ray_traversal import TriangleTree

NEAR_MARGIN = 1e-9
"""Relative enlargement of a triangle's bounding sphere, against rounding errors."""
FACE_STEP = 2.0
"""Width of a face along u: from -1 to 1."""
EDGE_ON = 1e-12
"""Maximum rounding error of a triangle's volume, relative to its farthest corner's distance^3."""
Select = Callable[[Spans, Spans], NDArray[np.bool_]]
"""Returns which rectangles of a face are selected, (N,) bool."""
CountRays = Callable[[Spans, Spans], Ints]
"""Returns the maximum number of rays through each rectangle of a face, (N,) int."""
Ends = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, slots=True)
class Facing:
    """Triangles (G,) projected onto faces of the cube round the rays' origin. `corners` (G, 3, 3)
    are relative to the origin [m], `number` (G,) are indices in the tree, `side` (G,) which of the
    look's faces it is, `u`, `v` are bounding rectangles there."""

    corners: Floats
    number: Ints
    side: Ints
    u: Spans
    v: Spans

    def __getitem__(self, index: NDArray) -> "Facing":
        """Return the triangles at `index`."""
        u, v = ((w[0][index], w[1][index]) for w in (self.u, self.v))
        return Facing(self.corners[index], self.number[index], self.side[index], u=u, v=v)


class Targets:
    """Triangles with their planes and the planes of their edges. `edges` (3, G) each are normals of
    the planes through the origin and an edge. A ray intersects the triangle's plane at ``offset /
    (normal . direction)``, `normal` (3, G) and `offset` (G,)."""

    def __init__(self, triangles: Facing) -> None:
        self.triangles = triangles
        a, b, c = (triangles.corners[:, i] for i in range(3))
        edges = (cross(a, b), cross(b, c), cross(c, a))
        self.edges = [np.ascontiguousarray(e.T) for e in edges]
        normals = cross(b - a, c - a)
        self.offset = dot(normals, a)
        self.normal = np.ascontiguousarray(normals.T)

    def spans(self, look: "FaceLook", raster: Raster, cut: NDArray[np.bool_]) -> RowSpans:
        """Return the bins that triangles may cover, cut along the edges for those in `cut` (G,)."""
        u = self.triangles.u
        v = self.triangles.v
        return row_spans(raster, (u, v), self.sides(look), self.reach, cut=cut)

    @property
    def reach(self) -> Floats:
        """(G,) square of the farthest corner's distance [m^2]."""
        corners = self.triangles.corners
        return corner_max(dot(corners, corners).T)

    def sides(self, look: "FaceLook") -> list[Floats]:
        """Return the edges' planes over (1, u, v) (3, G): positive inside, 0 if edge-on."""
        reach = self.reach
        turned = np.sign(self.offset) * (np.abs(self.offset) > EDGE_ON * reach * np.sqrt(reach))
        return [look.plane(edge, self.triangles.side) * turned for edge in self.edges]

    def met(self, which: Ints, d: tuple[Floats, Floats, Floats]) -> tuple[Ints, Floats]:
        """Return which pairs (P,) of a triangle and a direction intersect, and the distances [m].
        Triangles seen edge-on, or with zero area, are never hit."""
        side = _product(self.edges[0], which, d)
        next_side = _product(self.edges[1], which, d)
        low = np.minimum(side, next_side)
        high = np.maximum(side, next_side)
        pairs = np.flatnonzero((low >= 0.0) | (high <= 0.0))
        x, y, z = (w[pairs] for w in d)
        side = _product(self.edges[2], which[pairs], (x, y, z))
        inside = (np.minimum(low[pairs], side) >= 0.0) | (np.maximum(high[pairs], side) <= 0.0)
        pairs = pairs[inside]
        within = np.flatnonzero(inside)
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


@dataclass(frozen=True, slots=True)
class VisibleBoxes:
    """Boxes (N,) of a level: numbers, which of the look's faces it is, rectangles there, lower
    bounds of the distance [m]."""

    number: Ints
    side: Ints
    u: Spans
    v: Spans
    near: Floats

    def __getitem__(self, index: NDArray | slice) -> "VisibleBoxes":
        """Return the boxes at `index`."""
        u, v = ((w[0][index], w[1][index]) for w in (self.u, self.v))
        return VisibleBoxes(self.number[index], self.side[index], u=u, v=v, near=self.near[index])


@dataclass(frozen=True)
class FaceLook:
    """View of a mesh from a point through some faces of the cube. `origin` (3,) is the point in the
    frame of the mesh [m]. On face number k of `faces` u is moved by ``FACE_STEP * k``."""

    tree: TriangleTree
    origin: Floats
    faces: tuple[CubeFace, ...]

    @property
    def face(self) -> CubeFace:
        """The face of a look through one."""
        (face,) = self.faces
        return face

    def split(self, points: Floats, side: Ints) -> tuple[Floats, Floats, Floats]:
        """Return depth, and the coordinates along u and v, of points (3, ..., N), each (..., N), on
        the faces `side` (N,)."""
        if len(self.faces) == 1:
            return self.faces[0].split(points)
        axes, signs = self._orientation
        each = points[0].size
        at = np.arange(each).reshape(points.shape[1:])
        flat = points.reshape(-1)
        depth, u, v = (flat.take((axis * each)[side] + at) for axis in axes)
        return depth * signs[side], u, v

    @cached_property
    def _orientation(self) -> tuple[Ints, Floats]:
        """Axes of depth, u and v (3, F) of the faces, and their signs (F,)."""
        axes = np.array([face.axes for face in self.faces]).T
        return axes, np.array([face.sign for face in self.faces])

    def plane(self, normal: Floats, side: Ints) -> Floats:
        """Return planes through the origin with normals (3, N) on the faces `side` (N,): the
        factors (3, N) of (1, u, v)."""
        depth, u, v = self.split(normal, side)
        if len(self.faces) > 1:
            depth = depth - FACE_STEP * side * u
        return np.stack([depth, u, v])

    @cached_property
    def _widest(self) -> VisibleBoxes:
        """The boxes of the level that searches begin at."""
        level = self.tree.entry_level
        count = len(self.tree.boxes[level])
        sides = len(self.faces)
        number = np.tile(np.arange(count), sides)
        return self._shown(number, np.repeat(np.arange(sides), count), level)

    def ends(self) -> list[Ends | None]:
        """Return the range of u and of v that the mesh may cover on each face; None where it is not
        visible."""
        if not self.tree.boxes:
            return [None] * len(self.faces)
        ends: list[Ends | None] = []
        for side in range(len(self.faces)):
            boxes = self._widest[np.flatnonzero(self._widest.side == side)]
            u, v = (
                (float(w[0].min(initial=np.inf)), float(w[1].max(initial=-np.inf)))
                for w in (boxes.u, boxes.v)
            )
            ends.append((u, v) if len(boxes.number) else None)
        return ends

    def largest(self, count_rays: CountRays | Select, min_count: int) -> tuple[int, VisibleBoxes]:
        """Return the highest level with `min_count` boxes with rays, and these, nearest first."""
        level = self.tree.entry_level
        boxes = self._widest
        while True:
            boxes = boxes[np.flatnonzero(count_rays(boxes.u, boxes.v))]
            if level == 0 or len(boxes.number) >= min_count:
                return level, boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._below(boxes, level)
            level -= 1

    def opened(
        self, boxes: VisibleBoxes, level: int, count_rays: CountRays, max_rays: int
    ) -> tuple[list[VisibleBoxes], VisibleBoxes]:
        """Split the boxes with more than `max_rays` rays, level by level. Returns boxes with at
        most `max_rays`, by level, lowest first; and lowest boxes with more."""
        small: list[VisibleBoxes] = []
        while True:
            ray_count = count_rays(boxes.u, boxes.v)
            small.insert(0, boxes[np.flatnonzero((ray_count > 0) & (ray_count <= max_rays))])
            boxes = boxes[np.flatnonzero(ray_count > max_rays)]
            if level == 0:
                return small, boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._below(boxes, level)
            level -= 1

    def triangles(self, boxes: VisibleBoxes, select: Select) -> Facing:
        """Return the selected triangles in boxes of the lowest level."""
        index, side = self._inside(boxes, level=0)
        corners = self.tree.triangles[index] - self.origin
        depth, u, v = self.split(np.ascontiguousarray(corners.transpose(2, 1, 0)), side)
        across = self._moved(spans_of_triangles(depth, u), side)
        up = spans_of_triangles(depth, v)
        facing = Facing(corners, index, side, u=across, v=up)
        shown = (corner_max(depth) > 0.0) & select(across, up)
        return facing[np.flatnonzero(shown)]

    def _below(self, boxes: VisibleBoxes, level: int) -> VisibleBoxes:
        """Return the visible boxes one level lower in boxes of a level."""
        return self._shown(*self._inside(boxes, level), level - 1)

    def _inside(self, boxes: VisibleBoxes, level: int) -> tuple[Ints, Ints]:
        """Return what is in boxes of a level, as of `TriangleTree.below`, and the face of each."""
        number = self.tree.below(boxes.number, level)
        if len(self.faces) == 1:
            return number, np.zeros(len(number), np.int64)
        return number, np.repeat(boxes.side, self.tree.counts_below(boxes.number, level))

    def moved(self, u: Floats, side: Ints) -> Floats:
        """Return coordinates (N,) along u where the faces `side` (N,) lie side by side."""
        return u if len(self.faces) == 1 else u + FACE_STEP * side

    def _moved(self, u: Spans, side: Ints) -> Spans:
        return self.moved(u[0], side), self.moved(u[1], side)

    def _shown(self, boxes: Ints, side: Ints, level: int) -> VisibleBoxes:
        """Return which of these boxes of a level are visible on their faces."""
        corners = self.tree.boxes[level][boxes].transpose(2, 1, 0) - self.origin[:, None, None]
        depth, across, down = self.split(np.ascontiguousarray(corners), side)
        near = np.minimum(depth[0], depth[1])
        far = np.maximum(depth[0], depth[1])
        u = spans_of_boxes(near, far, across[0], across[1])
        v = spans_of_boxes(near, far, down[0], down[1])
        low, high = corners.transpose(1, 0, 2)
        x, y, z = np.maximum(np.maximum(low, -high), 0.0)
        distance = np.sqrt(x * x + y * y + z * z) * (1.0 - BOX_MARGIN)
        shown = (far > 0.0) & (u[0] <= u[1]) & (v[0] <= v[1])
        visible = VisibleBoxes(boxes, side, u=self._moved(u, side), v=v, near=distance)
        return visible[np.flatnonzero(shown)]

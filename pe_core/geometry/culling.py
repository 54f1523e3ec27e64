"""Culling: the boxes and triangles of a mesh that are visible on a face of a cube round a point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from .bins import BOX_MARGIN, CubeFace, Spans, corner_max, spans_of_boxes, spans_of_triangles
from .ray_triangle import Facing
from .triangle_tree import TriangleTree

Select = Callable[[Spans, Spans], NDArray[np.bool_]]
"""Returns which rectangles of a face are selected, (N,) bool."""
CountRays = Callable[[Spans, Spans], Ints]
"""Returns the maximum number of rays through each rectangle of a face, (N,) int."""

Ends = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, slots=True)
class VisibleBoxes:
    """Boxes (N,) of a level: numbers, rectangles on a face, lower bounds of the distance [m]."""

    number: Ints
    u: Spans
    v: Spans
    near: Floats

    def __getitem__(self, index: NDArray | slice) -> VisibleBoxes:
        """Return the boxes at `index`."""
        u, v = ((w[0][index], w[1][index]) for w in (self.u, self.v))
        return VisibleBoxes(self.number[index], u, v, self.near[index])


@dataclass(frozen=True, slots=True)
class FaceLook:
    """View of a mesh from a point through one face of the cube.

    `origin` (3,) is the point in the frame of the mesh [m].
    """

    tree: TriangleTree
    origin: Floats
    face: CubeFace

    def ends(self) -> Ends | None:
        """Return the range of u and of v that the mesh may cover; None if it is not visible."""
        if not self.tree.boxes:
            return None
        boxes = self._shown(np.arange(len(self.tree.boxes[-1])), len(self.tree.boxes) - 1)
        if not len(boxes.number):
            return None
        u, v = boxes.u, boxes.v
        return (float(u[0].min()), float(u[1].max())), (float(v[0].min()), float(v[1].max()))

    def boxes(self, select: Select) -> VisibleBoxes:
        """Return the selected boxes of the lowest level, nearest first."""
        level = len(self.tree.boxes) - 1
        boxes = self._shown(np.arange(len(self.tree.boxes[level])), level)
        while True:
            boxes = boxes[np.flatnonzero(select(boxes.u, boxes.v))]
            if level == 0:
                return boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._shown(self.tree.below(boxes.number, level), level - 1)
            level -= 1

    def largest(self, count_rays: CountRays, min_count: int) -> tuple[int, VisibleBoxes]:
        """Return the highest level with `min_count` boxes with rays, and these, nearest first."""
        level = len(self.tree.boxes) - 1
        boxes = self._shown(np.arange(len(self.tree.boxes[level])), level)
        while True:
            boxes = boxes[np.flatnonzero(count_rays(boxes.u, boxes.v))]
            if level == 0 or len(boxes.number) >= min_count:
                return level, boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._shown(self.tree.below(boxes.number, level), level - 1)
            level -= 1

    def opened(
        self, boxes: VisibleBoxes, level: int, count_rays: CountRays, max_rays: int
    ) -> tuple[list[VisibleBoxes], VisibleBoxes]:
        """Split the boxes with more than `max_rays` rays, level by level.

        Returns boxes with at most `max_rays`, by level, lowest first; and lowest boxes with more.
        """
        small: list[VisibleBoxes] = []
        while True:
            ray_count = count_rays(boxes.u, boxes.v)
            small.insert(0, boxes[np.flatnonzero((ray_count > 0) & (ray_count <= max_rays))])
            boxes = boxes[np.flatnonzero(ray_count > max_rays)]
            if level == 0:
                return small, boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._shown(self.tree.below(boxes.number, level), level - 1)
            level -= 1

    def triangles(self, boxes: Ints, select: Select) -> Facing:
        """Return the selected triangles in boxes of the lowest level."""
        index = self.tree.below(boxes, 0)
        corners = self.tree.triangles[index] - self.origin
        depth, u, v = self.face.split(np.ascontiguousarray(corners.transpose(2, 1, 0)))
        spans = spans_of_triangles(depth, u), spans_of_triangles(depth, v)
        facing = Facing(corners, index, *spans)
        shown = (corner_max(depth) > 0.0) & select(*spans)
        return facing[np.flatnonzero(shown)]

    def _shown(self, boxes: Ints, level: int) -> VisibleBoxes:
        """Return which of these boxes of a level are visible on the face."""
        low, high = self.tree.boxes[level][boxes].transpose(1, 2, 0) - self.origin[:, None]
        (near, u0, v0), (far, u1, v1) = self.face.split(low), self.face.split(high)
        if self.face.sign < 0.0:
            near, far = far, near
        u, v = spans_of_boxes(near, far, u0, u1), spans_of_boxes(near, far, v0, v1)
        x, y, z = np.maximum(np.maximum(low, -high), 0.0)
        distance = np.sqrt(x * x + y * y + z * z) * (1.0 - BOX_MARGIN)
        shown = (far > 0.0) & (u[0] <= u[1]) & (v[0] <= v[1])
        return VisibleBoxes(boxes, u, v, distance)[np.flatnonzero(shown)]

"""What of a mesh can be seen through a face of the cube round a point, box by box."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .bins import BOX_MARGIN, CubeFace, Spans, greatest_of, spans_of_boxes, spans_of_triangles
from .crossings import Facing
from .triangle_tree import TriangleTree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Chosen = Callable[[Spans, Spans], NDArray[np.bool_]]
"""Tells which of some rectangles of a face are worth a look."""
Held = Callable[[Spans, Spans], Ints]
"""Tells how many rays pass by some rectangles of a face, bin by bin."""

Ends = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, slots=True)
class SeenBoxes:
    """Boxes (N,) of a level: their numbers, rectangles, and what each is not nearer than [m]."""

    number: Ints
    u: Spans
    v: Spans
    near: Floats

    def __getitem__(self, some: NDArray | slice) -> SeenBoxes:
        """Return some of the boxes."""
        u, v = ((w[0][some], w[1][some]) for w in (self.u, self.v))
        return SeenBoxes(self.number[some], u, v, self.near[some])


@dataclass(frozen=True, slots=True)
class FaceLook:
    """A mesh's tree, looked at from a point through one face.

    `origin` (3,) in the frame of the mesh [m].
    """

    tree: TriangleTree
    origin: Floats
    face: CubeFace

    def ends(self) -> Ends | None:
        """Least and greatest u, and v, that the mesh shows at; None where it does not."""
        if not self.tree.boxes:
            return None
        boxes = self._shown(np.arange(len(self.tree.boxes[-1])), len(self.tree.boxes) - 1)
        if not len(boxes.number):
            return None
        u, v = boxes.u, boxes.v
        return (float(u[0].min()), float(u[1].max())), (float(v[0].min()), float(v[1].max()))

    def boxes(self, chosen: Chosen) -> SeenBoxes:
        """Return the lowest boxes that are chosen, nearest first."""
        level = len(self.tree.boxes) - 1
        boxes = self._shown(np.arange(len(self.tree.boxes[level])), level)
        while True:
            boxes = boxes[np.flatnonzero(chosen(boxes.u, boxes.v))]
            if level == 0:
                return boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._shown(self.tree.below(boxes.number, level), level - 1)
            level -= 1

    def largest(self, held: Held, enough: int) -> tuple[int, SeenBoxes]:
        """Boxes with rays of the highest level that has `enough`, nearest first; and the level."""
        level = len(self.tree.boxes) - 1
        boxes = self._shown(np.arange(len(self.tree.boxes[level])), level)
        while True:
            boxes = boxes[np.flatnonzero(held(boxes.u, boxes.v))]
            if level == 0 or len(boxes.number) >= enough:
                return level, boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._shown(self.tree.below(boxes.number, level), level - 1)
            level -= 1

    def opened(
        self, boxes: SeenBoxes, level: int, held: Held, few: int
    ) -> tuple[list[SeenBoxes], SeenBoxes]:
        """Open boxes of a level that hold more than `few` rays, and so on downwards.

        Returns those that do not, of each level, the lowest first; and the lowest that do.
        """
        ends: list[SeenBoxes] = []
        while True:
            number = held(boxes.u, boxes.v)
            ends.insert(0, boxes[np.flatnonzero((number > 0) & (number <= few))])
            boxes = boxes[np.flatnonzero(number > few)]
            if level == 0:
                return ends, boxes[np.argsort(boxes.near, kind="stable")]
            boxes = self._shown(self.tree.below(boxes.number, level), level - 1)
            level -= 1

    def triangles(self, boxes: Ints, chosen: Chosen) -> Facing:
        """Triangles of lowest boxes that are chosen."""
        index = self.tree.below(boxes, 0)
        corners = self.tree.triangles[index] - self.origin
        depth, u, v = self.face.split(np.ascontiguousarray(corners.transpose(2, 1, 0)))
        spans = spans_of_triangles(depth, u), spans_of_triangles(depth, v)
        facing = Facing(corners, index, *spans)
        shown = (greatest_of(depth) > 0.0) & chosen(*spans)
        return facing[np.flatnonzero(shown)]

    def _shown(self, boxes: Ints, level: int) -> SeenBoxes:
        """Those of some boxes of a level that show on the face."""
        low, high = self.tree.boxes[level][boxes].transpose(1, 2, 0) - self.origin[:, None]
        (near, u0, v0), (far, u1, v1) = self.face.split(low), self.face.split(high)
        if self.face.sign < 0.0:
            near, far = far, near
        u, v = spans_of_boxes(near, far, u0, u1), spans_of_boxes(near, far, v0, v1)
        x, y, z = np.maximum(np.maximum(low, -high), 0.0)
        distance = np.sqrt(x * x + y * y + z * z) * (1.0 - BOX_MARGIN)
        shown = (far > 0.0) & (u[0] <= u[1]) & (v[0] <= v[1])
        return SeenBoxes(boxes, u, v, distance)[np.flatnonzero(shown)]

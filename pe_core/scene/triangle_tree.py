"""The triangles of a mesh in boxes of boxes, so that what no ray can meet is never looked at.

Triangles are put in an order in which neighbours in space are mostly neighbours in the row (the
Morton order of their centres); each run of BRANCH has a bounding box, each run of BRANCH boxes has
one, and so on. The tree belongs to the mesh: it is made once, wherever rays start.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .mesh_edges import MeshEdges

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BRANCH = 8
"""Triangles in a box, and boxes in the next larger one."""
MORTON_BITS = 20
"""Bits of a coordinate in the order of the triangles: three of them fit 64."""
LEAST_EXTENT_M = 1e-300
"""A single triangle's centre has no extent; what is divided by this still is a number."""


class TriangleTree:
    """A mesh, ordered in space, under its boxes.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Corners, ground frame [m].

    Attributes
    ----------
    triangles : (F, 3, 3) float
        The same in the order of the tree.
    number : (F,) int
        Which of the mesh's triangles each of them is.
    boxes : list of (N, 2, 3) float
        Lowest and highest corners: of runs of BRANCH triangles first, at most BRANCH boxes last.
    rows : list of (N, ...) float
        What each box holds, in one row, boxes of the lowest level first: the corners of BRANCH
        triangles, then of BRANCH boxes. The last of all fills up the last row.
    """

    def __init__(self, triangles: Floats) -> None:
        self.number = _in_space(triangles)
        filled = triangles[_filled(self.number)]
        self.triangles = filled[: len(triangles)]
        self.boxes: list[Floats] = []
        self.rows = [filled.reshape(-1, 9 * BRANCH)]
        if len(triangles):
            low, high = _least(self.triangles), _greatest(self.triangles)
            while not self.boxes or len(low) > BRANCH:
                starts = np.arange(0, len(low), BRANCH)
                low = np.minimum.reduceat(low, starts, axis=0)
                high = np.maximum.reduceat(high, starts, axis=0)
                filled = _filled(np.stack([low, high], axis=1))
                self.boxes.append(filled[: len(low)])
                self.rows.append(filled.reshape(-1, 6 * BRANCH))

    @cached_property
    def edges(self) -> MeshEdges:
        """Which triangles share an edge."""
        return MeshEdges(self.triangles)

    def below(self, boxes: Ints, level: int) -> Ints:
        """Numbers of the boxes (or triangles, from level 0) in some boxes of a level."""
        total = len(self.boxes[level - 1]) if level else len(self.triangles)
        inner = (boxes[:, None] * BRANCH + np.arange(BRANCH)).reshape(-1)
        return inner if not len(inner) or inner.max() < total else inner[inner < total]

    def near(self, point: Floats, distance: float) -> Ints:
        """The mesh's triangles (N,), ascending, in boxes that come as near as that to a point."""
        level = len(self.boxes) - 1
        if level < 0:
            return np.zeros(0, np.int64)
        some = np.arange(len(self.boxes[level]))
        while True:
            low, high = self.boxes[level][some].transpose(1, 2, 0)
            x, y, z = np.maximum(np.maximum(low - point[:, None], point[:, None] - high), 0.0)
            some = some[x * x + y * y + z * z <= distance**2]
            some = self.below(some, level)
            if level == 0:
                return np.sort(self.number[some])
            level -= 1


def _in_space(triangles: Floats) -> Ints:
    """Order (F,) of the triangles' centres along a Morton curve."""
    centers = (triangles[:, 0] + triangles[:, 1] + triangles[:, 2]).T
    key = np.zeros(len(triangles), np.uint64)
    if not len(triangles):
        return key.astype(np.int64)
    for axis, w in enumerate(centers):
        extent = max(float(np.max(np.ptp(centers, axis=1))), LEAST_EXTENT_M)
        cells = ((w - w.min()) * ((2**MORTON_BITS - 1) / extent)).astype(np.uint64)
        key |= _spread(cells) << np.uint64(axis)
    return np.argsort(key, kind="stable")


def _spread(cells: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Put two zero bits between the bits of numbers below 2**MORTON_BITS."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        cells = (cells | (cells << np.uint64(shift))) & np.uint64(mask)
    return cells


def _filled(values: NDArray) -> NDArray:
    """Repeat the last until their number is a multiple of BRANCH."""
    return np.concatenate([values, np.repeat(values[-1:], -len(values) % BRANCH, axis=0)])


def _least(triangles: Floats) -> Floats:
    return np.minimum(np.minimum(triangles[:, 0], triangles[:, 1]), triangles[:, 2])


def _greatest(triangles: Floats) -> Floats:
    return np.maximum(np.maximum(triangles[:, 0], triangles[:, 1]), triangles[:, 2])

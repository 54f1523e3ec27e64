"""Conservative occlusion map of a mesh, on a face of the cube round a point.

Each bin of directions has two depths. Nothing of the mesh is nearer than `near`. Everything beyond
`far` is occluded; `far` is infinite unless the mesh covers the bin without a gap.

Gaps are found as follows. Take all triangles seen from the front. If a ray moves, the number of
them that it hits changes only where it crosses an edge whose two directions are not used by equally
many of these triangles: a silhouette edge, the rim of an open mesh, a seam. So a bin that no such
edge touches is covered completely if its middle is covered, no farther than the farthest of these
triangles in the bin. The same holds for triangles seen from the back. A mesh need be neither closed
nor oriented.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints, Singles
from .bins import (
    MARGIN,
    SIDE_MARGIN,
    Raster,
    corner_max,
    corner_min,
    count_up,
    row_spans,
    spans_of_triangles,
)
from .culling import FaceLook, Targets
from .poses import cross, dot

ROUNDING = 1e-6
"""Depths are taken this much (relative) nearer and farther: single precision, and below."""
EDGE_ON = 1e-8
"""Sine of the angle to a triangle's plane from which on its depth is known well enough."""
SLOPE_ROUNDING = 1e-12
"""Rounding of one over a depth, over the size of what it is summed from."""
FARTHEST = 1e-30  # One over a depth that is as good as infinite
BOXES_AT_ONCE = 1 << 12
PAIRS_AT_ONCE = 1 << 17


class OcclusionMap:
    """The occlusion map of a mesh, for the part of a face that a raster covers. `near` and `far`
    (count * count,) are depths, row after row of the raster [m]; inf where there is no mesh, or
    perhaps a gap."""

    def __init__(self, look: FaceLook, raster: Raster) -> None:
        self.raster = raster
        self._look = look
        self.near = np.full(raster.count**2, np.inf, np.float32)
        self.far = np.full(raster.count**2, np.inf, np.float32)
        boxes = look.largest(raster.touches, len(look.tree.number))[1]  # all of them
        sheets = [_Sheet(raster, side, self._look) for side in (1.0, -1.0)]
        for start in range(0, len(boxes.number), BOXES_AT_ONCE):
            some = boxes[slice(start, start + BOXES_AT_ONCE)]
            targets = Targets(self._look.triangles(some, raster.touches))
            for pairs in _in_bins(targets, self._look, raster):
                np.minimum.at(self.near, pairs.bin, pairs.near)
                for sheet in sheets:
                    sheet.add(pairs)
            for sheet in sheets:
                sheet.own(targets)
        for sheet in sheets:
            np.minimum(self.far, sheet.covered(), out=self.far)


@dataclass(frozen=True, slots=True)
class _EdgePairs:
    """Triangles and the bins they overlap, (P,): depths there, and whether they cover the middle.
    `side` is the visible side of the triangle, 1 or -1; 0 where the triangle is seen edge-on."""

    bin: Ints
    side: Floats
    near: Singles
    far: Singles
    middle: NDArray[np.bool_]


def _side(targets: Targets) -> Floats:
    """Visible side (G,) of triangles, 1 or -1; 0 where the plane nearly contains the origin."""
    normal = targets.normal
    size = dot(normal.T, normal.T) * targets.reach
    return np.sign(targets.offset) * (np.abs(targets.offset) > EDGE_ON * np.sqrt(size))


def _in_bins(targets: Targets, look: FaceLook, raster: Raster) -> Iterator[_EdgePairs]:
    """Yield all pairs of triangles and bins, in blocks."""
    spans = targets.spans(look, raster, np.ones(len(targets.offset), bool))
    shown = _Depths(targets, look, raster)
    counts = spans.last - spans.first + 1
    ends = np.cumsum(counts) // PAIRS_AT_ONCE
    edges = [0, *(np.flatnonzero(np.diff(ends)) + 1).tolist(), len(counts)]
    for a, b in pairwise(edges):
        n = counts[a:b]
        item = np.repeat(spans.item[a:b], n)
        row = np.repeat(spans.row[a:b], n)
        yield shown.pairs(item, row, np.repeat(spans.first[a:b], n) + count_up(n))


class _Depths:
    """Minimum and maximum depth of triangles in bins of directions."""

    def __init__(self, targets: Targets, look: FaceLook, raster: Raster) -> None:
        self._window = raster
        self._side = _side(targets)
        known = self._side != 0.0
        scale = self._side / np.where(known, np.abs(targets.offset), 1.0)
        self._slope = np.stack(look.face.split(targets.normal)) * scale  # 1 / depth over (1, u, v)
        self._edges = targets.sides(look)
        self._slack = targets.reach * SIDE_MARGIN
        depth, _, _ = look.face.split(targets.triangles.corners.transpose(2, 1, 0))
        self._least = np.maximum(corner_min(depth), 0.0)
        self._most = corner_max(depth)

    def pairs(self, item: Ints, row: Ints, column: Ints) -> _EdgePairs:
        """Compute triangles (P,) in bins (P,): minimum and maximum depth are at a bin's corners."""
        raster = self._window
        step_u = (raster.u[1] - raster.u[0]) / raster.count
        step_v = (raster.v[1] - raster.v[0]) / raster.count
        u = raster.u[0] + (row + 0.5) * step_u
        v = raster.v[0] + (column + 0.5) * step_v
        a, b, c = self._slope[:, item]
        middle = a + b * u + c * v
        spread = np.abs(b) * (0.5 * step_u + MARGIN) + np.abs(c) * (0.5 * step_v + MARGIN)
        spread += SLOPE_ROUNDING * (np.abs(a) + np.abs(b) + np.abs(c))
        near = _depth(middle + spread, 0.0)
        near = np.where(self._side[item] == 0.0, 0.0, near)
        near = np.maximum(near, self._least[item])
        far = np.minimum(_depth(middle - spread, np.inf), self._most[item])
        inside = np.ones(len(item), bool)
        for edge in self._edges:
            a, b, c = edge[:, item]
            inside &= a + b * u + c * v > self._slack[item]
        near *= 1.0 - ROUNDING
        far *= 1.0 + ROUNDING
        return _EdgePairs(
            row * raster.count + column,
            self._side[item],
            near.astype(np.float32),
            far.astype(np.float32),
            middle=inside,
        )


def _depth(inverse: Floats, otherwise: float) -> Floats:
    """``1 / inverse`` where that is positive."""
    ahead = inverse > FARTHEST
    return np.where(ahead, 1.0 / np.where(ahead, inverse, 1.0), otherwise)


class _Sheet:
    """The triangles that are seen from one side."""

    def __init__(self, raster: Raster, side: float, look: FaceLook) -> None:
        self._window = raster
        self._side = side
        self._look = look
        self._far = np.zeros(raster.count**2, np.float32)
        self._middle = np.zeros(raster.count**2, bool)
        self._owned: list[Ints] = []

    def add(self, pairs: _EdgePairs) -> None:
        """Update the triangles' maximum depth in their bins, and which middles are covered."""
        mine = np.flatnonzero(pairs.side == self._side)
        bins = pairs.bin[mine]
        np.maximum.at(self._far, bins, pairs.far[mine])
        self._middle[bins[pairs.middle[mine]]] = True

    def own(self, targets: Targets) -> None:
        """Store which triangles show this side."""
        self._owned.append(targets.triangles.number[_side(targets) == self._side])

    def covered(self) -> Singles:
        """Depth beyond which a bin is occluded; inf if it is not, or an outline touches it."""
        if not self._middle.any():  # perhaps no triangle shows this side
            return np.full(len(self._far), np.inf, np.float32)
        self._middle[self._outline()] = False
        return np.where(self._middle, self._far, np.inf).astype(np.float32)

    def _outline(self) -> Ints:
        """Bins that edges touch where the sheet ends or folds."""
        edges = self._look.tree.edges
        own = np.concatenate(self._owned)
        edge = edges.edge[own]
        turn = edges.turn[own]
        net = np.bincount(edge.reshape(-1), turn.reshape(-1), edges.count)
        item, k = np.nonzero(net[edge])
        corners = self._look.tree.triangles[own[item]] - self._look.origin
        rows = np.arange(len(item))
        a = corners[rows, k]
        b = corners[rows, (k + 1) % 3]
        depth, u, v = self._look.face.split(np.stack([a, b, b]).transpose(2, 0, 1))
        across = spans_of_triangles(depth, u)
        down = spans_of_triangles(depth, v)
        some = np.flatnonzero((corner_max(depth) > 0.0) & self._window.touches(across, down))
        plane = np.stack(self._look.face.split(cross(a[some], b[some]).T))
        reach = np.maximum(dot(a[some], a[some]), dot(b[some], b[some]))
        within = [(w[0][some], w[1][some]) for w in (across, down)]
        shown = row_spans(
            self._window,
            (within[0], within[1]),
            [plane, -plane],
            reach,
            cut=np.ones(len(some), bool),
        )
        n = shown.last - shown.first + 1
        return np.repeat(shown.row * self._window.count + shown.first, n) + count_up(n)

"""Rays followed down the tree one by one, each into the boxes that it enters itself.

Where a mesh is fine, its boxes are smaller than the gaps between rays: most of those that a bin of
rays touches are missed by all of them. So pairs of a ray and a box are followed: what the box holds
is tested against that ray alone, level by level, in the end the triangles.

Boxes are tested in single precision, a little too large, so that none is missed; triangles in
double precision, by the planes of their edges, as everywhere else and to the same bits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .numbering import blocks
from .triangle_tree import BRANCH, TriangleTree

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int64]
Triple = tuple[Floats, Floats, Floats]
Meet = Callable[[Ints, Ints, Floats], None]
"""Is told which rays (P,) meet which of the mesh's triangles (P,), at what distance (P,) [m]."""

PAIRS_AT_ONCE = 1 << 11
"""Pairs of a ray and a box that are worked on at once, to stay in the cache."""
LEAVES_AT_ONCE = 1 << 10
"""The same of lowest boxes, whose triangles take more room."""
MARGIN = 4e-9
"""Boxes are taken this much larger, over the distance of the mesh's farthest corner."""
SPARE = np.float32(1.0 + 2e-6)
"""Distances in single precision are compared with this much to spare (a ratio)."""
LEAST_SLOPE = np.float32(1e-30)
"""A ray along a box's side never meets it; what is divided by this still is a number."""


@dataclass(frozen=True, slots=True)
class RayBoxes:
    """Boxes (P,) of a level, rays (P,) that may enter them, and no nearer than `near` (P,) [m]."""

    box: Ints
    ray: Ints
    near: Singles

    def __getitem__(self, some: NDArray | slice) -> RayBoxes:
        """Return some of the pairs."""
        return RayBoxes(self.box[some], self.ray[some], self.near[some])

    def nearest_first(self) -> RayBoxes:
        """Order the pairs by distance, to a part in 128: in 16 bits, which NumPy sorts by radix."""
        bits = np.maximum(self.near, np.float32(0.0)).view(np.uint32)
        return self[np.argsort((bits >> np.uint32(16)).astype(np.uint16), kind="stable")]


class RayWalk:
    """Rays from one point, to be followed down a tree.

    Parameters
    ----------
    tree : TriangleTree
    origin : (3,) float
        Where the rays begin [m].
    directions : (3, B) float
    """

    def __init__(self, tree: TriangleTree, origin: Floats, directions: Floats) -> None:
        self._tree, self._origin, self._directions = tree, origin, directions
        margin = MARGIN * np.abs(tree.boxes[-1] - origin).max() if tree.boxes else 0.0
        self._shift = np.concatenate([-origin - margin, -origin + margin])

    def follow(self, starts: list[RayBoxes], distance: Floats, meet: Meet) -> None:
        """Tell `meet` what rays meet below their boxes.

        `starts` are pairs of each level, the lowest first. `distance` (B,) is how far rays go,
        which `meet` may shorten.
        """
        pairs = starts[-1]
        for level in range(len(starts) - 1, 0, -1):
            pairs = _joined([*self._entered(pairs, level, distance), starts[level - 1]])
        pairs = pairs.nearest_first()
        for some in blocks(len(pairs.box), LEAVES_AT_ONCE):
            part = pairs[some]
            self._meet(part[np.flatnonzero(part.near <= distance[part.ray] * SPARE)], meet)

    def _entered(self, pairs: RayBoxes, level: int, distance: Floats) -> list[RayBoxes]:
        """What rays enter of the boxes in their boxes, in parts."""
        total, found = len(self._tree.boxes[level - 1]), []
        for some in blocks(len(pairs.box), PAIRS_AT_ONCE):
            box, ray = pairs.box[some], pairs.ray[some]
            first, last = self._inside(self._tree.rows[level][box], ray)
            np.minimum(last, distance[ray].astype(np.float32), out=last)
            inner, pair = at = np.nonzero((first <= last * SPARE) & (last > 0.0))
            inner = np.minimum(box[pair] * BRANCH + inner, total - 1)
            found.append(RayBoxes(inner, ray[pair], first[at]))
        return found

    def _inside(self, rows: Floats, ray: Ints) -> tuple[Singles, Singles]:
        """Where rays (P,) enter and leave (BRANCH, P) the boxes of rows (P, 6 BRANCH)."""
        slope = self._directions[:, ray].astype(np.float32)
        slope[np.abs(slope) < LEAST_SLOPE] = LEAST_SLOPE
        ends = np.empty((6 * BRANCH, len(ray)), np.float32)
        np.add(rows.T, np.tile(self._shift, BRANCH)[:, None], out=ends, casting="same_kind")
        ends = ends.reshape(BRANCH, 2, 3, -1)
        ends *= np.float32(1.0) / slope
        near = np.minimum(ends[:, 0], ends[:, 1])
        far = np.maximum(ends[:, 0], ends[:, 1])
        first = np.maximum(np.maximum(near[:, 0], near[:, 1]), near[:, 2])
        return first, np.minimum(np.minimum(far[:, 0], far[:, 1]), far[:, 2])

    def _meet(self, pairs: RayBoxes, meet: Meet) -> None:
        """Test rays against the triangles of lowest boxes."""
        x, y, z = self._directions[:, pairs.ray]
        corners = np.empty((9 * BRANCH, len(pairs.ray)))
        shift = np.tile(self._origin, 3 * BRANCH)[:, None]
        np.subtract(self._tree.rows[0][pairs.box].T, shift, out=corners)
        a, b, c = corners.reshape(BRANCH, 3, 3, -1).transpose(1, 2, 0, 3)
        sides = [_product(_cross(p, q), (x, y, z)) for p, q in ((a, b), (b, c), (c, a))]
        low = np.minimum(np.minimum(sides[0], sides[1]), sides[2])
        high = np.maximum(np.maximum(sides[0], sides[1]), sides[2])
        inner, pair = np.nonzero((low >= 0.0) | (high <= 0.0))
        a, b, c = a[:, inner, pair], b[:, inner, pair], c[:, inner, pair]
        normal = _cross(b - a, c - a)
        toward = _product(normal, (x[pair], y[pair], z[pair]))
        real = np.flatnonzero(toward)
        distance = _product(normal, a)[real] / toward[real]
        inner, pair = inner[real], pair[real]
        triangle = np.minimum(pairs.box[pair] * BRANCH + inner, len(self._tree.number) - 1)
        meet(pairs.ray[pair], self._tree.number[triangle], distance)


def _joined(parts: list[RayBoxes]) -> RayBoxes:
    """Put pairs in one row."""
    boxes, rays, near = zip(*((part.box, part.ray, part.near) for part in parts), strict=True)
    return RayBoxes(np.concatenate(boxes), np.concatenate(rays), np.concatenate(near))


def _cross(a: Triple | Floats, b: Triple | Floats) -> Triple:
    """Vector products of (3, ...), to the bit those of `geometry.cross`."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _product(a: Triple | Floats, b: Triple | Floats) -> Floats:
    """Scalar products, added in the order of x, y, z."""
    total: Floats = a[0] * b[0]
    total += a[1] * b[1]
    total += a[2] * b[2]
    return total

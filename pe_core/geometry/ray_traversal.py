"""Traversal of the tree of boxes ray by ray, for meshes that are finer than the rays.

The boxes of a fine mesh are smaller than the gaps between rays, so most boxes in a bin of rays are
hit by no ray. Therefore this module follows pairs of a ray and a box: only that ray is tested
against the content of the box, level by level, down to the triangles.

Boxes are slightly enlarged and tested in single precision: none is missed. Triangles are tested in
double precision by the planes of their edges, with the same bits as in `culling`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints, Singles
from .indexing import blocks
from .triangle_tree import BRANCH, TriangleTree

XyzArrays = tuple[Floats, Floats, Floats]
Meet = Callable[[Ints, Ints, Floats], None]
"""Called with rays (P,), the triangles (P,) that they hit, and distances (P,) [m]."""

PAIRS_AT_ONCE = 1 << 11
"""Pairs of a ray and a box that are tested at once, to fit the CPU cache."""
LEAVES_AT_ONCE = 1 << 10
"""The same for boxes of the lowest level, whose triangles need more memory."""
MARGIN = 4e-9
"""Enlargement of boxes, relative to the distance of the mesh's farthest corner."""
SPARE = np.float32(1.0 + 2e-6)
"""Factor that allows for rounding when distances in single precision are compared."""
MIN_SLOPE = np.float32(1e-30)
"""Replaces smaller components of a direction, so that a division by them stays finite."""


@dataclass(frozen=True, slots=True)
class RayBoxes:
    """Pairs (P,) of a box of a level and a ray that may enter it, at `near` [m] or farther."""

    box: Ints
    ray: Ints
    near: Singles

    def __getitem__(self, index: NDArray | slice) -> RayBoxes:
        """Return the pairs at `index`."""
        return RayBoxes(self.box[index], self.ray[index], self.near[index])

    def nearest_first(self) -> RayBoxes:
        """Return the pairs sorted by distance, to 1/128: 16-bit keys, for NumPy's radix sort."""
        bits = np.maximum(self.near, np.float32(0.0)).view(np.uint32)
        return self[np.argsort((bits >> np.uint32(16)).astype(np.uint16), kind="stable")]


class RayWalk:
    """Rays (3, B) from one point (3,) [m] that are followed down a tree."""

    def __init__(self, tree: TriangleTree, origin: Floats, directions: Floats) -> None:
        self._tree, self._origin, self._directions = tree, origin, directions
        margin = MARGIN * np.abs(tree.boxes[-1] - origin).max() if tree.boxes else 0.0
        self._shift = np.concatenate([-origin - margin, -origin + margin])

    def follow(self, starts: list[RayBoxes], distance: Floats, meet: Meet) -> None:
        """Call `meet` with the hits of rays on triangles in their boxes.

        `starts` has pairs of each level, the lowest first. `distance` (B,) is the current length of
        the rays [m]; `meet` may reduce it.
        """
        pairs = starts[-1]
        for level in range(len(starts) - 1, 0, -1):
            pairs = _joined([*self._entered(pairs, level, distance), starts[level - 1]])
        pairs = pairs.nearest_first()
        for block in blocks(len(pairs.box), LEAVES_AT_ONCE):
            part = pairs[block]
            self._meet(part[np.flatnonzero(part.near <= distance[part.ray] * SPARE)], meet)

    def _entered(self, pairs: RayBoxes, level: int, distance: Floats) -> list[RayBoxes]:
        """Return the boxes one level lower that rays enter, as pairs, in parts."""
        total, parts = len(self._tree.boxes[level - 1]), []
        for block in blocks(len(pairs.box), PAIRS_AT_ONCE):
            box, ray = pairs.box[block], pairs.ray[block]
            first, last = self._inside(self._tree.rows[level][box], ray)
            np.minimum(last, distance[ray].astype(np.float32), out=last)
            inner, pair = at = np.nonzero((first <= last * SPARE) & (last > 0.0))
            inner = np.minimum(box[pair] * BRANCH + inner, total - 1)
            parts.append(RayBoxes(inner, ray[pair], first[at]))
        return parts

    def _inside(self, rows: Floats, ray: Ints) -> tuple[Singles, Singles]:
        """Return where rays (P,) enter and leave boxes (BRANCH, P) of rows (P, 6 BRANCH) [m]."""
        slope = self._directions[:, ray].astype(np.float32)
        slope[np.abs(slope) < MIN_SLOPE] = MIN_SLOPE
        ends = np.empty((6 * BRANCH, len(ray)), np.float32)
        np.add(rows.T, np.tile(self._shift, BRANCH)[:, None], out=ends, casting="same_kind")
        ends = ends.reshape(BRANCH, 2, 3, -1)
        ends *= np.float32(1.0) / slope
        near = np.minimum(ends[:, 0], ends[:, 1])
        far = np.maximum(ends[:, 0], ends[:, 1])
        first = np.maximum(np.maximum(near[:, 0], near[:, 1]), near[:, 2])
        return first, np.minimum(np.minimum(far[:, 0], far[:, 1]), far[:, 2])

    def _meet(self, pairs: RayBoxes, meet: Meet) -> None:
        """Test rays against the triangles in boxes of the lowest level."""
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
        not_parallel = np.flatnonzero(toward)
        distance = _product(normal, a)[not_parallel] / toward[not_parallel]
        inner, pair = inner[not_parallel], pair[not_parallel]
        triangle = np.minimum(pairs.box[pair] * BRANCH + inner, len(self._tree.number) - 1)
        meet(pairs.ray[pair], self._tree.number[triangle], distance)


def _joined(parts: list[RayBoxes]) -> RayBoxes:
    """Concatenate pairs."""
    boxes, rays, near = zip(*((part.box, part.ray, part.near) for part in parts), strict=True)
    return RayBoxes(np.concatenate(boxes), np.concatenate(rays), np.concatenate(near))


def _cross(a: XyzArrays | Floats, b: XyzArrays | Floats) -> XyzArrays:
    """Cross products of (3, ...), with the same bits as `poses.cross`."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _product(a: XyzArrays | Floats, b: XyzArrays | Floats) -> Floats:
    """Scalar products, added in the order of x, y, z."""
    total: Floats = a[0] * b[0]
    total += a[1] * b[1]
    total += a[2] * b[2]
    return total

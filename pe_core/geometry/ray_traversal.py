"""Tree of bounding boxes over a mesh's triangles, and its traversal ray by ray.

Triangles are sorted such that neighbours in space are mostly neighbours in the array (the Morton
order of their centres). Each run of BRANCH triangles has a bounding box, each run of BRANCH boxes
has one, and so on. The tree does not depend on the origin of rays, so it is built once for a mesh.

Meshes may be finer than the rays. Their boxes are then smaller than the gaps between rays,
so most boxes in a bin of rays are hit by no ray. Therefore pairs of a ray and a box are followed:
only that ray is tested against the content of the box, level by level, down to the triangles.

Boxes are slightly enlarged and tested in single precision: none is missed. Triangles are tested in
double precision by the planes of their edges, with the same bits as in `culling`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints, Singles
from .bins import blocks

MIXERS = (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9)
"""Odd factors of the hash of a point (from the golden ratio, and two primes of xxHash)."""
BRANCH = 8
"""Number of triangles in a box of the lowest level, and of boxes in a box of the next level."""
MAX_ENTRY_BOXES = 512
"""Levels with no more boxes than this take about as long as levels with one: searches of directions
begin at the lowest of them."""
MORTON_BITS = 20
"""Bits of a coordinate in the Morton key, which has 64 bits for three coordinates."""
MIN_EXTENT_M = 1e-300
"""Replaces the extent 0 of a single triangle's centre, to divide by it."""
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


class MeshEdges:
    """Edges of triangles (F, 3, 3): edge k goes from corner k to the next.

    Corners are the same point if their coordinates are equal to the bit. Points and edges are
    compared by 64-bit hashes: in meshes of 4 million triangles, one in a million has a collision.

    `edge` (F, 3) is the number of each edge of `count`, the same where two triangles share it;
    `turn` (F, 3) the direction of the triangle along it, 1 or -1, 0 if both ends are the same
    point; `first` (N, 2) a triangle, and its corner, for each point of the mesh.
    """

    def __init__(self, triangles: Floats) -> None:
        corners = _hashed(triangles)
        _, first = np.unique(corners.reshape(-1), return_index=True)
        self.first = np.stack(np.divmod(first, 3), axis=1)
        ahead = corners[:, [1, 2, 0]]
        self.turn = (corners < ahead).astype(np.int8) - (corners > ahead).astype(np.int8)
        edges, number = np.unique(_mixed(corners) + _mixed(ahead), return_inverse=True)
        self.edge = number.reshape(-1, 3)
        self.count = len(edges)


def _hashed(points: Floats) -> NDArray[np.uint64]:
    """Return a 64-bit hash (...,) of points (..., 3)."""
    bits = np.ascontiguousarray(points + 0.0).view(np.uint64)  # -0.0 is 0.0
    total = np.zeros(points.shape[:-1], np.uint64)
    for axis, mixer in enumerate(MIXERS):
        total = _mixed(total + bits[..., axis] * np.uint64(mixer))
    return total


def _mixed(numbers: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Mix the bits of numbers, bijectively (the finalizer of MurmurHash3)."""
    for mixer in (0xFF51AFD7ED558CCD, 0xC4CEB9FE1A85EC53):
        numbers = (numbers ^ (numbers >> np.uint64(33))) * np.uint64(mixer)
    return numbers ^ (numbers >> np.uint64(33))


class TriangleTree:
    """A mesh (F, 3, 3) with its triangles in spatial order, and a tree of bounding boxes.

    `triangles` are in the order of the tree, `number` (F,) the index of each in the mesh. `boxes`
    (N, 2, 3) each are lowest and highest corners by level: of BRANCH triangles first; at most
    BRANCH boxes last. `rows` hold the content of each box in a row, by level: corners of BRANCH
    triangles, then of BRANCH boxes; the last row is filled with copies of the last item.
    """

    def __init__(self, triangles: Floats) -> None:
        self.number = _in_space(triangles)
        filled = triangles[_filled(self.number)]
        self.triangles = filled[: len(triangles)]
        self.boxes: list[Floats] = []
        self.rows = [filled.reshape(-1, 9 * BRANCH)]
        if len(triangles):
            a, b, c = (self.triangles[:, k] for k in range(3))
            low = np.minimum(np.minimum(a, b), c)
            high = np.maximum(np.maximum(a, b), c)
            while not self.boxes or len(low) > BRANCH:
                starts = np.arange(0, len(low), BRANCH)
                low = np.minimum.reduceat(low, starts, axis=0)
                high = np.maximum.reduceat(high, starts, axis=0)
                filled = _filled(np.stack([low, high], axis=1))
                self.boxes.append(filled[: len(low)])
                self.rows.append(filled.reshape(-1, 6 * BRANCH))

    @cached_property
    def edges(self) -> MeshEdges:
        """Edges of the triangles, with a number that is the same for a shared edge."""
        return MeshEdges(self.triangles)

    @cached_property
    def entry_level(self) -> int:
        """The level of boxes that searches begin at; -1 without triangles."""
        few = (k for k, boxes in enumerate(self.boxes) if len(boxes) <= MAX_ENTRY_BOXES)
        return next(few, -1)

    def below(self, boxes: Ints, level: int) -> Ints:
        """Return the numbers of the boxes (for level 0: triangles) in boxes of a level."""
        total = len(self.boxes[level - 1]) if level else len(self.triangles)
        inner = (boxes[:, None] * BRANCH + np.arange(BRANCH)).reshape(-1)
        return inner if not len(inner) or inner.max() < total else inner[inner < total]

    def counts_below(self, boxes: Ints, level: int) -> Ints:
        """Return the number of boxes (for level 0: triangles) in each of some boxes of a level."""
        total = len(self.boxes[level - 1]) if level else len(self.triangles)
        return np.minimum(total - boxes * BRANCH, BRANCH)

    def near(self, point: Floats, distance: float) -> Ints:
        """Return ascending indices (N,) of triangles in boxes within `distance` [m] of a point."""
        level = self.entry_level
        if level < 0:
            return np.zeros(0, np.int64)
        boxes_near = np.arange(len(self.boxes[level]))
        while True:
            low, high = self.boxes[level][boxes_near].transpose(1, 2, 0)
            x, y, z = np.maximum(np.maximum(low - point[:, None], point[:, None] - high), 0.0)
            boxes_near = boxes_near[x * x + y * y + z * z <= distance**2]
            boxes_near = self.below(boxes_near, level)
            if level == 0:
                return np.sort(self.number[boxes_near])
            level -= 1


def _in_space(triangles: Floats) -> Ints:
    """Return the order (F,) of the triangles' centres along a Morton curve."""
    centers = (triangles[:, 0] + triangles[:, 1] + triangles[:, 2]).T
    key = np.zeros(len(triangles), np.uint64)
    if not len(triangles):
        return key.astype(np.int64)
    for axis, w in enumerate(centers):
        extent = max(float(np.max(np.ptp(centers, axis=1))), MIN_EXTENT_M)
        cells = ((w - w.min()) * ((2**MORTON_BITS - 1) / extent)).astype(np.uint64)
        key |= _spread(cells) << np.uint64(axis)
    return np.argsort(key, kind="stable")


def _spread(cells: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Insert two zero bits between the bits of numbers below 2**MORTON_BITS."""
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
    """Append copies of the last value until the number is a multiple of BRANCH."""
    return np.concatenate([values, np.repeat(values[-1:], -len(values) % BRANCH, axis=0)])


@dataclass(frozen=True, slots=True)
class RayBoxes:
    """Pairs (P,) of a box of a level and a ray that may enter it, at `near` [m] or farther."""

    box: Ints
    ray: Ints
    near: Singles

    def __getitem__(self, index: NDArray | slice) -> "RayBoxes":
        """Return the pairs at `index`."""
        return RayBoxes(self.box[index], self.ray[index], self.near[index])

    def nearest_first(self) -> "RayBoxes":
        """Return the pairs sorted by distance, to 1/128: 16-bit keys, for NumPy's radix sort."""
        bits = np.maximum(self.near, np.float32(0.0)).view(np.uint32)
        return self[np.argsort((bits >> np.uint32(16)).astype(np.uint16), kind="stable")]


class RayWalk:
    """Rays (3, B) from one point (3,) [m] that are followed down a tree."""

    def __init__(self, tree: TriangleTree, origin: Floats, directions: Floats) -> None:
        self._tree = tree
        self._origin = origin
        self._directions = directions
        margin = MARGIN * np.abs(tree.boxes[-1] - origin).max() if tree.boxes else 0.0
        self._shift = np.concatenate([-origin - margin, -origin + margin])

    def follow(self, starts: list[RayBoxes], distance: Floats, meet: Meet) -> None:
        """Call `meet` with the hits of rays on triangles in their boxes. `starts` has pairs of each
        level, the lowest first. `distance` (B,) is the current length of the rays [m]; `meet` may
        reduce it."""
        pairs = starts[-1]
        for level in range(len(starts) - 1, 0, -1):
            pairs = _joined([*self._entered(pairs, level, distance), starts[level - 1]])
        pairs = pairs.nearest_first()
        for block in blocks(len(pairs.box), LEAVES_AT_ONCE):
            part = pairs[block]
            self._meet(part[np.flatnonzero(part.near <= distance[part.ray] * SPARE)], meet)

    def _entered(self, pairs: RayBoxes, level: int, distance: Floats) -> list[RayBoxes]:
        """Return the boxes one level lower that rays enter, as pairs, in parts."""
        total = len(self._tree.boxes[level - 1])
        parts = []
        for block in blocks(len(pairs.box), PAIRS_AT_ONCE):
            box = pairs.box[block]
            ray = pairs.ray[block]
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
        a = a[:, inner, pair]
        b = b[:, inner, pair]
        c = c[:, inner, pair]
        normal = _cross(b - a, c - a)
        toward = _product(normal, (x[pair], y[pair], z[pair]))
        not_parallel = np.flatnonzero(toward)
        distance = _product(normal, a)[not_parallel] / toward[not_parallel]
        inner = inner[not_parallel]
        pair = pair[not_parallel]
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

"""First hit of many rays from one point on a triangle mesh.

All rays of a sensor start at the same point, so a box or a triangle covers a fixed range of
directions. On the faces of a cube round the point, rays are sorted into bins (`BinnedRays`): all
faces at once, side by side, unless there are so many rays that a face each is as fast. Boxes
of the mesh's tree with rays in their range are opened, nearest first. Their triangles are tested
against the rays in the bins that they may cover. If there are many more triangles than rays, rays
are followed down the tree one by one in boxes with few rays (`ray_traversal`). A ray is finished
when it has a hit nearer than all remaining boxes.

The test uses the planes through the origin and each edge, computed from the two end points alone,
so that triangles with a common edge leave no gap.
"""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from .bins import FACES, Raster, RowSpans, Spans, blocks, count_up, row_spans, stable_order
from .culling import Ends, FaceLook, Facing, Targets, VisibleBoxes, min_distance
from .ray_traversal import RayBoxes, RayWalk, TriangleTree

MAX_BINS = 1024  # Maximum number of bins along a side
FINER = 2.0
"""Maximum ratio of bins to rays along a side, for meshes with many triangles."""
SORTING_SHARE = 0.8
"""Rays are sorted again when at most this share of them is not finished."""
PAIRS_AT_ONCE = 1 << 15
MANY = np.iinfo(np.int64).max
"""A number larger than any index or count."""
RAYS_AT_ONCE = 1 << 18  # Maximum rays that are cast at once, to limit memory
MAX_FOLLOWED = 192
"""Rays up to this number are followed down the tree one by one: sorting them would take longer."""
MAX_ON_A_STRIP = 1 << 14
"""Rays up to this number are cast through all faces at once, more of them face by face: their bins
are square then."""
NOT_VISIBLE: Ends = (np.inf, -np.inf), (np.inf, -np.inf)
FINE = 16
"""Ratio of triangles to rays above which rays are followed down the tree one by one."""
MIN_BOXES_TO_SORT = 256
"""Minimum number of boxes of such a mesh's level that is sorted by distance."""
FIRST_BOXES = 64
"""Boxes that are opened before finished rays are removed; doubled each time."""
FEW_RAYS = 12  # Maximum rays in a box for which each ray is followed on its own
MIN_RAYS_TO_CUT = 16
"""Rays in a triangle's rectangle above which its bins are cut along its edges."""
MAX_BOXES = 1 << 13  # Maximum boxes whose triangles are tested at once, to limit memory


class BinnedRays:
    """Rays in the bins of a raster that covers exactly their directions. `ray` (R,) are the rays'
    numbers, `u` and `v` (R,) their directions on the faces of the look at the mesh."""

    def __init__(self, ray: Ints, u: Floats, v: Floats, directions: Floats, look: FaceLook) -> None:
        along = np.sqrt(len(ray))
        fine = max(along, min(FINER * along, np.sqrt(len(look.tree.number)) / 2.0))
        side = 2 ** int(np.ceil(np.log2(fine * np.sqrt(len(look.faces)) + 1.0)))
        self._look = look
        across, down = ((float(w.min()), float(w.max())) for w in (u, v))
        self.raster = Raster(across, down, min(side, MAX_BINS))
        n = self.raster.count
        bins = self.raster.rows(u) * n + self.raster.columns(v)
        order = stable_order(bins)
        self.ray = ray[order]
        self.u = u[order]
        self.v = v[order]
        self.directions = directions[:, order]
        counts = np.bincount(bins, minlength=n * n)
        self._starts = np.concatenate([[0], np.cumsum(counts)])
        sums = np.zeros((n + 1, n + 1), np.int32)
        rows = np.cumsum(counts.reshape(n, n), axis=1, dtype=np.int32)
        np.cumsum(rows, axis=0, out=sums[1:, 1:])
        self._sums = sums.reshape(-1)

    @classmethod
    def within(cls, look: FaceLook, d: Floats, ray: Ints, side: Ints) -> "BinnedRays | None":
        """Return the rays that may meet the mesh; None if there are none. `d` (3, B) are the
        directions of all rays, `ray` the numbers of those that pass a face of the look, `side`
        which."""
        ends = [NOT_VISIBLE if each is None else each for each in look.ends()]
        if all(each is NOT_VISIBLE for each in ends):
            return None
        (u0, u1), (v0, v1) = (
            ends[0] if len(ends) == 1 else np.array(ends).transpose(1, 2, 0)[:, :, side]
        )
        here = d[:, ray]
        depth, u, v = look.split(here, side)
        u = look.moved(u / depth, side)
        v = v / depth
        index = np.flatnonzero((u >= u0) & (u <= u1) & (v >= v0) & (v <= v1))
        ray = ray[index]
        if not len(ray):
            return None
        return cls(ray, u[index], v[index], here[:, index], look=look)

    def but_nearer(self, distance: Floats, than: float) -> "BinnedRays | None":
        """Return the rays without a hit nearer than `than` [m], None if there are none; all if few
        have one."""
        left = np.flatnonzero(distance[self.ray] >= than)
        if not len(left):
            return None
        if len(left) > SORTING_SHARE * len(self.ray):
            return self
        directions = self.directions[:, left]
        return BinnedRays(self.ray[left], self.u[left], self.v[left], directions, look=self._look)

    def count_in(self, u: Spans, v: Spans) -> Ints:
        """Return the number of rays in the bins of each rectangle, from cumulative sums."""
        n = self.raster.count + 1
        top = self.raster.rows(u[0]) * n
        bottom = (self.raster.rows(u[1]) + 1) * n
        left = self.raster.columns(v[0])
        right = self.raster.columns(v[1]) + 1
        ray_count = self._sums[bottom + right] - self._sums[top + right]
        ray_count -= self._sums[bottom + left]
        ray_count += self._sums[top + left]
        return np.where(self.raster.touches(u, v), ray_count, 0)

    def any_in(self, u: Spans, v: Spans) -> NDArray[np.bool_]:
        """Whether there is a ray in the bins of each rectangle."""
        return self.count_in(u, v) > 0

    def ray_boxes(self, boxes: VisibleBoxes, distance: Floats) -> RayBoxes:
        """Return pairs of a box and a ray through its rectangle, but no ray with a nearer hit."""
        u0, u1 = boxes.u
        v0, v1 = boxes.v
        none_cut = np.zeros(len(u0), np.bool_)
        first, count = self.in_bins(
            spans := row_spans(self.raster, (boxes.u, boxes.v), sides=[], reach=u0, cut=none_cut)
        )
        which = np.repeat(spans.item, count)
        at = np.repeat(first, count) + count_up(count)
        u = self.u[at]
        v = self.v[at]
        ray = self.ray[at]
        passed = (u0[which] <= u) & (u <= u1[which]) & (v0[which] <= v) & (v <= v1[which])
        passed &= boxes.near[which] <= distance[ray]
        kept_pairs = np.flatnonzero(passed)
        which = which[kept_pairs]
        return RayBoxes(boxes.number[which], ray[kept_pairs], boxes.near[which].astype(np.float32))

    def in_bins(self, spans: RowSpans) -> tuple[Ints, Ints]:
        """Return the first ray in each run of bins, and the number of rays in it."""
        row = spans.row * self.raster.count
        first = self._starts[row + spans.first]
        return first, self._starts[row + (spans.last + 1)] - first


@dataclass(frozen=True, slots=True)
class Hits:
    """First hits of B rays: `distance` (B,) [m], inf for a miss; `face` (B,), -1 for a miss."""

    distance: Floats
    face: Ints


class VisibleTriangles:
    """A mesh for rays from one point (3,) in its frame [m]."""

    def __init__(self, tree: TriangleTree, origin: Floats) -> None:
        self.tree = tree
        self.origin = np.asarray(origin, dtype=float)

    @property
    def triangles(self) -> Floats:
        """(F, 3, 3) corners relative to the origin, in the order of the tree [m]."""
        return self.tree.triangles - self.origin

    def first_hit(self, directions: Floats) -> Hits:
        """Return the first hits along (B, 3) unit directions; ties: the lowest triangle index."""
        hits = Hits(np.full(len(directions), np.inf), np.full(len(directions), -1))
        if len(directions) <= MAX_FOLLOWED:
            self._follow(np.ascontiguousarray(directions.T), hits)
            return hits
        for block in blocks(len(directions), RAYS_AT_ONCE):
            part = Hits(hits.distance[block], hits.face[block])
            self._cast(np.ascontiguousarray(directions[block].T), part)
        return hits

    def _follow(self, d: Floats, hits: Hits) -> None:
        """Follow each of a few rays (3, B) down the tree; the results go into `hits`."""
        levels = len(self.tree.boxes)
        rays = d.shape[1]
        if levels and rays:
            none = RayBoxes(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0, np.float32))
            box = np.repeat(np.arange(len(self.tree.boxes[-1])), rays)
            ray = np.tile(np.arange(rays), len(self.tree.boxes[-1]))
            starts = [none] * (levels - 1) + [RayBoxes(box, ray, np.zeros(len(box), np.float32))]
            walk = RayWalk(self.tree, self.origin, d)
            walk.follow(starts, hits.distance, partial(_keep, hits))

    def _cast(self, d: Floats, hits: Hits) -> None:
        """Cast rays (3, B), face by face; the results go into `hits`."""
        x, y, z = np.abs(d)
        backward = (d < 0.0).astype(np.int8)
        side = np.where(y >= z, backward[1] + np.int8(2), backward[2] + np.int8(4))
        passed = np.where((x >= y) & (x >= z), backward[0], side)  # index in `FACES`
        walk = RayWalk(self.tree, self.origin, d)
        present = np.flatnonzero(np.bincount(passed, minlength=len(FACES)))
        together = len(passed) <= MAX_ON_A_STRIP
        for numbers in [present] if together else present[:, None]:
            look = FaceLook(self.tree, self.origin, tuple(FACES[k] for k in numbers.tolist()))
            ray = np.arange(len(passed)) if together else np.flatnonzero(passed == numbers[0])
            slot = np.zeros(len(FACES), np.int64)
            slot[numbers] = np.arange(len(numbers))
            rays = BinnedRays.within(look, d, ray, side=slot[passed[ray]])
            if rays is not None:
                _cast(look, rays, walk, hits)


def _cast(look: FaceLook, rays: BinnedRays, walk: RayWalk, hits: Hits) -> None:
    """Cast the rays of one face at the boxes that are visible on it, nearest first."""
    fine = len(look.tree.number) > FINE * len(rays.ray)
    level, boxes = look.largest(rays.count_in, MIN_BOXES_TO_SORT if fine else MANY)
    count = FIRST_BOXES
    while len(boxes.number):
        unfinished = rays.but_nearer(hits.distance, boxes.near[0])
        if unfinished is None:
            return
        if unfinished is not rays:
            rays = unfinished
            boxes = boxes[np.flatnonzero(unfinished.any_in(boxes.u, boxes.v))]
        few, many = look.opened(boxes[:count], level, rays.count_in, FEW_RAYS if fine else 0)
        for some in blocks(len(many.number), MAX_BOXES):
            _scatter(look.triangles(many[some], rays.any_in), look, rays, hits)
        if fine:
            starts = [rays.ray_boxes(some, hits.distance) for some in few]
            walk.follow(starts, hits.distance, partial(_keep, hits))
        boxes = boxes[count:]
        count = 2 * count


def _scatter(triangles: Facing, look: FaceLook, rays: BinnedRays, hits: Hits) -> None:
    """Test triangles, nearest first, against the rays in the bins that they may cover."""
    near = min_distance(triangles.corners)
    order = np.argsort(near, kind="stable")
    targets = Targets(triangles[order])
    near = near[order]
    u = targets.triangles.u
    v = targets.triangles.v
    spans = targets.spans(look, rays.raster, rays.count_in(u, v) > MIN_RAYS_TO_CUT)
    first, count = rays.in_bins(spans)
    with_rays = np.flatnonzero(count)
    item = spans.item[with_rays]
    first = first[with_rays]
    count = count[with_rays]
    number = look.tree.number[targets.triangles.number]
    portion = np.cumsum(count) // PAIRS_AT_ONCE  # to fit the CPU cache and memory
    edges = [0, *(np.flatnonzero(np.diff(portion)) + 1).tolist(), len(count)]
    for part in (slice(a, b) for a, b in pairwise(edges)):
        n = count[part]
        which = np.repeat(item[part], n)
        ray = np.repeat(first[part], n) + count_up(n)
        unfinished = np.flatnonzero(near[which] <= hits.distance[rays.ray[ray]])
        which = which[unfinished]
        ray = ray[unfinished]
        x, y, z = rays.directions
        met, distance = targets.met(which, (x[ray], y[ray], z[ray]))
        _keep(hits, rays.ray[ray[met]], number[which[met]], distance)


def _keep(hits: Hits, ray: Ints, face: Ints, distance: Floats) -> None:
    """Store the hits that are nearer than those so far; ties go to the lowest triangle index."""
    before = hits.distance[ray]
    better = (distance < before) | ((distance == before) & (face < hits.face[ray]))
    better = np.flatnonzero(better & (distance > 0.0))
    ray = ray[better]
    face = face[better]
    distance = distance[better]
    before = before[better]
    np.minimum.at(hits.distance, ray, distance)
    hits.face[ray[distance < before]] = MANY
    first = distance == hits.distance[ray]
    np.minimum.at(hits.face, ray[first], face[first])

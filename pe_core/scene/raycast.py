"""First hit of many rays from one point on a triangle mesh.

All rays of a sensor start at the same point, so a box or a triangle is seen in a fixed range of
directions. On each face of a cube round the point, the rays that fall where the mesh can be are
sorted into bins; of the tree of the mesh's boxes those are opened, nearest first, whose range
holds a ray; the triangles in them are tested against the rays of the bins they show in. Where
triangles far outnumber rays, a ray that has a box almost to itself is followed into it instead
(`following`). Rays that have hit something nearer than all the boxes left are done.

The test uses the planes through the origin and each edge, computed from the two end points alone,
so that triangles sharing an edge leave no gap between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .binned_rays import BinnedRays
from .bins import FACES
from .crossings import Facing, Targets, least_distance
from .following import RayWalk
from .looking import FaceLook
from .numbering import blocks, count_up
from .triangle_tree import TriangleTree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PAIRS_AT_ONCE = 1 << 15
MANY = np.iinfo(np.int64).max
"""A number above every triangle's."""
RAYS_AT_ONCE = 1 << 18
"""Rays that are cast at once, to stay in memory."""
FINE = 16
"""Triangles for each ray from which on a mesh is so fine that rays are followed by themselves."""
ENOUGH_BOXES = 256
"""Boxes of such a mesh's level from which on they are sorted by distance."""
FIRST_BOXES = 64
"""How many boxes are opened before it is asked which rays are done; doubled each time."""
FEW_RAYS = 12
"""Rays by a box up to which each is followed into it by itself."""
WORTH_CUTTING = 16
"""Rays in a triangle's rectangle from which on it is asked where its sides run in it."""
MOST_BOXES = 1 << 13
"""Boxes whose triangles are scattered over bins at once, to stay in memory."""


@dataclass(frozen=True, slots=True)
class Hits:
    """First hits of B rays: `distance` (B,) [m], inf for a miss; `face` (B,) index, -1 then."""

    distance: Floats
    face: Ints


class SeenTriangles:
    """A mesh as seen from one point.

    Parameters
    ----------
    tree : TriangleTree
    origin : (3,) float
        The rays' common origin, in the frame of the mesh [m].
    """

    def __init__(self, tree: TriangleTree, origin: Floats) -> None:
        self.tree, self.origin = tree, np.asarray(origin, dtype=float)

    @property
    def triangles(self) -> Floats:
        """(F, 3, 3) corners relative to the origin, in the order of the tree [m]."""
        return self.tree.triangles - self.origin

    def first_hit(self, directions: Floats) -> Hits:
        """First triangle hit by each of (B, 3) unit directions; of equals, the lowest index."""
        hits = Hits(np.full(len(directions), np.inf), np.full(len(directions), -1))
        for some in blocks(len(directions), RAYS_AT_ONCE):
            part = Hits(hits.distance[some], hits.face[some])
            self._cast(np.ascontiguousarray(directions[some].T), part)
        return hits

    def _cast(self, d: Floats, hits: Hits) -> None:
        """Cast (3, B) rays, face by face."""
        passed = _faces_passed(d)
        walk = RayWalk(self.tree, self.origin, d)
        for number, face in enumerate(FACES):
            ray = np.flatnonzero(passed == number)
            look = FaceLook(self.tree, self.origin, face)
            ends = look.ends() if len(ray) else None
            rays = None if ends is None else BinnedRays.within(look, ends, d, ray)
            if rays is not None:
                _cast(look, rays, walk, hits)


def _faces_passed(d: Floats) -> NDArray[np.int8]:
    """(B,) which of `FACES` each of (3, B) directions passes; one of them at edges and corners."""
    x, y, z = np.abs(d)
    backward = (d < 0.0).astype(np.int8)
    side = np.where(y >= z, backward[1] + np.int8(2), backward[2] + np.int8(4))
    return np.where((x >= y) & (x >= z), backward[0], side)


def _cast(look: FaceLook, rays: BinnedRays, walk: RayWalk, hits: Hits) -> None:
    """Cast the rays of one face at the boxes it shows, nearest first."""
    fine = len(look.tree.number) > FINE * len(rays.ray)
    level, boxes = look.largest(rays.count_in, ENOUGH_BOXES if fine else MANY)
    count = FIRST_BOXES
    while len(boxes.number):
        left = rays.but_nearer(hits.distance, boxes.near[0])
        if left is not rays:
            rays, boxes = left, boxes[np.flatnonzero(left.any_in(boxes.u, boxes.v))]
        few, many = look.opened(boxes[:count], level, rays.count_in, FEW_RAYS if fine else 0)
        for some in blocks(len(many.number), MOST_BOXES):
            _scatter(look.triangles(many.number[some], rays.any_in), look, rays, hits)
        if fine:
            starts = [rays.ray_boxes(some, hits.distance) for some in few]
            walk.follow(starts, hits.distance, partial(_keep, hits))
        boxes, count = boxes[count:], 2 * count


def _scatter(triangles: Facing, look: FaceLook, rays: BinnedRays, hits: Hits) -> None:
    """Test triangles, nearest first, against the rays of the bins they show in."""
    distance = least_distance(triangles.corners)
    order = np.argsort(distance, kind="stable")
    _meet(Targets(triangles[order]), distance[order], look, rays, hits)


def _meet(targets: Targets, near: Floats, look: FaceLook, rays: BinnedRays, hits: Hits) -> None:
    """Test triangles that are not nearer than `near` (G,) against the rays of their bins."""
    u, v = targets.triangles.u, targets.triangles.v
    spans = targets.spans(look.face, rays.raster, rays.count_in(u, v) > WORTH_CUTTING)
    first, count = rays.in_bins(spans)
    some = np.flatnonzero(count)
    item, first, count = spans.item[some], first[some], count[some]
    number = look.tree.number[targets.triangles.number]
    for part in _portions(count):
        n = count[part]
        which, ray = np.repeat(item[part], n), np.repeat(first[part], n) + count_up(n)
        open_ = np.flatnonzero(near[which] <= hits.distance[rays.ray[ray]])
        which, ray = which[open_], ray[open_]
        x, y, z = rays.directions
        met, distance = targets.met(which, (x[ray], y[ray], z[ray]))
        _keep(hits, rays.ray[ray[met]], number[which[met]], distance)


def _keep(hits: Hits, ray: Ints, face: Ints, distance: Floats) -> None:
    """Keep what is nearer than what has been hit; ties go to the lowest triangle."""
    before = hits.distance[ray]
    better = (distance < before) | ((distance == before) & (face < hits.face[ray]))
    better = np.flatnonzero(better & (distance > 0.0))
    ray, face, distance, before = ray[better], face[better], distance[better], before[better]
    np.minimum.at(hits.distance, ray, distance)
    hits.face[ray[distance < before]] = MANY
    first = distance == hits.distance[ray]
    np.minimum.at(hits.face, ray[first], face[first])


def _portions(counts: Ints) -> list[slice]:
    """Cut a row of counts into runs of about PAIRS_AT_ONCE, to stay in the cache and in memory."""
    portion = np.cumsum(counts) // PAIRS_AT_ONCE
    edges = [0, *(np.flatnonzero(np.diff(portion)) + 1).tolist(), len(counts)]
    return [slice(a, b) for a, b in pairwise(edges)]

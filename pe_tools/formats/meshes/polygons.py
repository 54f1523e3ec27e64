"""Polygons as triangles, for all readers: convex ones as fans, others by cutting off ears.

A corner is an ear when its triangle lies inside the polygon: then the triangle is cut off, and the
polygon has a corner less (G. H. Meisters, Polygons have ears, 1975). A hole is joined to the ring
around it by an edge that is followed twice.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError

Corners = NDArray[np.int64]
MAX_CONCAVE_CORNERS = 5_000  # Cutting ears takes time with the square of the corners: 8 s
ON_LINE = 1e-12  # Product of two areas, of points that are within 1 of each other, that counts as 0
CHUNK_CORNERS = 1 << 18  # Corners of the polygons that are worked on together
ROUNDING = 1e-9  # Share of a polygon's area by which the areas of its triangles may differ
# A corner without area is cut off first: it may be the end of a spike
EAR = 1
FLAT = 2
CLOSED, OPEN, CONVEX, ANY = range(4)
STRICTNESS = (CLOSED, CLOSED, OPEN, OPEN, CONVEX, ANY)
"""What an ear must be, level by level; each level begins with a count of all ears. No other corner
in the ear or on its border; none in it; convex. A polygon that does not cross itself ends before
the last two levels."""


class Triangulation(NamedTuple):
    """Triangles (T, 3, 3) of polygons, the polygon (T,) of each, and how many polygons cross
    themselves: their triangles overlap."""

    triangles: Floats
    polygons: Corners
    crossing: int


def triangulate(source: str, corners: Floats, counts: NDArray[np.integer]) -> Triangulation:
    """Cut polygons into triangles, in their order and with their winding.

    Parameters
    ----------
    source : str
        The file, for messages.
    corners : (C, 3) float
        Corners of all polygons in one list.
    counts : (P,) int
        Number of corners of each polygon; polygons of fewer than three corners give no triangle.

    Raises
    ------
    InputError
        A polygon that is not convex has more than `MAX_CONCAVE_CORNERS` corners.
    """
    sizes = counts.astype(np.int64)
    if (sizes == 3).all():  # the usual case
        return Triangulation(corners.reshape(-1, 3, 3), np.arange(len(sizes)), 0)
    positions, polygons = _fans(sizes)
    starts = np.cumsum(sizes) - sizes
    firsts = np.cumsum(np.maximum(sizes - 2, 0)) - np.maximum(sizes - 2, 0)
    crossing = 0
    for size in np.unique(sizes[sizes > 3]).tolist():
        members = np.flatnonzero(sizes == size)
        step = max(CHUNK_CORNERS // size, 1)
        for chunk in (members[k : k + step] for k in range(0, len(members), step)):
            rings = corners[starts[chunk][:, None] + np.arange(size)]
            concave = ~_fan_fits(rings)
            if not concave.any():
                continue
            if size > MAX_CONCAVE_CORNERS:
                expected = f"concave polygons of at most {MAX_CONCAVE_CORNERS:,} corners"
                raise InputError(source, "polygons", expected, f"{size:,}")
            cut = _cut_quads(rings[concave]) if size == 4 else _cut_ears(_flat(rings[concave]))
            crossing += int(np.count_nonzero(_overlap(rings[concave], cut)))
            chosen = chunk[concave]
            rows = firsts[chosen][:, None] + np.arange(size - 2)
            positions[rows] = starts[chosen][:, None, None] + cut
    return Triangulation(corners[positions], polygons, crossing)


def triangle_count(counts: NDArray[np.integer]) -> int:
    """Number of triangles of polygons with `counts` (P,) corners."""
    return int(np.maximum(counts.astype(np.int64) - 2, 0).sum())


def joined_ring(rings: Sequence[Floats]) -> Corners:
    """Return a ring and the holes in it as one ring: the order of the points of all `rings`, one
    list after the other, in which those of the edge to a hole stand twice."""
    points = np.concatenate(rings)
    normal = _area_vectors(rings[0][None])[0]
    u, v = _plane(normal)
    flat = points[:, [u, v]] - points[:, [u, v]].min(axis=0)
    flat /= max(float(flat.max()), np.finfo(float).tiny)
    firsts = np.cumsum([0, *(len(ring) for ring in rings)])
    orders = [np.arange(a, b) for a, b in pairwise(firsts)]
    outer = orders[0]
    holes = orders[1:]
    following = np.concatenate([np.roll(order, -1) for order in orders])
    for hole in sorted(holes, key=lambda order: -flat[order, 0].max()):
        turned = hole if _area(flat[hole]) < 0.0 else hole[::-1]
        start = int(np.argmax(flat[turned, 0]))
        ring = np.roll(turned, -start)
        begins = np.concatenate([flat, flat[outer]])
        ends = np.concatenate([flat[following], flat[np.roll(outer, -1)]])
        at = _bridge(flat[outer], flat[ring[0]], begins, ends)
        outer = np.concatenate([outer[: at + 1], ring, ring[:1], outer[at:]])
    return outer


def _bridge(outer: Floats, start: Floats, begins: Floats, ends: Floats) -> int:
    """Position in a ring (N, 2) of the nearest corner to which an edge from `start` meets none of
    the edges from `begins` (E, 2) to `ends`, and beside which the edge is inside the ring."""
    before = np.roll(outer, 1, axis=0)
    after = np.roll(outer, -1, axis=0)
    for at in np.argsort(((outer - start) ** 2).sum(axis=1), kind="stable").tolist():
        there = outer[at]
        sides = _cross(there - start, begins - start) * _cross(there - start, ends - start)
        along = ends - begins
        across = _cross(along, start - begins) * _cross(along, there - begins)
        apart = [(tips != tip).any(axis=1) for tips in (begins, ends) for tip in (start, there)]
        meets = (sides <= ON_LINE) & (across <= ON_LINE) & np.logical_and.reduce(apart)
        if not meets.any() and _is_within(before[at], there, after[at], start):
            return at
    return int(np.argmax(outer[:, 0]))


def _is_within(before: Floats, corner: Floats, after: Floats, point: Floats) -> bool:
    """Whether a point is in the angle of a corner of a ring that turns to the left."""
    left_of_in = _cross(corner - before, point - corner) > 0.0
    left_of_out = _cross(after - corner, point - corner) > 0.0
    if _cross(corner - before, after - corner) >= 0.0:
        return bool(left_of_in and left_of_out)
    return bool(left_of_in or left_of_out)


def _fans(sizes: Corners) -> tuple[Corners, Corners]:
    """Positions (T, 3) of the corners of each polygon's fan of triangles, and the polygon (T,)."""
    triangles = np.maximum(sizes - 2, 0)
    polygons = np.repeat(np.arange(len(sizes)), triangles)
    step = np.arange(len(polygons)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    first = (np.cumsum(sizes) - sizes)[polygons]
    return np.stack([first, first + step + 1, first + step + 2], axis=1), polygons


def _fan_fits(rings: Floats) -> NDArray[np.bool_]:
    """Whether the fan (P,) of each ring (P, N, 3) covers the ring once. Of a quad, whether both
    triangles look to one side, as Blender has it."""
    spokes = rings[:, 1:] - rings[:, :1]
    areas = np.cross(spokes[:, :-1], spokes[:, 1:])
    if rings.shape[1] == 4:
        fits: NDArray[np.bool_] = (areas[:, 0] * areas[:, 1]).sum(axis=1) >= 0.0
        return fits
    return ~_covers_more(areas)


def _cut_quads(rings: Floats) -> Corners:
    """The corners (P, 2, 3) of quads' triangles when the second corner is that of both."""
    return np.broadcast_to(np.array([(0, 1, 3), (1, 2, 3)]), (len(rings), 2, 3))


def _overlap(rings: Floats, cut: Corners) -> NDArray[np.bool_]:
    """Whether the triangles (P, N - 2, 3) of each ring (P, N, 3) cover more than the ring."""
    corners = rings[np.arange(len(rings))[:, None, None], cut]
    areas = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    return _covers_more(areas)


def _covers_more(areas: Floats) -> NDArray[np.bool_]:
    """Whether triangles with area vectors (P, T, 3) cover more than the polygon (P,) that they are
    of, seen across it: then some overlap."""
    total = areas.sum(axis=1)
    squared = (total * total).sum(axis=1)
    along = np.abs((areas * total[:, None]).sum(axis=2)).sum(axis=1)
    more: NDArray[np.bool_] = along > squared * (1.0 + ROUNDING)
    return more | ((squared == 0.0) & (areas != 0.0).any(axis=(1, 2)))


def _area_vectors(rings: Floats) -> Floats:
    """Vectors (P, 3) across rings (P, N, 3), as long as twice their areas."""
    spokes = rings - rings[:, :1]
    vectors: Floats = np.cross(spokes, np.roll(spokes, -1, axis=1)).sum(axis=1)
    return vectors


def _plane(normal: Floats) -> tuple[int, int]:
    """Two coordinate axes in which a ring with this normal turns to the left. Points are only
    copied: corners on a line stay on a line, to the last bit."""
    across = int(np.argmax(np.abs(normal)))
    u = (across + 1) % 3
    v = (across + 2) % 3
    return (u, v) if normal[across] >= 0.0 else (v, u)


def _flat(rings: Floats) -> Floats:
    """Rings (P, N, 3) seen along the axis that is nearest to their normal, (P, N, 2)."""
    axes = np.array([_plane(normal) for normal in _area_vectors(rings)])
    return np.take_along_axis(rings, axes[:, None, :], axis=2)


def _cross(a: Floats, b: Floats) -> Floats:
    """Twice the area between vectors (..., 2), positive where b is to the left of a."""
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def _area(ring: Floats) -> float:
    """Twice the area of a ring (N, 2), positive where it turns to the left."""
    return float(_cross(ring - ring[0], np.roll(ring, -1, axis=0) - ring[0]).sum())


def _cut_ears(flat: Floats) -> Corners:
    """The corners (P, N - 2, 3) of the triangles of rings (P, N, 2) that turn to the left."""
    count, size = flat.shape[:2]
    rings = _ClippedRings.of(flat)
    all_rows = np.arange(count)
    rings.count_ears(all_rows)
    cut = np.empty((count, size - 2, 3), np.int64)
    for step in range(size - 2):
        while len(stuck := np.flatnonzero(~rings.ears.any(axis=1))):
            rings.level[stuck] += 1
            rings.count_ears(stuck)
        cut[:, step] = rings.cut_off(all_rows, rings.ears.argmax(axis=1))
    return cut


@dataclass(slots=True)
class _ClippedRings:
    """Rings from which ears are cut, a row each: corners (P, N, 2), the corner before and after
    each (P, N), which are left, which are ears (`EAR`, `FLAT`), and the level (P,) of
    `STRICTNESS`."""

    flat: Floats
    before: Corners
    after: Corners
    is_left: NDArray[np.bool_]
    ears: NDArray[np.int8]
    level: Corners

    @classmethod
    def of(cls, flat: Floats) -> "_ClippedRings":
        count, size = flat.shape[:2]
        order = np.arange(size)
        return cls(
            flat,
            np.tile(np.roll(order, 1), (count, 1)),
            np.tile(np.roll(order, -1), (count, 1)),
            np.ones((count, size), np.bool_),
            ears=np.zeros((count, size), np.int8),
            level=np.zeros(count, np.int64),
        )

    def count_ears(self, rows: Corners) -> None:
        """Find all ears of some rings."""
        for corner in range(self.flat.shape[1]):
            self._look(rows, np.full(len(rows), corner))

    def cut_off(self, rows: Corners, corner: Corners) -> Corners:
        """Cut an ear off each ring; return its corners (P, 3)."""
        before = self.before[rows, corner]
        after = self.after[rows, corner]
        self.after[rows, before] = after
        self.before[rows, after] = before
        self.is_left[rows, corner] = False
        for changed in (corner, before, after):
            self._look(rows, changed)
        return np.stack([before, corner, after], axis=1)

    def _look(self, rows: Corners, corner: Corners) -> None:
        """Find whether a corner of each ring is an ear. A corner without area is one."""
        a = self.flat[rows, self.before[rows, corner]]
        b = self.flat[rows, corner]
        c = self.flat[rows, self.after[rows, corner]]
        area = _cross(b - a, c - a)
        strictness = np.array(STRICTNESS)[self.level[rows]]
        convex = np.flatnonzero((area > 0.0) & (strictness <= OPEN))
        is_ear = (area == 0.0) | (strictness == ANY) | ((area > 0.0) & (strictness == CONVEX))
        ear = np.stack([a, b, c], axis=1)[convex]
        points = self.flat[rows[convex]]
        inside = _inside(points, ear, (strictness[convex] == OPEN)[:, None])
        is_ear[convex] = ~(inside & self.is_left[rows[convex]]).any(axis=1)
        sort = np.where(area == 0.0, FLAT, EAR)
        self.ears[rows, corner] = sort * (is_ear & self.is_left[rows, corner])


def _inside(points: Floats, triangles: Floats, is_open: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether points (P, N, 2) are in a triangle (P, 3, 2) that turns to the left, or, unless it
    `is_open` (P, 1), on its border. Points at its corners are not."""
    inside = np.ones(points.shape[:2], np.bool_)
    for k in range(3):
        begin = triangles[:, k, None]
        end = triangles[:, (k + 1) % 3, None]
        side = _cross(end - begin, points - begin)
        inside &= (side > 0.0) | ((side == 0.0) & ~is_open)
        inside &= (points != begin).any(axis=2)
    return inside

"""Rays through one face of the cube round their origin, sorted into bins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .bins import Raster, RowSpans, Spans, row_spans
from .following import RayBoxes
from .looking import Ends, FaceLook, SeenBoxes
from .numbering import count_up

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST_BINS = 1024
"""Bins along a side at most."""
FINER = 2.0
"""Bins along a side for each ray along it at most, where triangles are many."""
RADIX_BINS = 1 << 16
"""Bins that fit 16 bits, which NumPy sorts by radix."""
WORTH_SORTING = 0.8
"""Rays are sorted anew when no more than this share of them is left."""


class BinnedRays:
    """Rays in bins of a raster that just holds them.

    Parameters
    ----------
    ray : (R,) int
        Numbers of the rays.
    u, v : (R,) float
        Where they pass the face.
    directions : (3, R) float
    triangles : int
        How many triangles the mesh has.
    """

    def __init__(self, ray: Ints, u: Floats, v: Floats, directions: Floats, triangles: int) -> None:
        along = np.sqrt(len(ray))
        fine = max(along, min(FINER * along, np.sqrt(triangles) / 2.0))
        side = 2 ** int(np.ceil(np.log2(fine + 1.0)))
        self._triangles = triangles
        ends = [(float(w.min()), float(w.max())) for w in (u, v)]
        self.raster = Raster(ends[0], ends[1], min(side, MOST_BINS))
        n = self.raster.count
        bins = self.raster.rows(u) * n + self.raster.columns(v)
        key = bins.astype(np.uint16) if n * n <= RADIX_BINS else bins
        order = np.argsort(key, kind="stable")
        self.ray, self.u, self.v = ray[order], u[order], v[order]
        self.directions = directions[:, order]
        counts = np.bincount(bins, minlength=n * n)
        self._starts = np.concatenate([[0], np.cumsum(counts)])
        sums = np.zeros((n + 1, n + 1), np.int32)
        held = counts.reshape(n, n).astype(np.int32)
        np.cumsum(np.cumsum(held, axis=1, dtype=np.int32), axis=0, out=sums[1:, 1:])
        self._sums = sums.reshape(-1)

    @classmethod
    def within(cls, look: FaceLook, ends: Ends, d: Floats, ray: Ints) -> BinnedRays | None:
        """Rays that pass a face within a rectangle; None where none does.

        `d` (3, B) are the directions of all rays, `ray` the numbers of those that pass the face.
        """
        depth, u, v = (w[ray] for w in look.face.split(d))
        u, v = u / depth, v / depth
        (u0, u1), (v0, v1) = ends
        some = np.flatnonzero((u >= u0) & (u <= u1) & (v >= v0) & (v <= v1))
        ray = ray[some]
        return cls(ray, u[some], v[some], d[:, ray], len(look.tree.number)) if len(ray) else None

    def but_nearer(self, distance: Floats, than: float) -> BinnedRays:
        """Return the rays that are not stopped nearer than that, or all if most are."""
        left = np.flatnonzero(distance[self.ray] >= than)
        if not 0 < len(left) <= WORTH_SORTING * len(self.ray):
            return self  # also when none is left: then it is soon over
        return BinnedRays(
            self.ray[left], self.u[left], self.v[left], self.directions[:, left], self._triangles
        )

    def count_in(self, u: Spans, v: Spans) -> Ints:
        """Rays in the bins that each rectangle touches: four look-ups in a table of sums."""
        n = self.raster.count + 1
        top, bottom = self.raster.rows(u[0]) * n, (self.raster.rows(u[1]) + 1) * n
        left, right = self.raster.columns(v[0]), self.raster.columns(v[1]) + 1
        held = self._sums[bottom + right] - self._sums[top + right]
        held -= self._sums[bottom + left]
        held += self._sums[top + left]
        return np.where(self.raster.touches(u, v), held, 0)

    def any_in(self, u: Spans, v: Spans) -> NDArray[np.bool_]:
        """Whether some ray's bin is touched by each rectangle."""
        return self.count_in(u, v) > 0

    def ray_boxes(self, boxes: SeenBoxes, distance: Floats) -> RayBoxes:
        """Boxes and the rays that pass their rectangles, but for rays (B,) stopped nearer [m]."""
        (u0, u1), (v0, v1) = boxes.u, boxes.v
        every = np.zeros(len(u0), np.bool_)
        first, count = self.in_bins(
            spans := row_spans(self.raster, (boxes.u, boxes.v), [], u0, every)
        )
        which = np.repeat(spans.item, count)
        at = np.repeat(first, count) + count_up(count)
        u, v, ray = self.u[at], self.v[at], self.ray[at]
        passed = (u0[which] <= u) & (u <= u1[which]) & (v0[which] <= v) & (v <= v1[which])
        passed &= boxes.near[which] <= distance[ray]
        some = np.flatnonzero(passed)
        which = which[some]
        return RayBoxes(boxes.number[which], ray[some], boxes.near[which].astype(np.float32))

    def in_bins(self, spans: RowSpans) -> tuple[Ints, Ints]:
        """First ray of each run of bins, and how many there are."""
        row = spans.row * self.raster.count
        first = self._starts[row + spans.first]
        return first, self._starts[row + (spans.last + 1)] - first

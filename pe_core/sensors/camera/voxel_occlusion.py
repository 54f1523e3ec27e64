"""Voxels of a space that the vehicle surely occludes for a camera, and those that need a ray.

The voxels of an x-plane lie in few bins of directions. The bin of a row or a height is computed
once, and each voxel is compared with the two depths of its bin (`occlusion_map`).
"""

from __future__ import annotations

from dataclasses import dataclass
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from ...geometry.bins import FACES, CubeFace, Raster
from ...geometry.culling import Ends, FaceLook
from ...geometry.indexing import count_up
from ...geometry.occlusion_map import Cover
from ...scene.vehicle import VisibleMesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def places_of(
    axes: list[Floats], index: Ints, shape: tuple[int, ...], first: tuple[int, int]
) -> Floats:
    """Places (V, 3), told axis by axis, of voxels numbered from a plane and a row on."""
    column, k = np.divmod(index, shape[2])
    i, j = np.divmod(column, shape[1])
    x, y, z = axes
    return np.stack([x[first[0] + i], y[first[1] + j], z[k]], axis=1)


def span_of(mask: NDArray[np.bool_]) -> slice:
    """From the first to the last that is true."""
    seen = np.flatnonzero(mask)
    return slice(int(seen[0]), int(seen[-1]) + 1) if len(seen) else slice(0, 0)


Mask = NDArray[np.bool_]

MAX_BINS, MIN_BINS = 512, 64
"""Along a side of a face."""
VOXELS_A_BIN = 256
"""What a bin should be worth in voxels of the space."""
ALIGNED = 1e-8
"""A ray that passes this near (in u and v) to a corner of a triangle is cast: along it rounding
decides which of the triangles round the corner are met, and it may be none."""


EVERYWHERE = ((-1.0, 1.0), (-1.0, 1.0))


@dataclass(frozen=True, slots=True)
class OcclusionFlags:
    """Flags of voxels (..., rows, nz): surely occluded, and unsure (a ray has to decide)."""

    hidden: Mask
    unsure: Mask

    @classmethod
    def none(cls, shape: tuple[int, ...]) -> OcclusionFlags:
        """Nothing is hidden."""
        return cls(np.zeros(shape, bool), np.zeros(shape, bool))

    def __getitem__(self, some: int | slice | tuple[slice, slice]) -> OcclusionFlags:
        """Return a view of some of the voxels."""
        return OcclusionFlags(self.hidden[some], self.unsure[some])

    def doubt(self, voxels: slice | Mask | tuple[Ints, Ints]) -> None:
        """Have some voxels asked about."""
        self.hidden[voxels] = False
        self.unsure[voxels] = True


class VoxelOcclusion:
    """A vehicle's shadow on the voxels of a space.

    Parameters
    ----------
    offsets : three (n,) float
        Where the centres of voxels lie along each axis, from the camera, ascending [m].
    seen : VisibleMesh
        The vehicle from the camera's position.
    corners : (4, 3) float
        Directions to the corners of the picture, or of a somewhat larger one, ground axes.
    """

    def __init__(self, offsets: list[Floats], seen: VisibleMesh, corners: Floats) -> None:
        self._offsets, self._seen, self._corners = offsets, seen, corners
        self._highest = float(np.abs(offsets[2]).max())
        self._faces: dict[CubeFace, FaceOcclusion] = {}
        self._making = Lock()

    def judge(self, planes: slice, rows: slice) -> OcclusionFlags:
        """Judge the voxels of planes across x, in some rows (y)."""
        x, y = self._offsets[0][planes], self._offsets[1][rows]
        shade = OcclusionFlags.none((len(x), len(y), len(self._offsets[2])))
        for number, depth in enumerate(x):
            self._judge(float(depth), rows, y, shade[number])
        return shade

    def _judge(self, x: float, rows: slice, y: Floats, shade: OcclusionFlags) -> None:
        across = (np.abs(y) <= abs(x)) & (x != 0.0)
        for face, some in (
            (FACES[0 if x > 0.0 else 1], across),
            (FACES[2], ~across & (y > 0.0)),
            (FACES[3], ~across & (y < 0.0)),
        ):
            run = span(some)
            if run.start < run.stop:
                first = rows.start + run.start
                self._face(face).judge(x, slice(first, rows.start + run.stop), shade[run])
        if abs(x) < self._highest:  # a few voxels over the camera and under it
            nearer = np.maximum(np.abs(y), abs(x))[:, None]
            shade.doubt(np.abs(self._offsets[2]) > nearer)

    def _face(self, face: CubeFace) -> FaceOcclusion:
        """One of the four sides; made when a voxel first lies there."""
        with self._making:  # threads share the planes
            if face not in self._faces:
                look = FaceLook(self._seen.seen.tree, self._seen.seen.origin, face)
                kind = AcrossX if face.axes[0] == 0 else AlongX
                self._faces[face] = kind(look, _view(self._corners, face), self._offsets)
            return self._faces[face]


def _view(corners: Floats, face: CubeFace) -> Ends:
    """Rectangle of a face that holds the picture; all of it where a corner is behind."""
    depth, u, v = face.split(corners.T)
    if depth.min() <= 0.0:
        return EVERYWHERE
    u, v = np.clip(u / depth, -1.0, 1.0), np.clip(v / depth, -1.0, 1.0)
    return (float(u.min()), float(u.max())), (float(v.min()), float(v.max()))


def _cover(look: FaceLook, ends: Ends, view: Ends, offsets: list[Floats]) -> Cover | None:
    """Where the mesh shows in the picture, in bins that suit the voxels there."""
    u, v = ((max(a[0], b[0]), min(a[1], b[1])) for a, b in zip(ends, view, strict=True))
    if u[0] >= u[1] or v[0] >= v[1]:
        return None
    voxels = _voxels_within(look.face, (u, v), offsets)
    side = 2 ** int(np.log2(np.sqrt(voxels / VOXELS_A_BIN) + 1.0))
    return Cover(look, Raster(u, v, int(np.clip(side, MIN_BINS, MAX_BINS))))


def _voxels_within(face: CubeFace, ends: Ends, offsets: list[Floats]) -> float:
    """About how many voxels lie in a rectangle of a face."""
    depth = face.sign * offsets[face.axes[0]]
    depth = depth[depth > 0.0]
    count = np.ones(len(depth))
    for axis, (low, high) in zip(face.axes[1:], ends, strict=True):
        w = offsets[axis]
        extent = np.clip(high * depth, w[0], w[-1]) - np.clip(low * depth, w[0], w[-1])
        count *= extent * (len(w) / max(w[-1] - w[0], 1e-9)) if len(w) > 1 else 1.0
    return float(count.sum())


class FaceOcclusion:
    """The shadow on voxels that are seen through one side of the cube round the camera."""

    def __init__(self, look: FaceLook, view: Ends, offsets: list[Floats]) -> None:
        self._ends, self._offsets = look.ends(), offsets
        self._cover = None if self._ends is None else _cover(look, self._ends, view, offsets)
        if self._cover is not None:
            self._aims, self._heights = self._corners(look)

    def judge(self, x: float, rows: slice, shade: OcclusionFlags) -> None:
        """Judge a plane's voxels, in rows that all lie on this side; `shade` is theirs."""
        raise NotImplementedError

    def _in_order(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Of the corners' places on the face: what a row lies at, ascending, and the height's."""
        raise NotImplementedError

    def _corners(self, look: FaceLook) -> tuple[Floats, Floats]:
        triangle, corner = look.tree.edges.first.T
        depth, u, v = look.face.split((look.tree.triangles[triangle, corner] - look.origin).T)
        some = (depth > np.abs(u)) & (depth > np.abs(v))
        aims, heights = self._in_order(u[some] / depth[some], v[some] / depth[some])
        order = np.argsort(aims)
        return aims[order], heights[order]

    def _settle(self, cover: Cover, bins: Ints, depth: Floats, shade: OcclusionFlags) -> None:
        depth = depth.astype(np.float32)
        np.greater(depth, cover.far[bins], out=shade.hidden)
        np.greater_equal(depth, cover.near[bins], out=shade.unsure)
        np.greater(shade.unsure, shade.hidden, out=shade.unsure)

    def _doubt_aligned(self, aims: Floats, depths: Floats, shade: OcclusionFlags) -> None:
        """Doubt voxels in line with a corner, in rows of some aims and depths, (rows,) each."""
        if not shade.hidden.any():
            return
        z = self._offsets[2]
        start = np.searchsorted(self._aims, aims - ALIGNED)
        n = np.searchsorted(self._aims, aims + ALIGNED) - start
        row = np.repeat(np.arange(len(aims)), n)
        depth = depths[row]
        height = self._heights[np.repeat(start, n) + count_up(n)] * depth
        above = np.clip(np.searchsorted(z, height), 1, len(z) - 1) if len(z) > 1 else 0 * row
        k = np.where(height - z[above - 1] < z[above] - height, above - 1, above)
        some = np.abs(z[k] - height) <= ALIGNED * depth
        shade.doubt((row[some], k[some]))


class AcrossX(FaceOcclusion):
    """Towards x or against it: a plane lies at one depth, a row of voxels in a row of bins."""

    def judge(self, x: float, rows: slice, shade: OcclusionFlags) -> None:
        """Look at the bins of rows and of heights."""
        if self._ends is None:
            return
        depth = abs(x)
        u, v = self._offsets[1][rows] / depth, self._offsets[2] / depth
        shade[_spans(u, v, self._ends)].doubt(slice(None))
        if self._cover is None:
            return
        raster = self._cover.raster
        j, k = _spans(u, v, (raster.u, raster.v))
        bins = np.add.outer(raster.rows(u[j]) * raster.count, raster.columns(v[k]))
        self._settle(self._cover, bins, np.full((1, 1), depth), shade[j, k])
        self._doubt_aligned(u[j], np.full(len(u[j]), depth), shade[j])

    def _in_order(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        return u, v


class AlongX(FaceOcclusion):
    """Towards y or against it: a row of voxels lies at one depth, in a column of bins."""

    def __init__(self, look: FaceLook, view: Ends, offsets: list[Floats]) -> None:
        super().__init__(look, view, offsets)
        _, y, z = offsets
        u = z / np.where(y == 0.0, 1.0, np.abs(y))[:, None]  # no row beside the camera lies here
        if self._ends is not None:
            self._shown = _within(u, self._ends[0])
        if self._cover is not None:
            raster = self._cover.raster
            self._inside, self._bins = _within(u, raster.u), raster.rows(u) * raster.count

    def judge(self, x: float, rows: slice, shade: OcclusionFlags) -> None:
        """Look at the bins of each row's column."""
        if self._ends is None:
            return
        depth = np.abs(self._offsets[1][rows])
        v = x / depth
        j = span(_within(v, self._ends[1]))
        shade[j].doubt(self._shown[_moved(j, rows.start)])
        if self._cover is None:
            return
        raster = self._cover.raster
        j = span(_within(v, raster.v))
        here, shade = _moved(j, rows.start), shade[j]
        found = OcclusionFlags.none(shade.hidden.shape)
        self._settle(
            self._cover, self._bins[here] + raster.columns(v[j])[:, None], depth[j, None], found
        )
        for mine, theirs in ((shade.hidden, found.hidden), (shade.unsure, found.unsure)):
            np.copyto(mine, theirs, where=self._inside[here])
        self._doubt_aligned(v[j], depth[j], shade)

    def _in_order(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        return v, u


def _moved(run: slice, by: int) -> slice:
    return slice(run.start + by, run.stop + by)


def _spans(u: Floats, v: Floats, ends: Ends) -> tuple[slice, slice]:
    return span(_within(u, ends[0])), span(_within(v, ends[1]))


def _within(w: Floats, ends: tuple[float, float]) -> Mask:
    inside: Mask = (w >= ends[0]) & (w <= ends[1])
    return inside


def span(mask: Mask) -> slice:
    """From the first to the last that is true."""
    first = int(mask.argmax()) if len(mask) else 0
    if not len(mask) or not mask[first]:
        return slice(0, 0)
    return slice(first, len(mask) - int(mask[::-1].argmax()))

"""Voxels of a space that the vehicle surely hides from a camera, and voxels that need a ray.

The voxels of an x-plane lie in few bins of directions. The bin of a row or a height is computed
once, and each voxel is compared with the two depths of its bin (`occlusion_map`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints
from ...base.lazy_threads import threads
from ...geometry.bins import FACES, CubeFace, Raster, count_up
from ...geometry.culling import Ends, FaceLook
from ...geometry.occlusion_map import OcclusionMap
from ...scene.vehicle import VisibleMesh

Mask = NDArray[np.bool_]
MAX_BINS = 512
MIN_BINS = 64
"""Bins along a side of a face."""
VOXELS_A_BIN = 256  # Number of the space's voxels for each bin
ALIGNED = 1e-8
"""A ray that passes a triangle's corner within this distance (in u and v) is cast: rounding decides
which of the triangles at the corner it hits, and it may hit none."""
EVERYWHERE = ((-1.0, 1.0), (-1.0, 1.0))


def positions_of(
    axes: list[Floats], index: Ints, shape: tuple[int, ...], first: tuple[int, int]
) -> Floats:
    """Positions (V, 3) of voxels from coordinates along each axis. `index` (V,) are flat indices in
    an array of `shape`, which begins at the plane and row `first`."""
    column, k = np.divmod(index, shape[2])
    i, j = np.divmod(column, shape[1])
    x, y, z = axes
    return np.stack([x[first[0] + i], y[first[1] + j], z[k]], axis=1)


def distance_along(offset: Floats, side: float) -> Floats:
    """Distance from the camera to voxels along one axis; 0 beside a voxel [m]."""
    return np.maximum(np.abs(offset) - side / 2.0, 0.0)


@dataclass(frozen=True, slots=True)
class OcclusionFlags:
    """Flags of voxels (..., rows, nz): surely hidden, or unsure (a ray has to decide)."""

    hidden: Mask
    unsure: Mask

    @classmethod
    def none(cls, shape: tuple[int, ...]) -> "OcclusionFlags":
        """Return flags that are all False."""
        return cls(np.zeros(shape, bool), np.zeros(shape, bool))

    def __getitem__(self, some: int | slice | tuple[slice, slice]) -> "OcclusionFlags":
        """Return a view of some of the voxels."""
        return OcclusionFlags(self.hidden[some], self.unsure[some])

    def mark_unsure(self, voxels: slice | Mask | tuple[Ints, Ints]) -> None:
        """Flag voxels as unsure."""
        self.hidden[voxels] = False
        self.unsure[voxels] = True


class VoxelOcclusion:
    """Classifies the voxels of a space: hidden by the vehicle, visible, or unsure. `offsets` are
    the coordinates (n,) of the voxels' centres along each axis, from the camera, ascending [m];
    `corners` (4, 3) directions to the corners of the picture, or of a larger one."""

    def __init__(self, offsets: list[Floats], seen: VisibleMesh, corners: Floats) -> None:
        self._offsets = offsets
        self._seen = seen
        self._corners = corners
        self._highest = float(np.abs(offsets[2]).max())
        self._faces: dict[CubeFace, FaceOcclusion] = {}
        self._lock = threads().RLock()

    def classify(self, planes: slice, rows: slice) -> OcclusionFlags:
        """Classify the voxels of some planes (x) and rows (y)."""
        x = self._offsets[0][planes]
        y = self._offsets[1][rows]
        flags = OcclusionFlags.none((len(x), len(y), len(self._offsets[2])))
        for number, depth in enumerate(x):
            self._classify_plane(float(depth), rows, y, flags[number])
        return flags

    def _classify_plane(self, x: float, rows: slice, y: Floats, flags: OcclusionFlags) -> None:
        across = (np.abs(y) <= abs(x)) & (x != 0.0)
        for face, some in (
            (FACES[0 if x > 0.0 else 1], across),
            (FACES[2], ~across & (y > 0.0)),
            (FACES[3], ~across & (y < 0.0)),
        ):
            run = span(some)
            if run.start < run.stop:
                first = rows.start + run.start
                self._face(face).classify(x, slice(first, rows.start + run.stop), flags[run])
        if abs(x) < self._highest:  # a few voxels above and below the camera
            nearer = np.maximum(np.abs(y), abs(x))[:, None]
            flags.mark_unsure(np.abs(self._offsets[2]) > nearer)

    def _face(self, face: CubeFace) -> "FaceOcclusion":
        """Return the occlusion on one of the four sides; made when the first voxel needs it."""
        with self._lock:  # threads share the planes
            if face not in self._faces:
                look = FaceLook(self._seen.seen.tree, self._seen.seen.origin, (face,))
                kind = AcrossX if face.axes[0] == 0 else AlongX
                self._faces[face] = kind(look, _view(self._corners, face), self._offsets)
            return self._faces[face]


def _view(corners: Floats, face: CubeFace) -> Ends:
    """Rectangle of a face that contains the picture; the whole face where a corner is behind."""
    depth, u, v = face.split(corners.T)
    if depth.min() <= 0.0:
        return EVERYWHERE
    u = np.clip(u / depth, -1.0, 1.0)
    v = np.clip(v / depth, -1.0, 1.0)
    return (float(u.min()), float(u.max())), (float(v.min()), float(v.max()))


def _cover(look: FaceLook, ends: Ends, view: Ends, offsets: list[Floats]) -> OcclusionMap | None:
    """Return the occlusion map of the mesh in the picture, with bins for the voxels there."""
    u, v = ((max(a[0], b[0]), min(a[1], b[1])) for a, b in zip(ends, view, strict=True))
    if u[0] >= u[1] or v[0] >= v[1]:
        return None
    depth = look.face.sign * offsets[look.face.axes[0]]
    depth = depth[depth > 0.0]
    count = np.ones(len(depth))
    for axis, (low, high) in zip(look.face.axes[1:], (u, v), strict=True):
        w = offsets[axis]
        extent = np.clip(high * depth, w[0], w[-1]) - np.clip(low * depth, w[0], w[-1])
        count *= extent * (len(w) / max(w[-1] - w[0], 1e-9)) if len(w) > 1 else 1.0
    voxels = float(count.sum())
    side = 2 ** int(np.log2(np.sqrt(voxels / VOXELS_A_BIN) + 1.0))
    return OcclusionMap(look, Raster(u, v, int(np.clip(side, MIN_BINS, MAX_BINS))))


class FaceOcclusion:
    """The occlusion of voxels in the directions of one side of the cube round the camera."""

    def __init__(self, look: FaceLook, view: Ends, offsets: list[Floats]) -> None:
        (self._ends,) = look.ends()
        self._offsets = offsets
        self._cover = None if self._ends is None else _cover(look, self._ends, view, offsets)
        if self._cover is not None:
            self._aims, self._heights = self._corners(look)

    def classify(self, x: float, rows: slice, flags: OcclusionFlags) -> None:
        """Classify a plane's voxels in rows on this side; the result is written to `flags`."""
        raise NotImplementedError

    def _rows_and_heights(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return the corners' coordinates on the face: that of rows, then that of heights."""
        raise NotImplementedError

    def _corners(self, look: FaceLook) -> tuple[Floats, Floats]:
        triangle, corner = look.tree.edges.first.T
        depth, u, v = look.face.split((look.tree.triangles[triangle, corner] - look.origin).T)
        some = (depth > np.abs(u)) & (depth > np.abs(v))
        aims, heights = self._rows_and_heights(u[some] / depth[some], v[some] / depth[some])
        order = np.argsort(aims)
        return aims[order], heights[order]

    def _settle(
        self, cover: OcclusionMap, bins: Ints, depth: Floats, flags: OcclusionFlags
    ) -> None:
        depth = depth.astype(np.float32)
        np.greater(depth, cover.far[bins], out=flags.hidden)
        np.greater_equal(depth, cover.near[bins], out=flags.unsure)
        np.greater(flags.unsure, flags.hidden, out=flags.unsure)

    def _mark_aligned(self, aims: Floats, depths: Floats, flags: OcclusionFlags) -> None:
        """Flag voxels in line with a triangle's corner as unsure; `aims`, `depths` are by row."""
        if not flags.hidden.any():
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
        flags.mark_unsure((row[some], k[some]))


class AcrossX(FaceOcclusion):
    """A side across x: a plane has one depth, and a row of voxels is in a row of bins."""

    def classify(self, x: float, rows: slice, flags: OcclusionFlags) -> None:
        """Compare voxels with the bins of rows and heights."""
        if self._ends is None:
            return
        depth = abs(x)
        u = self._offsets[1][rows] / depth
        v = self._offsets[2] / depth
        flags[_spans(u, v, self._ends)].mark_unsure(slice(None))
        if self._cover is None:
            return
        raster = self._cover.raster
        j, k = _spans(u, v, (raster.u, raster.v))
        bins = np.add.outer(raster.rows(u[j]) * raster.count, raster.columns(v[k]))
        self._settle(self._cover, bins, np.full((1, 1), depth), flags[j, k])
        self._mark_aligned(u[j], np.full(len(u[j]), depth), flags[j])

    def _rows_and_heights(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        return u, v


class AlongX(FaceOcclusion):
    """A side across y: a row of voxels has one depth, and is in a column of bins."""

    def __init__(self, look: FaceLook, view: Ends, offsets: list[Floats]) -> None:
        super().__init__(look, view, offsets)
        _, y, z = offsets
        u = z / np.where(y == 0.0, 1.0, np.abs(y))[:, None]  # y = 0 is not on this side
        if self._ends is not None:
            self._shown = _within(u, self._ends[0])
        if self._cover is not None:
            raster = self._cover.raster
            self._inside = _within(u, raster.u)
            self._bins = raster.rows(u) * raster.count

    def classify(self, x: float, rows: slice, flags: OcclusionFlags) -> None:
        """Compare voxels with the bins of each row's column."""
        if self._ends is None:
            return
        depth = np.abs(self._offsets[1][rows])
        v = x / depth
        j = span(_within(v, self._ends[1]))
        flags[j].mark_unsure(self._shown[_moved(j, rows.start)])
        if self._cover is None:
            return
        raster = self._cover.raster
        j = span(_within(v, raster.v))
        here = _moved(j, rows.start)
        flags = flags[j]
        found = OcclusionFlags.none(flags.hidden.shape)
        self._settle(
            self._cover, self._bins[here] + raster.columns(v[j])[:, None], depth[j, None], found
        )
        for mine, theirs in ((flags.hidden, found.hidden), (flags.unsure, found.unsure)):
            np.copyto(mine, theirs, where=self._inside[here])
        self._mark_aligned(v[j], depth[j], flags)

    def _rows_and_heights(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        return v, u


def _moved(run: slice, by: int) -> slice:
    return slice(run.start + by, run.stop + by)


def _spans(u: Floats, v: Floats, ends: Ends) -> tuple[slice, slice]:
    return span(_within(u, ends[0])), span(_within(v, ends[1]))


def _within(w: Floats, ends: tuple[float, float]) -> Mask:
    inside: Mask = (w >= ends[0]) & (w <= ends[1])
    return inside


def span(mask: Mask) -> slice:
    """The range from the first to the last True element."""
    first = int(mask.argmax()) if len(mask) else 0
    if not len(mask) or not mask[first]:
        return slice(0, 0)
    return slice(first, len(mask) - int(mask[::-1].argmax()))

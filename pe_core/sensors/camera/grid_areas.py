"""Pixel areas of all voxels of consecutive x-planes.

**Through a pinhole** (`CameraPlanes`) the four sides of the frustum decide where a column of voxels
(along z) enters and leaves the picture. The voxels between have the closed form of `sample_areas`,
in single precision. Depth and the distances of faces are the sum of a term of x and a term of y and
z; the second is the same for all planes. Half spaces also give the voxels on the picture's border,
near the camera, and perhaps behind the vehicle. These get the exact functions, all planes at once.
If the vehicle may hide very many voxels, `voxel_occlusion` decides most of them without a ray.

**Through a lens with distortion** (`BentPlanes`) the voxels of each plane are classified as in
`sample_areas`, in single precision. Voxels on the border of the field of view get the exact area,
all planes at once. `voxel_occlusion` decides for most voxels whether the vehicle hides them; it
covers all directions.
"""

from typing import NamedTuple

import numpy as np

from ...base.arrays import Floats, Ints, Singles
from ...geometry.bins import count_up
from ...geometry.grids import PerceptionSpace
from ...geometry.poses import Pose, dot
from ...metric.fusion import VisibleRows
from ...scene.vehicle import VisibleMesh
from .definition import (
    BALL,
    MARGIN,
    NUDGE,
    aims_at,
    axes_of,
    clipped_pixel_area,
    cut_to_range,
    hidden,
    in_sensor_frame,
    is_ranged,
    offsets_of,
)
from .model import BORDER, Camera, PictureBins
from .sample_areas import NEAR_SIDES, Sorter, edge_areas
from .voxel_occlusion import VoxelOcclusion, distance_along, positions_of, span

HalfSpace = tuple[Floats, float]
"""A direction, and the minimum distance of a voxel's centre from the camera along it [m]."""
MANY_RAYS = 50_000
"""Number of rays in consecutive planes above which an occlusion map is faster."""
ASKED = 16
"""One of this many voxels is tested, to estimate how many the vehicle may hide."""
LEVEL = 1e-12  # Minimum slope along z of a side of the frustum, which is a divisor
ALL_ROUND = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
"""The directions that `VoxelOcclusion` gets as corners of the picture: they include all sides."""


class ColumnRuns(NamedTuple):
    """A run of voxels in each column (along z), from `first` to before `end`, (n, rows) each."""

    first: Ints
    end: Ints

    def within(self, outer: "ColumnRuns") -> "ColumnRuns":
        """Return the parts inside the outer runs; an empty run is at the outer run's end."""
        first = np.clip(self.first, outer.first, outer.end)
        end = np.clip(self.end, first, outer.end)
        empty = first == end
        return ColumnRuns(np.where(empty, outer.end, first), np.where(empty, outer.end, end))

    def listed(self, nz: int) -> Ints:
        """Flat indices (V,) of all voxels of the runs, in an array of planes, rows and heights."""
        first = self.first.reshape(-1)
        end = self.end.reshape(-1)
        some = np.flatnonzero(end > first)
        counts = end[some] - first[some]
        return np.repeat(some * nz + first[some], counts) + count_up(counts)


class _AreaPlanes:
    """A mounted camera, ready to measure a space plane by plane; `seen` is the vehicle from it."""

    def __init__(
        self, camera: Camera, pose: Pose, space: PerceptionSpace, seen: VisibleMesh | None
    ) -> None:
        self._camera = camera
        self._space = space
        self._seen = seen
        side = space.interval
        self._axes = axes_of(pose)
        self._offsets = [offsets_of(space.centers(k), pose.position[k], side) for k in range(3)]
        self._aims = [aims_at(w, side, NUDGE[k]) for k, w in enumerate(self._offsets)]
        _, y, z = self._offsets
        self._away = np.add.outer(distance_along(y, side), distance_along(z, side)).astype(
            np.float32
        )
        self._cover: VoxelOcclusion | None = None

    def _hide_by_rays(self, area: Singles, index: Ints, aims: Floats) -> None:
        """Set the areas of the voxels to 0 of which rays say that the vehicle hides them."""
        assert self._seen is not None
        area.reshape(-1)[index[hidden(self._seen, aims)]] = 0.0

    def _hide_surely(self, area: Singles, first: tuple[int, int]) -> tuple[Ints, Floats]:
        """Set surely hidden voxels to 0; return the undecided ones and the points rays aim at."""
        assert self._cover is not None
        planes, rows = (slice(f, f + n) for f, n in zip(first, area.shape[:2], strict=True))
        flags = self._cover.classify(planes, rows)
        np.copyto(area, 0.0, where=flags.hidden)
        index = np.flatnonzero(flags.unsure)
        index = index[area.reshape(-1)[index] > 0.0]
        return index, positions_of(self._aims, index, area.shape, first)


class CameraPlanes(_AreaPlanes):
    """A mounted camera whose lens is a pinhole."""

    def __init__(
        self, camera: Camera, pose: Pose, space: PerceptionSpace, seen: VisibleMesh | None
    ) -> None:
        super().__init__(camera, pose, space, seen)
        self._forward = self._axes[:, 0]
        lens = camera.projection
        wide = -(camera.width - lens.cx) / lens.fx, lens.cx / lens.fx  # left / depth
        high = -(camera.height - lens.cy) / lens.fy, lens.cy / lens.fy  # up / depth
        self._sides = _sides(self._axes, wide, high)
        _, y, z = self._offsets
        self._depth = np.add.outer(self._forward[1] * y, self._forward[2] * z).astype(np.float32)
        below = np.tri(len(z) + 1, len(z), -1, dtype=np.int32)  # row k: 1 for heights below k
        # masks: all bits set, or none
        self._keep_below = -below
        self._keep_from = below - 1
        self._shadow: PictureBins | None = None
        if seen is not None:
            self._shadow = PictureBins(camera, self._axes, seen.seen.triangles)
            forward, left, up = self._axes.T
            a, b = (BORDER * max(abs(low), top) for low, top in (wide, high))
            corners = [
                forward + i * a * left + j * b * up for i in (-1.0, 1.0) for j in (-1.0, 1.0)
            ]
            self._cover = VoxelOcclusion(self._aims, seen, np.array(corners))

    def areas(self, planes: slice) -> VisibleRows:
        """Pixels covered by each voxel of the x-planes; rows out of view are left out."""
        rows = self._rows_in_view(planes)
        near = (NEAR_SIDES + MARGIN) * self._space.interval
        touched = self._runs(planes, rows, [(self._forward, 0.0), *self._at_sides(-1.0)])
        plain = self._runs(planes, rows, [(self._forward, near), *self._at_sides(1.0)])
        plain = plain.within(touched)
        area = self._filled(planes, rows, plain)
        nz = area.shape[2]
        before = ColumnRuns(touched.first, plain.first)
        behind = ColumnRuns(plain.end, touched.end)
        edge = np.concatenate([before.listed(nz), behind.listed(nz)])
        first = planes.start, rows.start
        offsets = positions_of(self._offsets, edge, area.shape, first)
        exact = clipped_pixel_area(self._camera, self._axes, offsets, self._space.interval)
        area.reshape(-1)[edge] = exact
        if is_ranged(self._camera):
            cut_to_range(self._camera, area, self._offsets, first)
        if self._shadow is not None:
            asked = edge
            if not self._shadow.empty:  # voxels in the directions of the vehicle's triangles, too
                sides = _sides(self._axes, *self._shadow.extent)
                shaded = self._runs(planes, rows, [(n, -MARGIN) for n in sides]).within(plain)
                asked = np.concatenate([edge, shaded.listed(nz)])
            self._settle_hidden(area, asked[area.reshape(-1)[asked] > 0.0], first)
        return VisibleRows(rows, area)

    def _at_sides(self, radii: float) -> list[HalfSpace]:
        """Half spaces of voxels inside the frustum's sides by a number of the voxels' radii."""
        side = self._space.interval
        return [(n, radii * ((float(np.abs(n).sum()) / 2.0 + MARGIN) * side)) for n in self._sides]

    def _rows_in_view(self, planes: slice) -> slice:
        """Rows (y) with a voxel that may touch the picture, on any of the planes."""
        x = self._offsets[0][planes]
        y = self._offsets[1]
        z = self._offsets[2]
        inside = np.ones(len(y), bool)
        for n, least in [(self._forward, 0.0), *self._at_sides(-1.0)]:
            most = max(n[0] * x[0], n[0] * x[-1]) + max(n[2] * z[0], n[2] * z[-1])
            inside &= n[1] * y > least - most
        return span(inside)

    def _runs(self, planes: slice, rows: slice, half_spaces: list[HalfSpace]) -> ColumnRuns:
        """Runs of voxels that lie in all half spaces."""
        x = self._offsets[0][planes]
        y = self._offsets[1][rows]
        nz = len(self._offsets[2])
        step = self._space.interval
        lowest = self._offsets[2][0] / step
        low = np.zeros((len(x), len(y)))
        high = np.full((len(x), len(y)), float(nz))
        for n, least in half_spaces:
            slope = n[2] if abs(n[2]) > LEVEL else LEVEL
            scale = 1.0 / (slope * step)
            here = (least * scale - lowest) - (n[0] * scale) * x
            crossing = np.add.outer(here, (-n[1] * scale) * y)  # height of its border, in voxels
            if slope > 0.0:
                np.maximum(low, crossing, out=low)
            else:
                np.minimum(high, crossing, out=high)
        first = np.minimum(np.ceil(low), nz).astype(np.int64)
        end = np.clip(np.ceil(high), first, nz).astype(np.int64)
        return ColumnRuns(first, end)

    def _filled(self, planes: slice, rows: slice, plain: ColumnRuns) -> Singles:
        """Areas by the closed form of `sample_areas` in the runs; 0 elsewhere."""
        depth = self._depth[rows]
        away = self._away[rows]
        x = self._offsets[0][planes]
        area = np.empty((len(x), *depth.shape), np.float32)
        held = np.empty_like(depth)
        for plane, x_depth, x_away, first, end in zip(
            area, self._forward[0] * x, distance_along(x, self._space.interval), *plain, strict=True
        ):
            some = span(first < end)
            plane[: some.start] = 0.0
            plane[some.stop :] = 0.0
            self._flat(plane[some], held[some], (depth[some], x_depth), (away[some], x_away))
            bits = plane[some].view(np.int32)
            bits &= self._keep_from[first[some]]
            bits &= self._keep_below[end[some]]
        return area

    def _flat(
        self, out: Singles, cube: Singles, depth: tuple[Singles, float], away: tuple[Singles, float]
    ) -> None:
        """Write the closed form to `out`; `depth` and `away` have two terms, `cube` is scratch."""
        side = self._space.interval
        np.add(depth[0], np.float32(depth[1]), out=out)
        np.maximum(out, np.float32(NEAR_SIDES * side), out=out)  # nearer ones are not for this form
        np.multiply(out, out, out=cube)
        cube -= np.float32(side * side / 2.0)
        cube *= out
        np.add(away[0], np.float32(away[1] + 1.5 * side), out=out)
        out *= np.float32((self._camera.focal_px * side) ** 2)
        out /= cube

    def _settle_hidden(self, area: Singles, index: Ints, first: tuple[int, int]) -> None:
        """Set the areas of the voxels that the vehicle hides to 0."""
        if len(index) > MANY_RAYS:
            some, _ = self._maybe_hidden(index[::ASKED], area.shape, first)
            if len(some) * ASKED > MANY_RAYS:
                self._hide_by_rays(area, *self._hide_surely(area, first))
                return
        self._hide_by_rays(area, *self._maybe_hidden(index, area.shape, first))

    def _maybe_hidden(
        self, index: Ints, shape: tuple[int, ...], first: tuple[int, int]
    ) -> tuple[Ints, Floats]:
        """Of these voxels, those that the vehicle may hide, and the points to aim rays at."""
        assert self._shadow is not None
        aims = positions_of(self._aims, index, shape, first)
        perhaps = np.flatnonzero(self._shadow.may_hide(*in_sensor_frame(self._axes, aims)))
        return index[perhaps], aims[perhaps]


def _sides(axes: Floats, wide: tuple[float, float], high: tuple[float, float]) -> list[Floats]:
    """Inward unit normals, ground axes, of the pyramid with these slopes to the left and up."""
    forward, left, up = axes.T
    normals = [
        sign * (axis - slope * forward)
        for axis, slopes in ((left, wide), (up, high))
        for sign, slope in zip((1.0, -1.0), slopes, strict=True)
    ]
    return [n / np.sqrt(dot(n, n)) for n in normals]


class BentPlanes(_AreaPlanes):
    """A mounted camera whose lens has distortion."""

    def __init__(
        self, camera: Camera, pose: Pose, space: PerceptionSpace, seen: VisibleMesh | None
    ) -> None:
        super().__init__(camera, pose, space, seen)
        self._sorter = Sorter(camera, space.interval)
        _, y, z = self._offsets
        self._seen_yz = [
            np.add.outer(axis[1] * y, axis[2] * z).astype(np.float32) for axis in self._axes.T
        ]
        self._square = np.add.outer(y * y, z * z).astype(np.float32)
        if seen is not None:
            self._cover = VoxelOcclusion(self._aims, seen, ALL_ROUND)

    def areas(self, planes: slice) -> VisibleRows:
        """Pixels covered by each voxel of the x-planes; rows out of view are left out."""
        rows = self._rows_in_view(planes)
        area, edge = self._sorted(planes, rows)
        first = planes.start, rows.start
        offsets = positions_of(self._offsets, edge, area.shape, first)
        exact = edge_areas(self._camera, self._axes, offsets, self._space.interval)
        area.reshape(-1)[edge] = exact
        if is_ranged(self._camera):
            cut_to_range(self._camera, area, self._offsets, first)
        if self._cover is not None:
            self._hide_by_rays(area, *self._hide_surely(area, first))
        return VisibleRows(rows, area)

    def _rows_in_view(self, planes: slice) -> slice:
        """Rows (y) with a voxel that may touch the field, on any of the planes. The cosine of the
        angle from the axis is at most maximum depth over minimum distance."""
        x = self._offsets[0][planes]
        y = self._offsets[1]
        z = self._offsets[2]
        forward = self._axes[:, 0]
        ball = BALL * self._space.interval
        depth = max(forward[0] * x[0], forward[0] * x[-1]) + forward[1] * y
        depth = depth + max(forward[2] * z[0], forward[2] * z[-1])
        near = _least(x) ** 2 + y * y + _least(z) ** 2
        far = np.max(x * x) + y * y + np.max(z * z)
        cosine = np.cos(min(self._sorter.lens.outer, np.pi))
        distance = np.sqrt(near if cosine > 0.0 else far)
        return span(depth + 2.0 * ball >= cosine * distance - 2.0 * ball)

    def _sorted(self, planes: slice, rows: slice) -> tuple[Singles, Ints]:
        """Areas by the closed form, 0 where it does not apply; and the indices of border voxels."""
        x = self._offsets[0][planes]
        area = np.empty((len(x), *self._square[rows].shape), np.float32)
        edges = []
        for number, (plane, here) in enumerate(zip(area, x.tolist(), strict=True)):
            depth, left, up = (
                yz[rows] + np.float32(axis[0] * here)
                for yz, axis in zip(self._seen_yz, self._axes.T, strict=True)
            )
            distance = np.sqrt(self._square[rows] + np.float32(here * here))
            away = self._away[rows] + np.float32(
                distance_along(np.array(here), self._space.interval)
            )
            found = self._sorter.sort(depth, left, up, distance, away=away)
            np.multiply(found.area, found.plain, out=plane)
            edges.append(np.flatnonzero(found.edge) + number * plane.size)
        return area, np.concatenate(edges) if edges else np.zeros(0, np.int64)


def _least(offsets: Floats) -> float:
    """Minimum distance from 0 of ascending coordinates, and of the range between them."""
    inside = offsets[0] < 0.0 < offsets[-1]
    return 0.0 if inside else float(np.min(np.abs(offsets)))

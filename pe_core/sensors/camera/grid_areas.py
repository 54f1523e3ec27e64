"""Pixel areas of the voxels of a run of x-planes.

Where a column of voxels (along z) enters and leaves the picture follows from the four sides of the
frustum. The voxels between are filled with the closed form of `camera.points`, in single precision;
depth and the faces' distances are a term of x and one of y and z, which all planes share. Voxels on
the picture's border, near the camera, or perhaps behind the vehicle are listed from such sides as
well, and handed to the exact functions, all of a run at once. Where the vehicle may hide very many,
`camera.cover_shadow` tells most of them without a ray.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids import PerceptionSpace
from ...geometry.indexing import count_up
from ...geometry.poses import Pose, dot
from ...metric.fusion import VisibleRows
from ...scene.vehicle import VisibleMesh
from .definition import cut_to_range, hidden, is_ranged
from .model import Camera
from .picture import BORDER, PictureBins
from .pixel_area import clipped_pixel_area, in_sensor_frame
from .sample_areas import NEAR_SIDES
from .tie_rules import MARGIN, NUDGE, aims_at, axes_of, offsets_of
from .voxel_occlusion import VoxelOcclusion, places_of, span_of

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int64]
HalfSpace = tuple[Floats, float]
"""A direction, and how far along it from the camera a voxel's centre has to be [m]."""

MANY_RAYS = 50_000
"""Rays in a run of planes from about which on a map of what the vehicle covers saves time."""
ASKED = 16
"""Of so many voxels one is asked, to tell how many the vehicle may hide."""
LEVEL = 1e-12
"""Least slope along z of a side of the frustum, so that it can be divided by."""


class ColumnRuns(NamedTuple):
    """A run of voxels in each column (along z), `first` to before `end`, (n, rows) each."""

    first: Ints
    end: Ints

    def within(self, outer: ColumnRuns) -> ColumnRuns:
        """Cut to the outer runs; an empty one is put at the outer one's end."""
        first = np.clip(self.first, outer.first, outer.end)
        end = np.clip(self.end, first, outer.end)
        empty = first == end
        return ColumnRuns(np.where(empty, outer.end, first), np.where(empty, outer.end, end))

    def listed(self, nz: int) -> Ints:
        """Numbers (V,) of all voxels of the runs, counted through planes, rows and heights."""
        first, end = self.first.reshape(-1), self.end.reshape(-1)
        some = np.flatnonzero(end > first)
        counts = end[some] - first[some]
        return np.repeat(some * nz + first[some], counts) + count_up(counts)


class CameraPlanes:
    """A mounted camera, ready to measure a space plane by plane.

    Parameters
    ----------
    camera : Camera
    pose : Pose
    space : PerceptionSpace
    seen : VisibleMesh, optional
        The vehicle from the camera's position.
    """

    def __init__(
        self, camera: Camera, pose: Pose, space: PerceptionSpace, seen: VisibleMesh | None
    ) -> None:
        self._camera, self._space, self._seen = camera, space, seen
        side, self._axes = space.interval, axes_of(pose)
        self._offsets = [offsets_of(space.centers(k), pose.position[k], side) for k in range(3)]
        self._aims = [aims_at(w, side, NUDGE[k]) for k, w in enumerate(self._offsets)]
        self._forward = self._axes[:, 0]
        wide, high = _slopes(camera)
        self._sides = _sides(self._axes, wide, high)
        _, y, z = self._offsets
        self._depth = np.add.outer(self._forward[1] * y, self._forward[2] * z).astype(np.float32)
        self._away = np.add.outer(self._away_from(y), self._away_from(z)).astype(np.float32)
        below = np.tri(len(z) + 1, len(z), -1, dtype=np.int32)  # row k: 1 for heights below k
        self._keep_below, self._keep_from = -below, below - 1  # masks: all bits, or none
        self._shadow = self._cover = None
        if seen is not None:
            self._shadow = PictureBins(camera, self._axes, seen.seen.triangles)
            widest = (max(abs(low), top) for low, top in (wide, high))
            self._cover = VoxelOcclusion(self._aims, seen, self._corners(*widest))

    def areas(self, planes: slice) -> VisibleRows:
        """Pixels covered by each voxel of the x-planes; without rows where the camera sees none."""
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
        self._settle_edges(area, edge, (planes.start, rows.start))
        if is_ranged(self._camera):
            cut_to_range(self._camera, area, self._offsets, (planes.start, rows.start))
        if self._shadow is not None:
            asked = np.concatenate([edge, self._shaded(planes, rows, plain).listed(nz)])
            self._settle_hidden(area, asked, (planes.start, rows.start))
        return VisibleRows(rows, area)

    def _shaded(self, planes: slice, rows: slice, plain: ColumnRuns) -> ColumnRuns:
        """Those of the voxels inside the picture that lie where triangles fall into the map."""
        assert self._shadow is not None
        if self._shadow.empty:
            return ColumnRuns(plain.end, plain.end)
        sides = _sides(self._axes, *self._shadow.extent)
        return self._runs(planes, rows, [(n, -MARGIN) for n in sides]).within(plain)

    def _corners(self, wide: float, high: float) -> Floats:
        """Directions (4, 3) to the corners of the shadow's map."""
        forward, left, up = self._axes.T
        ends = [(i * BORDER * wide, j * BORDER * high) for i in (-1.0, 1.0) for j in (-1.0, 1.0)]
        return np.array([forward + a * left + b * up for a, b in ends])

    def _away_from(self, offset: Floats) -> Floats:
        """Distance along an axis from the camera to the nearer face across it; 0 inside."""
        return np.maximum(np.abs(offset) - self._space.interval / 2.0, 0.0)

    def _at_sides(self, radii: float) -> list[HalfSpace]:
        """Half spaces of voxels inside the frustum's sides by so many of their own radii."""
        return [(n, radii * self._radius(n)) for n in self._sides]

    def _radius(self, normal: Floats) -> float:
        """How far a voxel reaches along a direction [m]."""
        return (float(np.abs(normal).sum()) / 2.0 + MARGIN) * self._space.interval

    def _rows_in_view(self, planes: slice) -> slice:
        """Rows (y) that may touch the picture, on some of the planes and at some height."""
        x, y, z = self._offsets[0][planes], self._offsets[1], self._offsets[2]
        inside = np.ones(len(y), bool)
        for n, least in [(self._forward, 0.0), *self._at_sides(-1.0)]:
            most = max(n[0] * x[0], n[0] * x[-1]) + max(n[2] * z[0], n[2] * z[-1])
            inside &= n[1] * y > least - most
        return span_of(inside)

    def _runs(self, planes: slice, rows: slice, half_spaces: list[HalfSpace]) -> ColumnRuns:
        """Voxels that lie in all half spaces."""
        x, y = self._offsets[0][planes], self._offsets[1][rows]
        nz, step = len(self._offsets[2]), self._space.interval
        lowest = self._offsets[2][0] / step
        low, high = np.zeros((len(x), len(y))), np.full((len(x), len(y)), float(nz))
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
        """Areas of small flat faces in the runs, see `camera.points`; 0 elsewhere."""
        depth, away = self._depth[rows], self._away[rows]
        x = self._offsets[0][planes]
        area = np.empty((len(x), *depth.shape), np.float32)
        held = np.empty_like(depth)
        for plane, x_depth, x_away, first, end in zip(
            area, self._forward[0] * x, self._away_from(x), *plain, strict=True
        ):
            some = span_of(first < end)
            plane[: some.start] = 0.0
            plane[some.stop :] = 0.0
            self._flat(plane[some], held[some], (depth[some], x_depth), (away[some], x_away))
            bits = plane[some].view(np.int32)
            bits &= self._keep_from[first[some]]
            bits &= self._keep_below[end[some]]
        return area

    def _flat(
        self,
        out: Singles,
        cube: Singles,
        depth: tuple[Singles, float],
        away: tuple[Singles, float],
    ) -> None:
        """Area of small faces; `depth` and `away` in two terms, `cube` for the depth's cube."""
        side = self._space.interval
        np.add(depth[0], np.float32(depth[1]), out=out)
        np.maximum(out, np.float32(NEAR_SIDES * side), out=out)  # nearer ones are not for this form
        np.multiply(out, out, out=cube)
        cube -= np.float32(side * side / 2.0)
        cube *= out
        np.add(away[0], np.float32(away[1] + 1.5 * side), out=out)
        out *= np.float32((self._camera.focal_px * side) ** 2)
        out /= cube

    def _settle_edges(self, area: Singles, index: Ints, first: tuple[int, int]) -> None:
        """Measure voxels on the picture's border, and near ones, exactly."""
        offsets = places_of(self._offsets, index, area.shape, first)
        exact = clipped_pixel_area(self._camera, self._axes, offsets, self._space.interval)
        area.reshape(-1)[index] = exact

    def _settle_hidden(self, area: Singles, index: Ints, first: tuple[int, int]) -> None:
        """Set the areas of those voxels to 0 that the vehicle does hide."""
        assert self._seen is not None
        index = index[area.reshape(-1)[index] > 0.0]
        if len(index) > MANY_RAYS and self._many_perhaps(index, area.shape, first):
            index, aims = self._unsure(area, first)
        else:
            index, aims = self._perhaps(index, area.shape, first)
        area.reshape(-1)[index[hidden(self._seen, aims)]] = 0.0

    def _many_perhaps(self, index: Ints, shape: tuple[int, ...], first: tuple[int, int]) -> bool:
        """Whether the vehicle may hide very many of some voxels, to judge by some of those."""
        some, _ = self._perhaps(index[::ASKED], shape, first)
        return len(some) * ASKED > MANY_RAYS

    def _perhaps(
        self, index: Ints, shape: tuple[int, ...], first: tuple[int, int]
    ) -> tuple[Ints, Floats]:
        """Those of some voxels that the vehicle may hide, and where the rays to them aim at."""
        assert self._shadow is not None
        aims = places_of(self._aims, index, shape, first)
        perhaps = np.flatnonzero(self._shadow.may_hide(*in_sensor_frame(self._axes, aims)))
        return index[perhaps], aims[perhaps]

    def _unsure(self, area: Singles, first: tuple[int, int]) -> tuple[Ints, Floats]:
        """Set what is surely hidden to 0; the seen voxels not sure, and where rays aim at."""
        assert self._cover is not None
        planes, rows = (slice(f, f + n) for f, n in zip(first, area.shape[:2], strict=True))
        shade = self._cover.judge(planes, rows)
        np.copyto(area, 0.0, where=shade.hidden)
        index = np.flatnonzero(shade.unsure)
        index = index[area.reshape(-1)[index] > 0.0]
        return index, places_of(self._aims, index, area.shape, first)


def _slopes(camera: Camera) -> tuple[tuple[float, float], tuple[float, float]]:
    """Least and greatest left / depth, and up / depth, of the picture."""
    lens = camera.projection
    wide = -(camera.width - lens.cx) / lens.fx, lens.cx / lens.fx
    return wide, (-(camera.height - lens.cy) / lens.fy, lens.cy / lens.fy)


def _sides(axes: Floats, wide: tuple[float, float], high: tuple[float, float]) -> list[Floats]:
    """Inward unit normals, ground axes, of the pyramid of these slopes to the left and up."""
    forward, left, up = axes.T
    normals = [
        sign * (axis - slope * forward)
        for axis, slopes in ((left, wide), (up, high))
        for sign, slope in zip((1.0, -1.0), slopes, strict=True)
    ]
    return [n / np.sqrt(dot(n, n)) for n in normals]

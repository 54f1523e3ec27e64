"""Pixel areas of all voxels of consecutive x-planes, through a lens with distortion.

The voxels of each plane are classified as in `sample_areas`, in single precision. Voxels on the
border of the field of view get the exact area, all planes at once. `voxel_occlusion` decides for
most voxels whether the vehicle hides them; it covers all directions.
"""

from __future__ import annotations

import numpy as np

from ...base.arrays import Floats, Ints, Singles
from ...geometry.grids import PerceptionSpace
from ...geometry.poses import Pose
from ...metric.fusion import VisibleRows
from ...scene.vehicle import VisibleMesh
from .bent_area import BALL
from .definition import cut_to_range, hidden, is_ranged
from .model import Camera
from .sample_areas import Sorter, edge_areas
from .tie_rules import NUDGE, aims_at, axes_of, offsets_of
from .voxel_occlusion import VoxelOcclusion, distance_along, positions_of, span

ALL_ROUND = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
"""The directions that `VoxelOcclusion` gets as corners of the picture: they include all sides."""


class BentPlanes:
    """A mounted camera whose lens has distortion; parameters as of `grid_areas.CameraPlanes`."""

    def __init__(
        self, camera: Camera, pose: Pose, space: PerceptionSpace, seen: VisibleMesh | None
    ) -> None:
        self._camera, self._space, self._seen = camera, space, seen
        side, self._axes = space.interval, axes_of(pose)
        self._sorter = Sorter(camera, side)
        self._offsets = [offsets_of(space.centers(k), pose.position[k], side) for k in range(3)]
        self._aims = [aims_at(w, side, NUDGE[k]) for k, w in enumerate(self._offsets)]
        _, y, z = self._offsets
        self._seen_yz = [
            np.add.outer(axis[1] * y, axis[2] * z).astype(np.float32) for axis in self._axes.T
        ]
        self._square = np.add.outer(y * y, z * z).astype(np.float32)
        self._away = np.add.outer(distance_along(y, side), distance_along(z, side)).astype(
            np.float32
        )
        self._cover = None if seen is None else VoxelOcclusion(self._aims, seen, ALL_ROUND)

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
            self._settle_hidden(area, first)
        return VisibleRows(rows, area)

    def _rows_in_view(self, planes: slice) -> slice:
        """Rows (y) with a voxel that may touch the field, on any of the planes.

        The cosine of the angle from the axis is at most maximum depth over minimum distance.
        """
        x, y, z = self._offsets[0][planes], self._offsets[1], self._offsets[2]
        forward, ball = self._axes[:, 0], BALL * self._space.interval
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
            found = self._sorter.sort(depth, left, up, distance, away)
            np.multiply(found.area, found.plain, out=plane)
            edges.append(np.flatnonzero(found.edge) + number * plane.size)
        return area, np.concatenate(edges) if edges else np.zeros(0, np.int64)

    def _settle_hidden(self, area: Singles, first: tuple[int, int]) -> None:
        """Set the areas of the voxels that the vehicle hides to 0."""
        assert self._cover is not None and self._seen is not None
        planes, rows = (slice(f, f + n) for f, n in zip(first, area.shape[:2], strict=True))
        flags = self._cover.classify(planes, rows)
        np.copyto(area, 0.0, where=flags.hidden)
        index = np.flatnonzero(flags.unsure)
        index = index[area.reshape(-1)[index] > 0.0]
        aims = positions_of(self._aims, index, area.shape, first)
        area.reshape(-1)[index[hidden(self._seen, aims)]] = 0.0


def _least(offsets: Floats) -> float:
    """Minimum distance from 0 of ascending coordinates, and of the range between them."""
    inside = offsets[0] < 0.0 < offsets[-1]
    return 0.0 if inside else float(np.min(np.abs(offsets)))

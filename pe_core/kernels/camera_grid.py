"""Pixel areas of the voxels of a run of x-planes.

Plane by plane, and of a plane the rows in view only; the flat form of `camera_points` in single
precision, where depth, left and up are sums of a term of y and a term of z. Voxels on the picture's
border, near the camera, or perhaps behind the vehicle are handed to the exact functions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry import Pose
from ..sensors import Camera
from ..space import PerceptionSpace
from ..vehicle import SeenMesh
from .camera_area import clipped_pixel_area
from .camera_points import NEAR_SIDES, hidden
from .shadow import ShadowMap

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int64]

ROUNDING = 1.001
"""The ball round a voxel is taken this much larger, against single precision."""


class CameraPlanes:
    """A mounted camera, ready to measure a space plane by plane.

    Parameters
    ----------
    camera : Camera
    pose : Pose
    space : PerceptionSpace
    seen : SeenMesh, optional
        The vehicle from the camera's position.
    """

    def __init__(
        self, camera: Camera, pose: Pose, space: PerceptionSpace, seen: SeenMesh | None
    ) -> None:
        self._camera, self._pose, self._space, self._seen = camera, pose, space, seen
        self._axes = [space.centers(k) for k in range(3)]
        self._offsets = [w - pose.position[k] for k, w in enumerate(self._axes)]
        self._shadow = None if seen is None else ShadowMap(camera, pose, seen.seen.triangles)
        f, half_w, half_h = camera.focal_px, camera.width / 2.0, camera.height / 2.0
        forward, left, up = pose.ground_from_sensor.T
        sides = [
            (half * forward + sign * f * axis) / np.sqrt(half * half + f * f)
            for half, axis in ((half_w, left), (half_h, up))
            for sign in (1.0, -1.0)
        ]
        self._normals = np.array(sides)  # (4, 3) inward normals of the frustum, ground axes
        self._ball = ROUNDING * space.interval * np.sqrt(3.0) / 2.0

    def areas(self, planes: slice) -> Singles:
        """(n, ny, nz) pixels covered by each voxel of the x-planes."""
        first, last, _ = planes.indices(self._space.shape[0])
        area = np.zeros((last - first, *self._space.shape[1:]), np.float32)
        flat = area.reshape(-1)
        edges, behind = [], []
        for n, i in enumerate(range(first, last)):
            rows = self._rows_in_view(self._offsets[0][i])
            if rows.stop > rows.start:
                start = (n * area.shape[1] + rows.start) * area.shape[2]
                edge, hidden_perhaps = self._fill(area[n, rows], i, rows)
                edges.append(edge + start)
                behind.append(hidden_perhaps + start)
        if edges:
            self._settle_edges(flat, np.concatenate(edges), first)
            self._settle_hidden(flat, np.concatenate(behind), first)
        return area

    def _rows_in_view(self, x: float) -> slice:
        """Rows (y) of the plane at offset x that may touch the frustum, at some height."""
        y, z = self._offsets[1], self._offsets[2]
        distance = np.full(len(y), np.inf)
        for n in self._normals:
            highest = max(n[2] * z[0], n[2] * z[-1])
            distance = np.minimum(distance, n[0] * x + n[1] * y + highest)
        seen = np.flatnonzero(distance > -self._ball)
        return slice(int(seen[0]), int(seen[-1]) + 1) if len(seen) else slice(0, 0)

    def _fill(self, out: Singles, i: int, rows: slice) -> tuple[Ints, Ints]:
        """Measure some rows of plane i into `out` (n, nz), where the flat form is good.

        Returns the voxels, numbered within the rows, that need the exact area, and those that the
        vehicle may hide.
        """
        depth, left, up = (self._linear(axis, i, rows) for axis in self._pose.ground_from_sensor.T)
        distance = self._linear(self._normals[0], i, rows)
        for n in self._normals[1:]:
            np.minimum(distance, self._linear(n, i, rows), out=distance)
        plain = (distance > self._ball) & (depth > NEAR_SIDES * self._space.interval)
        touched = (distance > -self._ball) & (depth > 0.0)
        np.copyto(out, self._flat(depth, i, rows), where=plain)
        edge = np.flatnonzero(touched & ~plain)
        if self._shadow is None or self._shadow.empty:
            return edge, edge[:0]
        index = np.flatnonzero(touched)
        views = (w.reshape(-1)[index] for w in (depth, left, up))
        return edge, index[self._shadow.may_hide(*views)]

    def _settle_edges(self, area: Singles, index: Ints, first: int) -> None:
        """Measure voxels on the picture's border, and near ones, exactly."""
        centers = self._centers(index, first)
        area[index] = clipped_pixel_area(self._camera, self._pose, centers, self._space.interval)

    def _settle_hidden(self, area: Singles, index: Ints, first: int) -> None:
        """Set the areas of those voxels to 0 that the vehicle does hide."""
        if self._seen is not None and len(index):
            offsets = self._centers(index, first) - np.asarray(self._pose.position)
            area[index[hidden(self._seen, offsets)]] = 0.0

    def _linear(self, axis: Floats, i: int, rows: slice) -> Singles:
        """(n, nz) scalar product of an axis with the offsets of plane i's voxels."""
        x, y, z = self._offsets[0][i], self._offsets[1][rows], self._offsets[2]
        across, upward = axis[0] * x + axis[1] * y, axis[2] * z
        return across.astype(np.float32)[:, None] + upward.astype(np.float32)

    def _flat(self, depth: Singles, i: int, rows: slice) -> Singles:
        """(n, nz) areas of small flat faces, see `camera_points`."""
        side, forward = self._space.interval, self._pose.ground_from_sensor[:, 0]
        x = self._offsets[0][i : i + 1, None]
        y, z = self._offsets[1][rows, None], self._offsets[2][None, :]
        total = np.zeros_like(depth)
        scale = (self._camera.focal_px * side) ** 2
        for k, offset in enumerate((x, y, z)):
            away = scale * np.maximum(np.abs(offset) - side / 2.0, 0.0)
            nearer = np.sign(offset) * (side / 2.0 * forward[k])
            face_depth = np.maximum(depth - nearer.astype(np.float32), np.float32(side))
            total += away.astype(np.float32) / (face_depth * face_depth * face_depth)
        return total

    def _centers(self, index: Ints, first: int) -> Floats:
        """Centres (V, 3) of voxels numbered from plane `first` on."""
        _, ny, nz = self._space.shape
        x, y, z = self._axes
        return np.stack([x[first + index // (ny * nz)], y[index // nz % ny], z[index % nz]], axis=1)

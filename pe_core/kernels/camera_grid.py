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
        indices = range(*planes.indices(self._space.shape[0]))
        area = np.zeros((len(indices), *self._space.shape[1:]), np.float32)
        for out, i in zip(area, indices, strict=True):
            rows = self._rows_in_view(self._offsets[0][i])
            if rows.stop > rows.start:
                self._fill(out[rows], i, rows)
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

    def _fill(self, out: Singles, i: int, rows: slice) -> None:
        """Measure some rows of plane i into `out` (n, nz)."""
        side = self._space.interval
        depth, left, up = (self._linear(axis, i, rows) for axis in self._pose.ground_from_sensor.T)
        distance = self._linear(self._normals[0], i, rows)
        for n in self._normals[1:]:
            np.minimum(distance, self._linear(n, i, rows), out=distance)
        plain = (distance > self._ball) & (depth > NEAR_SIDES * side)
        edge = (distance > -self._ball) & (depth > 0.0) & ~plain
        np.copyto(out, self._flat(depth, i, rows), where=plain)
        flat = out.reshape(-1)
        index = np.flatnonzero(edge)
        flat[index] = clipped_pixel_area(
            self._camera, self._pose, self._centers(index, i, rows), side
        )
        if self._shadow is not None and not self._shadow.empty:
            self._hide(flat, depth.reshape(-1), left.reshape(-1), up.reshape(-1), i, rows)

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

    def _hide(
        self, area: Singles, depth: Singles, left: Singles, up: Singles, i: int, rows: slice
    ) -> None:
        """Set the areas of voxels behind the vehicle to 0."""
        assert self._shadow is not None and self._seen is not None
        index = np.flatnonzero(area)
        index = index[self._shadow.may_hide(depth[index], left[index], up[index])]
        if len(index):
            offsets = self._centers(index, i, rows) - np.asarray(self._pose.position)
            area[index[hidden(self._seen, offsets)]] = 0.0

    def _centers(self, index: NDArray[np.integer], i: int, rows: slice) -> Floats:
        """Centres (V, 3) of voxels numbered within some rows of plane i."""
        nz = len(self._axes[2])
        x = np.full(len(index), self._axes[0][i])
        return np.stack([x, self._axes[1][rows][index // nz], self._axes[2][index % nz]], axis=1)

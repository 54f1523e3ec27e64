"""Ground kernel of cameras: posts with a point in the picture that is not occluded.

Posts stand in the middles of squares. The visible ground is a region with an edge, so first one
square of each block is tested, then all squares of the blocks along the edge.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...scene.rig import Sensor
from ...scene.vehicle import VisibleMesh
from ..kernels import GroundKernel, GroundView, VisibleGround, heights_of_post
from .definition import hidden, is_ranged, out_of_range
from .model import Camera
from .picture import PictureBins
from .pixel_area import frustum_distance, in_sensor_frame
from .tie_rules import IN_FRONT, aims_at, axes_of

BLOCK_M = 0.125
"""Side of a block of squares: gaps between the middles of blocks are too narrow to count."""

ROOM_M = 1e-3
"""Balls round posts are enlarged by this."""


class CameraGround(GroundKernel):
    """Marks squares with a visible post in their middle."""

    def __init__(self, view: GroundView) -> None:
        self._view = view

    def mark(self, sensor: Sensor, approximate: bool) -> VisibleGround:
        """Test one post of each block, then the posts along the edges of the visible area."""
        grid = self._view.grid
        look = PostVisibility(sensor, self._view)
        side = max(1, int(BLOCK_M / grid.step + 1e-9))
        marked = np.zeros(grid.shape, bool)
        flat = marked.reshape(-1)
        i, j = (np.arange(side // 2, n + side // 2, side).clip(max=n - 1) for n in grid.shape)
        first = np.add.outer(i * grid.shape[1], j)
        seen = look.sees(first.reshape(-1)).reshape(first.shape)
        flat[first[seen]] = True
        along = np.repeat(np.repeat(_edges(seen), side, axis=0), side, axis=1)
        rest = np.flatnonzero(along[: grid.shape[0], : grid.shape[1]])
        flat[rest] = look.sees(rest)
        return VisibleGround(sensor, marked)


class PostVisibility:
    """Tests which posts a camera sees."""

    def __init__(self, sensor: Sensor, view: GroundView) -> None:
        self._camera, self._view = cast(Camera, sensor.model), view
        self._position, self._axes = np.asarray(sensor.pose.position), axes_of(sensor.pose)
        self._seen: VisibleMesh | None = None
        self._shadow: PictureBins | None = None
        if view.vehicle is not None:
            glass = self._camera.sees_through_glass
            self._seen = view.vehicle.seen_from(sensor.pose.position, glass)
            if self._camera.projection.is_straight:
                self._shadow = PictureBins(self._camera, self._axes, self._seen.seen.triangles)

    def sees(self, squares: Ints) -> Flags:
        """Whether a point of each post (N,) in the middle of its square is visible."""
        middles = self._view.grid.middles(squares) - self._position[:2]
        possible = self._may_see(middles)
        found = np.zeros(len(squares), bool)
        for z in heights_of_post(self._view.height).tolist():
            left = np.flatnonzero(possible & ~found)
            height = np.full(len(left), z - self._position[2])
            found[left] = self._sees_points(np.column_stack([middles[left], height]))
        return found

    def _may_see(self, middles: Floats) -> Flags:
        """Whether balls round posts (N, 2) reach into the view; true for every visible post."""
        radius = self._view.height / 2.0 + ROOM_M
        up = np.full(len(middles), self._view.height / 2.0 - self._position[2])
        depth, aside, high = in_sensor_frame(self._axes, np.column_stack([middles, up]))
        if self._camera.projection.is_straight:
            away = frustum_distance(self._camera, depth, aside, high)
            return np.asarray((away > -radius) & (depth > -radius))
        flat = np.hypot(aside, high)
        distance = np.hypot(flat, depth)
        wide = np.arcsin(np.minimum(radius / np.maximum(distance, radius), 1.0))
        outside = np.arctan2(flat, depth) - wide > self._camera.projection.edge
        return np.asarray(~outside | (distance <= radius))

    def _sees_points(self, offsets: Floats) -> Flags:
        """Whether points (N, 3) from the camera are in the picture, in range, and not hidden."""
        depth, left, up = in_sensor_frame(self._axes, offsets)
        shown = self._shows(depth, left, up)
        if is_ranged(self._camera):
            shown &= ~out_of_range(self._camera, offsets)
        if self._seen is None:
            return shown
        asked = np.flatnonzero(shown)
        if self._shadow is not None:
            asked = asked[self._shadow.may_hide(depth[asked], left[asked], up[asked])]
        shown[asked] = ~hidden(self._seen, aims_at(offsets[asked], self._view.grid.step))
        return shown

    def _shows(self, depth: Floats, left: Floats, up: Floats) -> Flags:
        """Whether points are within the lens's field and in the picture."""
        camera, lens = self._camera, self._camera.projection
        if lens.is_straight:
            inside = frustum_distance(camera, depth, left, up) >= 0.0
            return np.asarray(inside & (depth > IN_FRONT))
        flat = np.hypot(left, up)
        right, down = lens.project(depth, left, up)
        inside = (right >= 0.0) & (right <= camera.width)
        inside &= (down >= 0.0) & (down <= camera.height)
        return np.asarray(inside & (np.arctan2(flat, depth) <= lens.edge))


def _edges(seen: Flags) -> Flags:
    """Blocks with a neighbour of the other state, visible or not; corners count as neighbours."""
    return _beside(seen) & _beside(~seen)


def _beside(flags: Flags) -> Flags:
    """Set the flagged cells and all their neighbours."""
    found = flags.copy()
    for axis in (0, 1):
        moved = np.moveaxis(found, axis, 0)
        both = moved.copy()
        both[1:] |= moved[:-1]
        both[:-1] |= moved[1:]
        found = np.moveaxis(both, 0, axis)
    return found

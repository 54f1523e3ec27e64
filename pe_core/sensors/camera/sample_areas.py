"""Pixel areas of sampled voxels: a closed form where it is accurate, the exact area elsewhere.

A distant face is a small flat patch. Its image has the area ``f^2 |n . r| A / depth^3``, with its
normal n, its area A and the vector r from the camera to its centre. The sum over the faces of a
cube of side s at r is ``f^2 s^2 (a + 3 s / 2) / (depth^3 - depth s^2 / 2)``, where a is the sum
over the axes of ``max(|r_k| - s / 2, 0)``. The first order in s / depth is exact; the second is a
mean over directions. The closed form does not clip at the picture's border: voxels there, or nearer
than NEAR_SIDES sides, get the exact area.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from ...geometry.poses import Pose, dot
from ...scene.vehicle import VisibleMesh
from .bent_area import BALL, bent_pixel_area
from .definition import hidden, is_ranged, out_of_range
from .lens_lookup import Array, QuickLens
from .model import Camera
from .pixel_area import clipped_pixel_area, frustum_distance, in_sensor_frame, in_view
from .tie_rules import MARGIN, aims_at, axes_of, offsets_of

NEAR_SIDES = 15.0
"""Depth in voxel sides below which the exact area is used: the error of the closed form is then at
most 0.3 %."""


def pixel_areas(
    camera: Camera, pose: Pose, centers: Floats, side: float, seen: VisibleMesh | None
) -> Floats:
    """(V,) pixels covered by each voxel; 0 where the vehicle hides its centre.

    Parameters
    ----------
    camera : Camera
    pose : Pose
    centers : (V, 3) float
        Ground frame [m].
    side : float
        Side of a voxel [m].
    seen : VisibleMesh, optional
        The vehicle from the camera's position.
    """
    axes, area = axes_of(pose), np.zeros(len(centers))
    roughly = in_sensor_frame(axes, centers - np.asarray(pose.position))
    index = np.flatnonzero(in_view(camera, *roughly, side))
    offsets = offsets_of(centers[index], pose.position, side)
    found = _areas_in_view(camera, axes, offsets, side)
    if is_ranged(camera):
        found[out_of_range(camera, offsets)] = 0.0
    if seen is not None:
        visible = np.flatnonzero(found)
        found[visible[hidden(seen, aims_at(offsets[visible], side))]] = 0.0
    area[index] = found
    return area


def _areas_in_view(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    depth, left, up = in_sensor_frame(axes, offsets)
    plain = depth > (NEAR_SIDES + MARGIN) * side
    plain &= frustum_distance(camera, depth, left, up) > (BALL + MARGIN) * side
    area = np.empty(len(offsets))
    area[plain] = _flat_area(camera, offsets[plain], depth[plain], side)
    area[~plain] = clipped_pixel_area(camera, axes, offsets[~plain], side)
    return area


def _flat_area(camera: Camera, offsets: Floats, depth: Floats, side: float) -> Floats:
    away = [np.maximum(np.abs(offsets[:, k]) - side / 2.0, 0.0) for k in range(3)]
    cube = (depth * depth - side * side / 2.0) * depth
    return (camera.focal_px * side) ** 2 * (away[0] + away[1] + away[2] + 1.5 * side) / cube


Mask = NDArray[np.bool_]

FAR_PIECES = 4
"""Straight pieces of an edge of a far voxel: the edge covers at most 4 degrees, a piece 1."""
NEAR = NEAR_SIDES + MARGIN
UNEVEN = 0.003
"""Maximum relative change of pixels per steradian over a voxel for the closed form, which uses the
value in the middle; near the fold of a lens the change is larger."""
ROOM = 1.02
"""Factor on a voxel's radius: rounding in single precision, and the oblique view of a ball."""
ROOM_PX = 1.0


class Sorted(NamedTuple):
    """Classified voxels: accurate in closed form (`plain`), or perhaps on the border (`edge`).

    `area` are the areas of the closed form.
    """

    plain: Mask
    edge: Mask
    area: Array


class Sorter:
    """Classifies voxels: out of view, accurate in closed form, or to be measured exactly."""

    def __init__(self, camera: Camera, side: float) -> None:
        lens = camera.projection
        self.lens, self._side = QuickLens(camera), side
        self._size = camera.width, camera.height
        self._edge, self._outer = np.cos(lens.edge), np.cos(self.lens.outer)
        self._cut = self.lens.outer >= lens.edge

    def sort(self, depth: Array, left: Array, up: Array, distance: Array, away: Array) -> Sorted:
        """Classify voxels by their centres, camera's axes; `away` is a of the closed form."""
        side = np.float32(self._side)
        far = distance > np.float32(NEAR * self._side)
        per = np.float32(1.0) / np.maximum(distance, side)
        cosine, ball = depth * per, np.float32(BALL * ROOM) * side * per
        seen = self.lens.seen(cosine, depth, left, up, per)
        reach = seen.stretch * ball + np.float32(ROOM_PX)
        room = self._room(seen.right, seen.down)
        out = (cosine < np.float32(self._outer) - ball) | (room < -reach)
        plain = far & (room > reach) & ~out
        plain &= seen.uneven * (side * per) ** 2 < np.float32(UNEVEN)
        if self._cut:
            plain &= cosine > np.float32(self._edge) + ball
        area = (seen.density * side * side) * (away + np.float32(1.5) * side) * per**3
        return Sorted(plain, ~plain & ~(out & far), area)

    def _room(self, right: Array, down: Array) -> Array:
        """Distance of positions from the picture's border [px]; negative outside."""
        wide, high = (np.float32(n / 2.0) for n in self._size)
        return np.minimum(wide - np.abs(right - wide), high - np.abs(down - high))


def bent_pixel_areas(
    camera: Camera, pose: Pose, centers: Floats, side: float, seen: VisibleMesh | None
) -> Floats:
    """(V,) pixels covered by each voxel, as `pixel_areas`, through a lens with distortion."""
    axes, offsets = axes_of(pose), offsets_of(centers, pose.position, side)
    distance = np.sqrt(dot(offsets, offsets))
    away = np.maximum(np.abs(offsets) - side / 2.0, 0.0).sum(axis=1)
    found = Sorter(camera, side).sort(*in_sensor_frame(axes, offsets), distance, away)
    area = np.where(found.plain & ~out_of_range(camera, offsets), found.area, 0.0)
    edge = np.flatnonzero(found.edge & ~out_of_range(camera, offsets))
    area[edge] = edge_areas(camera, axes, offsets[edge], side)
    if seen is not None:
        visible = np.flatnonzero(area)
        area[visible[hidden(seen, aims_at(offsets[visible], side))]] = 0.0
    return area


def edge_areas(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    """Areas (V,) by the definition; distant cubes have fewer pieces an edge."""
    area = np.empty(len(offsets))
    far = dot(offsets, offsets) > (NEAR * side) ** 2
    area[far] = bent_pixel_area(camera, axes, offsets[far], side, FAR_PIECES)
    area[~far] = bent_pixel_area(camera, axes, offsets[~far], side)
    return area

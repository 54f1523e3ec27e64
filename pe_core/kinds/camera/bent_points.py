"""Pixel areas of voxels through a lens that bends: a closed form where it is good.

From afar a cube of side s at distance r takes ``s^2 (a + 3 s / 2) / r^3`` steradians, where a is
the sum over the axes of ``max(|r_k| - s / 2, 0)``, and its image is that times the lens's pixels a
steradian. Voxels on the border of what is seen, nearer than NEAR_SIDES sides, or where the lens is
UNEVEN, get the area of the definition, far ones with fewer pieces an edge.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import Pose, dot
from ...scene.vehicle import SeenMesh
from .area import in_sensor_frame
from .bent_area import BALL, bent_pixel_area
from .definition import hidden
from .model import Camera
from .points import NEAR_SIDES
from .quick_lens import Array, QuickLens
from .ranged import out_of_range
from .ties import MARGIN, aims_at, axes_of, offsets_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

FAR_PIECES = 4
"""Straight pieces for an edge of a far voxel: it takes 4 degrees at most, a piece of it 1."""
NEAR = NEAR_SIDES + MARGIN
UNEVEN = 0.003
"""Where pixels a steradian change by more over a voxel, as near the fold of a lens, the closed form
is not good: it takes those of the middle."""
ROOM = 1.02
"""Times a voxel's radius: single precision's rounding, and a ball seen at a slant."""
ROOM_PX = 1.0


class Sorted(NamedTuple):
    """Of some voxels: which the closed form is good for, which may be on the border, and areas.

    The areas are those of the closed form.
    """

    plain: Mask
    edge: Mask
    area: Array


class Sorter:
    """Sorts voxels by what a camera sees of them: nothing, all, or it has to be looked at."""

    def __init__(self, camera: Camera, side: float) -> None:
        lens = camera.projection
        self.lens, self._side = QuickLens(camera), side
        self._size = camera.width, camera.height
        self._edge, self._outer = np.cos(lens.edge), np.cos(self.lens.outer)
        self._cut = self.lens.outer >= lens.edge

    def sort(self, depth: Array, left: Array, up: Array, distance: Array, away: Array) -> Sorted:
        """Sort voxels by their centres as the camera sees them; `away` is a of the closed form."""
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
        """How far inside the picture places are [px]; below 0 outside."""
        wide, high = (np.float32(n / 2.0) for n in self._size)
        return np.minimum(wide - np.abs(right - wide), high - np.abs(down - high))


def bent_pixel_areas(
    camera: Camera, pose: Pose, centers: Floats, side: float, seen: SeenMesh | None
) -> Floats:
    """(V,) pixels covered by each voxel; as `points.pixel_areas`, through a lens that bends."""
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
    """Areas (V,) by the definition, with few pieces where that is enough."""
    area = np.empty(len(offsets))
    far = dot(offsets, offsets) > (NEAR * side) ** 2
    area[far] = bent_pixel_area(camera, axes, offsets[far], side, FAR_PIECES)
    area[~far] = bent_pixel_area(camera, axes, offsets[~far], side)
    return area

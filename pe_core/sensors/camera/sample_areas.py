"""Pixel areas of sampled voxels: a closed form where it is accurate, the exact area elsewhere.

A distant face is a small flat patch. Its image has the area ``f^2 |n . r| A / depth^3``, with its
normal n, its area A and the vector r from the camera to its centre. The sum over the faces of a
cube of side s at r is ``f^2 s^2 (a + 3 s / 2) / (depth^3 - depth s^2 / 2)``, where a is the sum
over the axes of ``max(|r_k| - s / 2, 0)``. The first order in s / depth is exact; the second is a
mean over directions. The closed form does not clip at the picture's border: voxels there, or nearer
than NEAR_SIDES sides, get the exact area.

A lens with distortion depends only on the cosine of the angle from its axis. Tables over it
(`QuickLens`) need neither an arc tangent nor a polynomial for each voxel. They are exact to a few
parts in ten thousand.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from ...geometry.poses import Pose, dot
from ...scene.vehicle import VisibleMesh
from .definition import (
    BALL,
    MARGIN,
    aims_at,
    axes_of,
    bent_pixel_area,
    clipped_pixel_area,
    frustum_distance,
    hidden,
    in_sensor_frame,
    in_view,
    is_ranged,
    offsets_of,
    out_of_range,
)
from .lens import BrownConrady, Lens
from .model import Camera

Array = NDArray[np.floating]
ENTRIES = 1 << 15
BEYOND = 0.12
"""Angle beyond the picture up to which a lens is tabulated [rad]."""
NEAREST_RAD = 0.06  # Maximum angular radius of a voxel for the tables
MEAN_OFF = 0.07
"""A quarter of the mean squared distance of points in a cube's image, as a share of s^2 / r^2."""
ANGLES = 4096  # Number of angles at which the unevenness of the density is computed
BORDER_PLACES = 33
"""Points on each side of the picture, to find the maximum angle from the axis."""
NEAR_SIDES = 15.0
"""Depth in voxel sides below which the exact area is used: the error of the closed form is then at
most 0.3 %."""
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


class Imaged(NamedTuple):
    """Voxels through a lens: image position right and down [px], and pixels per steradian.

    `stretch` is the maximum of pixels per radian between the axis and the far side of a voxel.
    `uneven`, times the squared angular width of a voxel [rad^2], bounds how far the density at its
    centre is from the mean over the voxel, relative to that mean.
    """

    right: Array
    down: Array
    density: Array
    stretch: Array
    uneven: Array


class QuickLens:
    """A camera's lens in tables. `outer` is the maximum angle from the axis that the picture shows
    [rad]."""

    def __init__(self, camera: Camera) -> None:
        lens = self._lens = camera.projection
        self.outer = min(lens.edge, _widest_in(camera))
        last = min(self.outer + BEYOND, math.pi - 1e-3)
        self._per_cosine = (ENTRIES - 1) / (1.0 - math.cos(last))
        cosine = 1.0 - (np.arange(ENTRIES) + 0.5) / self._per_cosine
        theta = np.maximum(np.arccos(np.clip(cosine, -1.0, 1.0)), 1e-6)
        inside = np.minimum(theta, lens.edge)
        sine = np.sin(theta)
        slope = lens.slope(inside)
        around = (lens.radius(inside) + slope * (theta - inside)) / sine
        most = np.maximum.accumulate(np.maximum(around, slope)) * max(lens.fx, lens.fy)
        farther = np.minimum(theta + NEAREST_RAD, theta[-1])
        self._stretch = (1.1 * np.interp(farther, theta, most)).astype(np.float32)
        self._around = around.astype(np.float32)
        self._density = (lens.fx * lens.fy * around * slope).astype(np.float32)
        self._uneven = np.interp(theta, *_unevenness(lens, last)).astype(np.float32)
        self._tilt = self._tilted(lens, inside) if isinstance(lens, BrownConrady) else None

    def _tilted(self, lens: BrownConrady, theta: Floats) -> Array | None:
        """Density added by the tangential part, per unit of p1 times down plus p2 times right."""
        if not lens.shifts:
            return None
        r = np.tan(theta)
        both = 6.0 * lens.radius(theta) / r + 2.0 * lens.slope(theta) / (1.0 + r * r)
        added = lens.fx * lens.fy * (1.0 + r * r) ** 1.5 * both * r / np.sin(theta)
        return np.asarray(added.astype(np.float32))

    def seen(self, cosine: Array, depth: Array, left: Array, up: Array, per: Array) -> Imaged:
        """Return the images of voxels from the cosine of their angle; `per` is 1 / distance."""
        lens = self._lens
        entry = ((1.0 - cosine) * np.float32(self._per_cosine)).astype(np.int32)
        around = np.take(self._around, entry, mode="clip") * per
        x = around * -left
        y = around * -up
        density = np.take(self._density, entry, mode="clip")
        if self._tilt is not None and isinstance(lens, BrownConrady):
            tilt = np.take(self._tilt, entry, mode="clip")
            density -= tilt * per * (np.float32(lens.p1) * up + np.float32(lens.p2) * left)
            safe = np.maximum(depth, np.float32(1e-3))
            e = -left / safe
            n = -up / safe
            square = e * e + n * n
            both = np.float32(2.0) * e * n
            p1 = np.float32(lens.p1)
            p2 = np.float32(lens.p2)
            x = x + (p1 * both + p2 * (square + 2 * e * e))
            y = y + (p1 * (square + 2 * n * n) + p2 * both)
        focal = np.float32(lens.fx), np.float32(lens.fy)
        right = np.float32(lens.cx) + focal[0] * x
        down = np.float32(lens.cy) + focal[1] * y
        tables = (self._stretch, self._uneven)
        return Imaged(right, down, density, *(np.take(t, entry, mode="clip") for t in tables))


def _unevenness(lens: Lens, last: float) -> tuple[Floats, Floats]:
    """Angles up to the last, and the curvature of the density near them, relative to the density.

    The mean of the density over the image of a cube differs from the density at its middle by
    about 0.07 (s / r)^2 times the sum of the second derivatives, with the side s and the distance
    r. The largest value counts.
    """
    theta = (np.arange(ANGLES) + 0.5) * (last / ANGLES)
    inside = np.minimum(theta, lens.edge)
    density = lens.radius(inside) * lens.slope(inside) / np.sin(inside)
    first = np.gradient(density, theta)
    bend = np.abs(np.gradient(first, theta)) + np.abs(first / np.tan(inside))
    rate = MEAN_OFF * bend / np.maximum(density, 1e-12 * density.max())
    reach = int(NEAREST_RAD / (last / ANGLES)) + 1
    padded = np.concatenate([rate, np.full(reach, rate[-1])])
    most = np.lib.stride_tricks.sliding_window_view(padded, reach + 1).max(axis=1)
    return theta, most


def _widest_in(camera: Camera) -> float:
    """Maximum angle from the axis of a point on the border of the picture [rad]."""
    share = np.linspace(0.0, 1.0, BORDER_PLACES)
    none = np.zeros_like(share)
    all_ = np.ones_like(share)
    right = np.concatenate([share, share, none, all_]) * camera.width
    down = np.concatenate([none, all_, share, share]) * camera.height
    depth = camera.projection.unproject(right, down)[:, 0]
    edge = camera.projection.edge
    angles = np.where(np.isnan(depth), edge, np.arccos(np.clip(depth, -1.0, 1.0)))
    return min(float(angles.max()) + 0.01, edge)


def pixel_areas(
    camera: Camera, pose: Pose, centers: Floats, side: float, seen: VisibleMesh | None
) -> Floats:
    """(V,) pixels covered by voxels with centres (V, 3) and a side [m]; 0 where hidden. `seen` is
    the vehicle from the camera's position; it hides a voxel by its centre."""
    axes = axes_of(pose)
    area = np.zeros(len(centers))
    depth, left, up = in_sensor_frame(axes, centers - np.asarray(pose.position))
    index = np.flatnonzero(in_view(camera, depth, left, up, side=side))
    offsets = offsets_of(centers[index], pose.position, side)
    depth, left, up = in_sensor_frame(axes, offsets)
    plain = depth > (NEAR_SIDES + MARGIN) * side
    plain &= frustum_distance(camera, depth, left, up) > (BALL + MARGIN) * side
    found = np.empty(len(offsets))
    away = [np.maximum(np.abs(offsets[plain, k]) - side / 2.0, 0.0) for k in range(3)]
    cube = (depth[plain] * depth[plain] - side * side / 2.0) * depth[plain]
    near = away[0] + away[1] + away[2] + 1.5 * side
    found[plain] = (camera.focal_px * side) ** 2 * near / cube
    found[~plain] = clipped_pixel_area(camera, axes, offsets[~plain], side)
    if is_ranged(camera):
        found[out_of_range(camera, offsets)] = 0.0
    if seen is not None:
        visible = np.flatnonzero(found)
        found[visible[hidden(seen, aims_at(offsets[visible], side))]] = 0.0
    area[index] = found
    return area


class Sorted(NamedTuple):
    """Classified voxels: accurate in closed form (`plain`), or perhaps on the border (`edge`).
    `area` are the areas of the closed form."""

    plain: Mask
    edge: Mask
    area: Array


class Sorter:
    """Classifies voxels: out of view, accurate in closed form, or to be measured exactly."""

    def __init__(self, camera: Camera, side: float) -> None:
        lens = camera.projection
        self.lens = QuickLens(camera)
        self._side = side
        self._size = camera.width, camera.height
        self._edge = np.cos(lens.edge)
        self._outer = np.cos(self.lens.outer)
        self._cut = self.lens.outer >= lens.edge

    def sort(self, depth: Array, left: Array, up: Array, distance: Array, away: Array) -> Sorted:
        """Classify voxels by their centres, camera's axes; `away` is a of the closed form."""
        side = np.float32(self._side)
        far = distance > np.float32(NEAR * self._side)
        per = np.float32(1.0) / np.maximum(distance, side)
        cosine = depth * per
        ball = np.float32(BALL * ROOM) * side * per
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
    axes = axes_of(pose)
    offsets = offsets_of(centers, pose.position, side)
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
    area[far] = bent_pixel_area(camera, axes, offsets[far], side, pieces=FAR_PIECES)
    area[~far] = bent_pixel_area(camera, axes, offsets[~far], side)
    return area

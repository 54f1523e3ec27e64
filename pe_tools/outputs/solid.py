"""Closed solids: a mounted sensor's field of view, and the blind volume around a vehicle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from pe_core.base.arrays import Flags, Floats, Ints
from pe_core.scene import PerceptionSpace, Rig, Sensor, Vehicle, rotate
from pe_core.sensors import MeasurementCache, Voxels, kind_of

NEAREST_M = 1e-3
"""No ray ends nearer to its sensor: solids stay solid."""
SIDES = {
    (0, 1): ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    (0, -1): ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
    (1, 1): ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
    (1, -1): ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
    (2, 1): ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    (2, -1): ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)),
}
"""Corners of a cube's sides by axis and direction, counter-clockwise as seen from outside."""
WITHIN_M = 10.0
HEIGHT_M = 2.5
SIDE_M = 0.25
ANYTHING = 1
"""Saturation count: only whether a voxel is measured matters here."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A closed surface: `points` (N, 3) in the ground frame [m], `faces` (F, 3) outwards."""

    name: str
    points: Floats
    faces: Ints

    @classmethod
    def of(cls, name: str, points: Floats, faces: Ints) -> Solid:
        """Return a solid with only the points that faces use."""
        used, index = np.unique(faces, return_inverse=True)
        return cls(name, points[used], index.reshape(-1, 3))

    @property
    def volume(self) -> float:
        """Volume [m3]: the sum of the signed tetrahedra below its triangles."""
        a, b, c = (self.points[self.faces[:, k]] - self.points[0] for k in range(3))
        return float((a * np.cross(b, c)).sum() / 6.0)


def whole_solid(name: str, view: MountedView) -> Solid:
    """Return the whole field of view, without occlusion by the vehicle."""
    return _star(name, view, np.full(len(view.ends), view.reach))


def free_solid(name: str, view: MountedView) -> Solid:
    """Return the visible part of a field of view, which ends at the vehicle."""
    return _star(name, view, view.ends)


def hidden_solid(name: str, view: MountedView) -> Solid | None:
    """Return the part of a field of view that the vehicle occludes; None if there is none."""
    occluded = view.ends < view.reach - NEAREST_M
    if not occluded[view.faces].any():
        return None
    taken = _without_pinches(view.faces, occluded[view.faces].any(axis=1))
    faces, count = view.faces[taken], len(view.directions)
    outer = view.origin + view.directions * view.reach
    inner = view.origin + view.directions * np.minimum(view.ends, view.reach - NEAREST_M)[:, None]
    a, b = border(faces).T
    walls = [np.stack([b, a, a + count], axis=1), np.stack([b, a + count, b + count], axis=1)]
    return Solid.of(
        name, np.vstack([outer, inner]), np.vstack([faces, faces[:, ::-1] + count, *walls])
    )


def border(faces: Ints) -> Ints:
    """Return the edges (E, 2) that belong to one face only, in the direction of that face."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    size = int(faces.max()) + 1 if len(faces) else 1
    forward, back = edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0]
    return edges[~np.isin(forward, back)]


def _star(name: str, view: MountedView, ends: Floats) -> Solid:
    """Return the solid between a sensor and the ends of its directions."""
    points = np.vstack([view.origin + view.directions * ends[:, None], view.origin])
    edges = border(view.faces)
    sides = np.stack([np.full(len(edges), len(points) - 1), edges[:, 1], edges[:, 0]], axis=1)
    return Solid.of(name, points, np.vstack([view.faces, sides]))


def _without_pinches(faces: Ints, taken: Flags) -> Flags:
    """Add faces until no two pieces of the taken faces touch in a single point. Walls at such a
    point would have an edge that belongs to four triangles."""
    while True:
        starts = np.bincount(border(faces[taken])[:, 0], minlength=int(faces.max()) + 1)
        more = (starts > 1)[faces].any(axis=1) & ~taken
        if not more.any():
            return taken
        taken = taken | more


@dataclass(frozen=True, slots=True, eq=False)
class MountedView:
    """A sensor's field of view on the vehicle, ground frame.

    From `origin` (3,) [m] along unit `directions` (N, 3) to `ends` (N,): the vehicle, at most
    `reach` [m]. `faces` (F, 3) are triangles of directions, counter-clockwise as seen from outside.
    """

    origin: Floats
    directions: Floats
    faces: Ints
    reach: float
    ends: Floats


def mounted_view(
    sensor: Sensor, vehicle: Vehicle | None, reach: float, step: float
) -> MountedView | None:
    """Cast a field of view, in triangles of about `step` [rad]; None if its kind has none."""
    patch = kind_of(sensor).view(sensor.model, step)
    if patch is None:
        return None
    directions = rotate(sensor.pose.ground_from_sensor, patch.directions)
    ends = np.full(len(directions), reach)
    body = None if vehicle is None else kind_of(sensor).opaque(vehicle)
    if body is not None:
        position, through = sensor.pose.position, sensor.model.sees_through_glass
        hits = body.first_hit(position, directions, through)
        ends = np.clip(hits.distance, NEAREST_M, reach)
    return MountedView(np.asarray(sensor.pose.position), directions, patch.faces, reach, ends)


def voxel_solid(name: str, cubes: Flags, lowest: Floats, side: float) -> Solid | None:
    """Return the closed surface of cubes (NX, NY, NZ); None if no cube is set. `lowest` (3,) is the
    lowest corner of the grid [m], `side` the length of a cube [m]. No edge may have four faces;
    `joined` makes sure of that."""
    shape = np.array(cubes.shape) + 1
    quads = [_quads(cubes, shape, *key) for key in SIDES]
    corners = np.concatenate(quads)
    if not len(corners):
        return None
    used, index = np.unique(corners, return_inverse=True)
    a, b, c, d = index.reshape(-1, 4).T
    points = lowest + np.stack(np.unravel_index(used, tuple(shape)), axis=1) * side
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Solid(name, points, faces)


def _quads(cubes: Flags, shape: Ints, axis: int, direction: int) -> Ints:
    """Return the free faces (Q, 4) in one direction, as indices of lattice points."""
    padded = np.pad(cubes, 1)
    beside = np.roll(padded, -direction, axis)[1:-1, 1:-1, 1:-1]
    cells = np.argwhere(cubes & ~beside)
    corners = cells[:, None] + np.array(SIDES[axis, direction])
    numbers = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), tuple(shape))
    return np.asarray(numbers, np.int64).reshape(-1, 4)


def joined(cubes: Flags) -> Flags:
    """Fill the lower neighbour cube wherever two cubes touch only along an edge."""
    cubes = cubes.copy()
    while True:
        before = int(cubes.sum())
        for axes in combinations(range(3), 2):
            turned = np.moveaxis(cubes, axes, (0, 1))
            a, b = turned[:-1, :-1], turned[1:, :-1]
            c, d = turned[:-1, 1:], turned[1:, 1:]
            b |= a & d & ~b & ~c
            a |= b & c & ~a & ~d
        if int(cubes.sum()) == before:
            return cubes


def blind_volume(name: str, rig: Rig, vehicle: Vehicle) -> Solid | None:
    """Return the volume near a vehicle that no sensor sees; None if every voxel is visible."""
    space = _round(vehicle)
    index = np.argwhere(np.ones(space.shape, bool))
    voxels = Voxels(space, index, space.center_of(index))
    measured = MeasurementCache(voxels, vehicle, lambda _: ANYTHING)
    measured.measure(rig, False)
    visible = np.logical_or.reduce([m > 0 for m in measured.m.values()]).reshape(space.shape)
    inside_vehicle = space.centers(2) < vehicle.top(space)[..., None]
    blind = joined(_squares(~visible | inside_vehicle) & ~inside_vehicle)
    return voxel_solid(name, blind, np.asarray(space.origin), SIDE_M)


def _round(vehicle: Vehicle) -> PerceptionSpace:
    """Return the perception space around a vehicle, aligned with multiples of the cube side."""
    low, high = vehicle.bounds
    first = [math.floor((float(w) - WITHIN_M) / SIDE_M) * SIDE_M for w in low[:2]]
    last = [math.ceil((float(w) + WITHIN_M) / SIDE_M) * SIDE_M for w in high[:2]]
    return PerceptionSpace((first[0], last[0]), (first[1], last[1]), (0.0, HEIGHT_M), SIDE_M)


def _squares(flags: Flags) -> Flags:
    """Keep only the cubes that belong to a horizontal 2 x 2 square of set cubes."""
    squares = flags[:-1, :-1] & flags[1:, :-1] & flags[:-1, 1:] & flags[1:, 1:]
    result = np.zeros_like(flags)
    for i in (slice(None, -1), slice(1, None)):
        for j in (slice(None, -1), slice(1, None)):
            result[i, j] |= squares
    return result

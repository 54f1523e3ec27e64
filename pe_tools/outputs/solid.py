"""A mounted sensor's field of view, as rays and as a closed solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Floats, Ints
from pe_core.scene import Sensor, Vehicle, rotate
from pe_core.sensors import kind_of

NEAREST_M = 1e-3  # No ray ends nearer to its sensor: solids stay solid


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


def free_solid(name: str, view: MountedView) -> Solid:
    """Return the visible part of a field of view, which ends at the vehicle."""
    return star(name, view, view.ends)


def border(faces: Ints) -> Ints:
    """Return the edges (E, 2) that belong to one face only, in the direction of that face."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    size = int(faces.max()) + 1 if len(faces) else 1
    forward = edges[:, 0] * size + edges[:, 1]
    back = edges[:, 1] * size + edges[:, 0]
    return edges[~np.isin(forward, back)]


def star(name: str, view: MountedView, ends: Floats) -> Solid:
    """Return the solid between a sensor and the ends of its directions."""
    points = np.vstack([view.origin + view.directions * ends[:, None], view.origin])
    edges = border(view.faces)
    sides = np.stack([np.full(len(edges), len(points) - 1), edges[:, 1], edges[:, 0]], axis=1)
    return Solid.of(name, points, np.vstack([view.faces, sides]))


@dataclass(frozen=True, slots=True, eq=False)
class MountedView:
    """A sensor's field of view on the vehicle, ground frame. From `origin` (3,) [m] along unit
    `directions` (N, 3) to `ends` (N,): the vehicle, at most `reach` [m]. `faces` (F, 3) are
    triangles of directions, counter-clockwise as seen from outside."""

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
        position = sensor.pose.position
        through = sensor.model.sees_through_glass
        hits = body.first_hit(position, directions, through)
        ends = np.clip(hits.distance, NEAREST_M, reach)
    return MountedView(np.asarray(sensor.pose.position), directions, patch.faces, reach, ends=ends)

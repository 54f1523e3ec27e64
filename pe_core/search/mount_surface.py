"""The surface of a mount: named parts of the vehicle's body, or an area of it."""

from __future__ import annotations

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError, shown
from ..geometry.poses import cross, dot
from ..geometry.triangle_tree import TriangleTree
from ..scene.inside_test import open_side
from ..scene.vehicle import Vehicle, closest_points
from .mounts import SurfaceMount

SLACK = 1.0 + 1e-9
"""A search within a computed distance must find that distance again, in spite of rounding."""
PROBED_FACES = 8
"""If so many faces have the same open side, all faces are taken to have it."""


class MountSurface:
    """The faces of a mount, which are parts of the vehicle's body or an area of their own.

    `InputError` when there is no vehicle or no such part, or the parts or the area have no faces.
    """

    def __init__(self, who: str, mount: SurfaceMount, vehicle: Vehicle | None) -> None:
        self.vehicle, self.triangles = _faces(who, mount, vehicle)
        self._tree = TriangleTree(self.triangles)
        self._corners = np.unique(self.triangles.reshape(-1, 3), axis=0)
        self._outward: dict[int, Floats] = {}
        # The side of the probed faces if all agree, as in most meshes; else 0.0.
        probed = np.linspace(0, len(self.triangles) - 1, PROBED_FACES).astype(int)
        sides = {self._side_of(face) for face in np.unique(probed).tolist()}
        self._side = sides.pop() if len(sides) == 1 else 0.0

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner, each (3,) [m]."""
        return self._corners.min(axis=0), self._corners.max(axis=0)

    def closest(self, point: Floats) -> tuple[Floats, int]:
        """Return the point (3,) of the surface that is closest to a point, and its face."""
        away = self._corners - point
        reach = float(np.sqrt(dot(away, away).min())) * SLACK + 1e-12
        near = self._tree.near(point, reach)
        feet = closest_points(point, self.triangles[near])
        best = int(np.argmin(dot(feet - point, feet - point)))
        return feet[best], int(near[best])

    def is_nearer(self, point: Floats, distance: float) -> bool:
        """Whether the surface is nearer to a point (3,) than a distance [m]."""
        feet = closest_points(point, self.triangles[self._tree.near(point, distance)])
        return bool((dot(feet - point, feet - point) < distance**2).any())

    def outward(self, face: int) -> Floats:
        """Return the unit normal (3,) of a face on its open side."""
        if face not in self._outward:
            side = self._side or self._side_of(face)
            self._outward[face] = side * self._normal(face)
        return self._outward[face]

    def _normal(self, face: int) -> Floats:
        """Return the unit normal (3,) of a face; its corners are counter-clockwise round it."""
        corners = self.triangles[face]
        normal = cross(corners[1] - corners[0], corners[2] - corners[0])
        return normal / np.sqrt(dot(normal, normal))

    def _side_of(self, face: int) -> float:
        """Return 1.0 where a face's open side is that of its normal, else -1.0."""
        middle = self.triangles[face].sum(axis=0) / 3.0
        return open_side(self.vehicle, middle, self._normal(face))


def _faces(who: str, mount: SurfaceMount, vehicle: Vehicle | None) -> tuple[Vehicle, Floats]:
    """Return the vehicle and the mount's triangles that have an area."""
    if mount.area is not None:
        if vehicle is None:
            raise InputError(who, "area", "a vehicle that it is an area of", "none")
        return vehicle, _with_area(who, "area", mount.area.triangles, "the area")
    names = () if vehicle is None else vehicle.part_names
    for part in mount.parts:
        if vehicle is None or part not in names:
            expected = f"one of {', '.join(names)}" if names else "a vehicle with such a part"
            raise InputError(who, "parts", expected, shown(part))
    assert vehicle is not None  # a mount has at least one part
    chosen = np.isin(vehicle.parts, [names.index(part) for part in mount.parts])
    return vehicle, _with_area(who, "parts", vehicle.triangles[chosen], ", ".join(mount.parts))


def _with_area(who: str, field: str, triangles: Floats, named: str) -> Floats:
    """Return the triangles that have an area; raise `InputError` if there is none."""
    normals = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    proper = triangles[dot(normals, normals) > 0.0]
    if not len(proper):
        expected = "parts with faces" if field == "parts" else "faces"
        raise InputError(who, field, expected, f"none in {named}")
    return proper

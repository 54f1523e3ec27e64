"""Rays of a picture and what they meet: viewpoint, pixel rays, solids, first hits."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Floats, Ints

from .painted_mesh import PaintedMesh

NOTHING = -2
SKY = -1
GROUND = 0
"""Surfaces of rays that meet no solid: outside the lens, sky, ground. Solids count from 1."""
PixelRays = Callable[[Floats, Floats], Floats]
"""Maps positions in the picture (right, down) [px] to unit directions (N, 3), ground frame; NaN
outside the image circle of a lens."""


@dataclass(frozen=True, eq=False)
class RayCamera:
    """The eye (3,) of a picture [m], and the ray through each of its pixels. `width` and `height`
    are in pixels, `pixel_rad` is the angle between two neighbouring pixels in the centre [rad].
    `from_sensor`: the eye is a camera on the vehicle. As in a measurement, its rays begin outside
    the vehicle's surface and pass through the vehicle's glass."""

    eye: Floats
    width: int
    height: int
    rays_through: PixelRays
    pixel_rad: float
    from_sensor: bool = False


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """Eye, target [m] and horizontal field of view [deg] of a picture, ground frame."""

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    fov_deg: float = 30.0

    @property
    def axes(self) -> Floats:
        """(3, 3) rows: ahead, right, up."""
        ahead = np.subtract(self.target, self.eye)
        ahead = ahead / math.sqrt(float(ahead @ ahead))
        right = np.array([ahead[1], -ahead[0], 0.0])
        right = right / max(math.sqrt(float(right @ right)), 1e-9)
        return np.stack([ahead, right, np.cross(right, ahead)])

    def camera(self, size: tuple[int, int]) -> RayCamera:
        """Return the rays of a picture of a size (width, height) [px]."""
        width, height = size
        ahead, right, up = self.axes
        focal = self.focal_px(width)

        def rays_through(across: Floats, down: Floats) -> Floats:
            x = (across - width / 2.0) / focal
            y = (height / 2.0 - down) / focal
            rays = ahead + x[:, None] * right + y[:, None] * up
            return rays / np.sqrt((rays * rays).sum(axis=1))[:, None]

        return RayCamera(np.array(self.eye), width, height, rays_through, pixel_rad=1.0 / focal)

    def focal_px(self, width: int) -> float:
        """Return the focal length of a picture of that width [px]."""
        return width / 2.0 / math.tan(math.radians(self.fov_deg) / 2.0)

    def project(self, points: Floats, size: tuple[int, int]) -> tuple[Floats, Floats]:
        """Return the positions (right, down) of points (N, 3) in a picture of a size (width,
        height) [px]; NaN behind the eye."""
        width, height = size
        depth, x, y = self.axes @ (np.asarray(points, float) - np.array(self.eye)).T
        scale = self.focal_px(width) / np.where(depth > 1e-6, depth, np.nan)
        return width / 2.0 + x * scale, height / 2.0 - y * scale


@dataclass(frozen=True, slots=True, eq=False)
class RayHits:
    """The first hits of rays (N,) in unit `directions` (N, 3). `surface` is NOTHING, SKY, GROUND,
    or the number of a solid; `part` that of the solid, else -1; `points` (N, 3) where the rays hit
    [m]; `normals` (N, 3) unit normals of the faces there, on the side of the eye; `color` (N, 3)
    linear; `distance` from the eye [m], inf in the sky."""

    directions: Floats
    surface: Ints
    part: Ints
    points: Floats
    normals: Floats
    color: Floats
    distance: Floats


@dataclass(frozen=True, slots=True, eq=False)
class RayScene:
    """Solids on the ground, z = 0; with `has_vehicle` the first one is the vehicle."""

    solids: Sequence[PaintedMesh]
    has_vehicle: bool = True

    def first_hits(self, camera: RayCamera, directions: Floats) -> RayHits:
        """Return the first hits of rays from a camera in unit directions (N, 3) or NaN."""
        eye = camera.eye
        count = len(directions)
        valid = np.isfinite(directions[:, 0])
        surface = np.where(valid, SKY, NOTHING)
        distance = np.full(count, np.inf)
        face = np.full(count, -1)
        down = valid & (directions[:, 2] < -1e-9)
        if eye[2] > 0.0:
            distance[down] = -eye[2] / directions[down, 2]
            surface[down] = GROUND
        valid_rays = np.flatnonzero(valid)
        rays = directions[valid_rays]
        for number, solid in enumerate(self.solids, 1):
            if camera.from_sensor and number == 1 and self.has_vehicle:
                hits = solid.mesh.first_hit(eye.tolist(), rays, True)
            else:
                hits = solid.mesh.first_hit_from(eye, rays)
            nearer = hits.distance < distance[valid_rays]
            at = valid_rays[nearer]
            surface[at] = number
            distance[at] = hits.distance[nearer]
            face[at] = hits.face[nearer]
        points = eye + directions * np.where(np.isfinite(distance), distance, 0.0)[:, None]
        normals = np.tile([0.0, 0.0, 1.0], (count, 1))
        part = np.full(count, -1)
        color = np.zeros((count, 3))
        for number, solid in enumerate(self.solids, 1):
            at = np.flatnonzero(surface == number)
            part[at] = solid.mesh.parts[face[at]]
            normals[at] = solid.normals[face[at]]
            color[at] = solid.colors[part[at]]
        away = (normals * directions).sum(axis=1) > 0.0
        normals = np.where(away[:, None], -normals, normals)
        return RayHits(
            directions, surface, part, points, normals=normals, color=color, distance=distance
        )

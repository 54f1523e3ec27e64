"""What stands in a picture: solids on the ground, and what rays from one point meet first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .normals import unit
from .painted import PaintedBody

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

NOTHING, SKY, GROUND = -2, -1, 0
"""What a ray meets that meets no solid; solids are numbered from 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Met:
    """What rays (N,) meet first.

    `what` (N,) NOTHING, SKY, GROUND or the number of a solid, `part` (N,) of that solid, -1 of
    none; `points` (N, 3) where, `normals` (N, 3) of the surface there, turned to the eye, `color`
    (N, 4) with its shine; `distance` (N,) [m], inf in the sky.
    """

    what: Ints
    part: Ints
    points: Floats
    normals: Floats
    color: Floats
    distance: Floats

    @property
    def is_solid(self) -> Flags:
        """(N,) rays that meet a solid."""
        return self.what > GROUND

    @property
    def is_surface(self) -> Flags:
        """(N,) rays that meet a solid or the ground."""
        return self.what >= GROUND


@dataclass(frozen=True, slots=True, eq=False)
class Tableau:
    """Solids on the ground, z = 0. The first is the vehicle, if there is one: `has_vehicle`."""

    solids: Sequence[PaintedBody]
    has_vehicle: bool = True

    def seen(self, eye: Floats, directions: Floats, *, from_sensor: bool = False) -> Met:
        """Return what rays from an eye (3,) meet; directions are unit, NaN where there is none.

        `from_sensor`: the eye is a camera's, proud of the vehicle's skin and looking through its
        glass, as when it is measured.
        """
        count = len(directions)
        valid = np.isfinite(directions[:, 0])
        what = np.where(valid, SKY, NOTHING)
        distance, face = np.full(count, np.inf), np.full(count, -1)
        down = valid & (directions[:, 2] < -1e-9)
        if eye[2] > 0.0:
            distance[down], what[down] = -eye[2] / directions[down, 2], GROUND
        some = np.flatnonzero(valid)
        for number, solid in enumerate(self.solids, 1):
            as_sensor = from_sensor and number == 1 and self.has_vehicle
            body, rays = solid.body, directions[some]
            hits = (
                body.first_hit(eye.tolist(), rays, True)
                if as_sensor
                else body.first_hit_from(eye, rays)
            )
            nearer = hits.distance < distance[some]
            at = some[nearer]
            what[at], distance[at], face[at] = number, hits.distance[nearer], hits.face[nearer]
        return self._filled(eye, directions, what, distance, face)

    def lit(self, light: Floats, points: Floats) -> Flags:
        """(N,) whether a light at a place (3,) [m] shines on points (N, 3): no solid between."""
        way = points - light
        length = np.sqrt((way * way).sum(axis=1))
        free = np.ones(len(points), bool)
        for solid in self.solids:
            hits = solid.body.first_hit_from(light, way / length[:, None])
            free &= ~(hits.distance < length - SLACK_M)
        return free

    def _filled(
        self, eye: Floats, directions: Floats, what: Ints, distance: Floats, face: Ints
    ) -> Met:
        points = eye + directions * np.where(np.isfinite(distance), distance, 0.0)[:, None]
        normals = np.tile([0.0, 0.0, 1.0], (len(what), 1))
        part, color = np.full(len(what), -1), np.zeros((len(what), 4))
        for number, solid in enumerate(self.solids, 1):
            at = np.flatnonzero(what == number)
            part[at] = solid.parts_of(face[at])
            normals[at] = solid.normals_at(face[at], points[at])
            color[at] = solid.colors[part[at]]
        away = (normals * directions).sum(axis=1) > 0.0
        normals = unit(np.where(away[:, None], -normals, normals))
        return Met(what, part, points, normals, color, distance)


SLACK_M = 0.004
"""What is this near to a point does not shade it: the point's own surface."""

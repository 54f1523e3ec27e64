"""Reasons: the worst sample of a zone, and why a sensor does not see the body there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ...sensors import kind_of
from .bodies import Body
from .criteria import Requirement, levels_of

OCCLUDED, TOO_FEW, IN_PART, NO_COUNT = "occluded", "too few", "in part", "not counted"
"""Codes of reasons, beside those of `Kind.missed`. In part: a share has to be visible, and less may
be. Not counted: the criterion leaves out sensors of this kind."""
CUBE_M = 0.1
"""Side of the cubes by which it is told why a sensor does not see a body."""


class Reason(NamedTuple):
    """Why a sensor does not see a body: a code, and the part of the vehicle that occludes it."""

    code: str
    part: str = ""


def worst_sample(points: Floats, distance: Floats, counts: Ints, among: Flags) -> int:
    """Return the sample that the fewest sensors see; of equal ones that deepest in the zone."""
    some = np.flatnonzero(among)
    fewest = counts[some].min(axis=1)
    x, y = points[some].T
    order = np.lexsort((y, x, distance[some], fewest))
    return int(some[order[0]])


def columns_of(requirement: Requirement) -> list[Body]:
    """Return the body of each column of what sensors see, the heights of the zone too."""
    levels = levels_of(requirement)
    return [body for body in requirement.bodies for _ in range(levels) for _ in body.headings]


def why_not(sensor: Sensor, body: Body, foot: tuple[float, ...], vehicle: Vehicle | None) -> Reason:
    """Return why a sensor does not see a body.

    Cubes along the middle of the body, from its foot to its top, are asked for: the part that most
    of the rays end on to cubes that the sensor would see without the vehicle.
    """
    kind = kind_of(sensor)
    x, y, z = foot
    count = max(1, math.ceil(body.size[2] / CUBE_M - 1e-9))
    heights = np.linspace(CUBE_M / 2.0, max(body.size[2] - CUBE_M / 2.0, CUBE_M / 2.0), count)
    centers = np.column_stack([np.full(count, x), np.full(count, y), z + body.low + heights])
    in_view = kind.measure(sensor, centers, CUBE_M, None) > 0.0
    if not in_view.any():
        return Reason(kind.missed(sensor, centers[count // 2], CUBE_M))
    rays = [kind.rays_to(sensor, center, CUBE_M) for center in centers[in_view]]
    directions, lengths = (np.concatenate([ray[k] for ray in rays]) for k in (0, 1))
    part = None if vehicle is None else part_in_the_way(sensor, vehicle, directions, lengths)
    return Reason(TOO_FEW) if part is None else Reason(OCCLUDED, part)


def part_in_the_way(
    sensor: Sensor, vehicle: Vehicle, directions: Floats, lengths: Floats
) -> str | None:
    """Return the part that most of a sensor's rays (N, 3) of `lengths` (N,) [m] end on, or None."""
    if not len(directions):
        return None
    glass = sensor.model.sees_through_glass
    hits = vehicle.first_hit(sensor.pose.position, directions, glass)
    parts = np.asarray(vehicle.parts)[hits.face[hits.distance < lengths]]
    return str(vehicle.part_names[int(np.bincount(parts).argmax())]) if len(parts) else None

"""What a mounted sensor looks at: its field of view, cast against the vehicle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..kinds import kind_of
from ..scene import Sensor, Vehicle, rotate

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAREST_M = 1e-3
"""No ray ends nearer to its sensor: solids stay solid."""


@dataclass(frozen=True, slots=True, eq=False)
class MountedView:
    """A sensor's field of view on the vehicle.

    Attributes
    ----------
    origin : (3,) float
        Where the sensor is, ground frame [m].
    directions : (N, 3) float
        Unit, ground frame.
    faces : (F, 3) int
        Triangles of directions, counter-clockwise as seen from outside.
    reach : float
        How far it sees where nothing stops it [m].
    ends : (N,) float
        How far it sees along each direction: to the vehicle, or as far as it reaches [m].
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
    if vehicle is not None:
        place, through = sensor.pose.position, sensor.model.sees_through_glass
        hits = vehicle.first_hit(place, directions, through)
        ends = np.clip(hits.distance, NEAREST_M, reach)
    return MountedView(np.asarray(sensor.pose.position), directions, patch.faces, reach, ends)

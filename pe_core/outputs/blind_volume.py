"""The blind volume: where near the vehicle no sensor sees anything, as a closed solid.

The room within `WITHIN_M` of the rectangle that the vehicle's body takes, from the ground to
`HEIGHT_M`, is cut into cubes of side `SIDE_M`. A cube is blind in which no sensor measures
anything (m = 0, as scores have it) and which is not the vehicle's own: its centre above the top
surface, or beside it. In each layer, squares of two by two cubes that nothing is seen in make up
the volume, those of the vehicle counting as unseen; a narrower gap is none.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..kinds import MeasuredByName, Voxels
from ..scene import PerceptionSpace, Rig, Vehicle
from .solid import Solid
from .voxel_surface import joined, voxel_solid

Flags = NDArray[np.bool_]

WITHIN_M = 10.0
HEIGHT_M = 2.5
SIDE_M = 0.25
ANYTHING = 1
"""A measurement from which on more does not matter here."""


def blind_volume(name: str, rig: Rig, vehicle: Vehicle) -> Solid | None:
    """Return what no sensor of a rig sees near a vehicle; None where all is seen."""
    space = _round(vehicle)
    index = np.argwhere(np.ones(space.shape, bool))
    voxels = Voxels(space, index, space.center_of(index))
    measured = MeasuredByName(voxels, vehicle, lambda _: ANYTHING)
    measured.measure(rig, False)
    seen = np.logical_or.reduce([m > 0 for m in measured.m.values()]).reshape(space.shape)
    own = space.centers(2) < vehicle.top(space)[..., None]
    blind = joined(_squares(~seen | own) & ~own)
    return voxel_solid(name, blind, np.asarray(space.origin), SIDE_M)


def _round(vehicle: Vehicle) -> PerceptionSpace:
    """Return the room round a vehicle, on whole cubes from the origin."""
    low, high = vehicle.bounds
    first = [math.floor((float(w) - WITHIN_M) / SIDE_M) * SIDE_M for w in low[:2]]
    last = [math.ceil((float(w) + WITHIN_M) / SIDE_M) * SIDE_M for w in high[:2]]
    return PerceptionSpace((first[0], last[0]), (first[1], last[1]), (0.0, HEIGHT_M), SIDE_M)


def _squares(flags: Flags) -> Flags:
    """Return the cubes of layers that belong to a square of two by two of them."""
    whole = flags[:-1, :-1] & flags[1:, :-1] & flags[:-1, 1:] & flags[1:, 1:]
    kept = np.zeros_like(flags)
    for i in (slice(None, -1), slice(1, None)):
        for j in (slice(None, -1), slice(1, None)):
            kept[i, j] |= whole
    return kept

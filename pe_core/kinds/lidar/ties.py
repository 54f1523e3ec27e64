"""Beams that run exactly along a face or through an edge of a voxel.

They are common: designers put sensors at round numbers, and azimuth 0 and elevation 0 are beams.
So that the definition and every kernel give such a beam to the same voxel, all of them place the
sensor by this one rule: its coordinate in voxels is rounded to SNAP_DECIMALS, which makes round
numbers round again, and then nudged by NUDGE, which is too small to matter and too large for a
rounding to undo. The effect is that a voxel owns its lower faces. A sensor on a voxel's edge or
corner is as near to its neighbours as the nudge is long, so there the nudge itself has to be exact:
it is a whole number of NUDGE_UNIT, which a coordinate of some thousand voxels still holds.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SNAP_DECIMALS = 9
NUDGE_UNIT = 2.0**-40
"""In voxels; what fixed point resolves as well (`lidar.grid`)."""
NUDGE = np.array([21660, 33205, 54756]) * NUDGE_UNIT
"""1.97, 3.02 and 4.98 times 1e-8 voxels: nanometres. Different along each axis, so that diagonals
are decided as well: a beam whose direction had the ratio of two nudges would run through edges of
voxels for all its nudge. Beams at round angles have ratios such as 2 : 3 and 2 : 5 (30 degrees up,
pitched by 90), so these nudges are in none that angles in steps of 15 degrees give: off by so much
that the roundings of a sweep through thousands of planes (`lidar.grid`) cannot decide."""
NO_SPEED = 1e-30
"""Stands for a direction component of exactly 0, so that dividing by it gives +-huge."""


def offsets_in_voxels(centers: Floats, position: Sequence[float], side: float) -> Floats:
    """(V, 3) centres seen from the sensor, in voxel sides."""
    whole = np.round((centers - np.asarray(position)) / side - 0.5, SNAP_DECIMALS)
    return whole + (0.5 - NUDGE)


def position_in_voxels(position: Sequence[float], origin: Sequence[float], side: float) -> Floats:
    """(3,) sensor position seen from the space's lowest corner, in voxel sides."""
    cells = (np.asarray(position) - np.asarray(origin)) / side
    return np.round(cells, SNAP_DECIMALS) + NUDGE


def without_zeros(directions: Floats) -> Floats:
    """Directions with components of exactly 0 replaced by `NO_SPEED`."""
    return np.where(directions == 0.0, NO_SPEED, directions)

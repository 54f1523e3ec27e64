"""Tie rules: beams that run exactly along a face or through an edge of a voxel.

Such ties are common: designers put sensors at round numbers, and azimuth 0 and elevation 0 are
beams. The definition and every kernel resolve a tie alike, because all of them take the sensor's
position by one rule. Its coordinates in voxels are rounded to SNAP_DECIMALS, which makes round
numbers exact. Then NUDGE is added: too small to matter, too large for rounding to undo. As a result
a voxel owns its lower faces. A sensor on a voxel's edge or corner is only a nudge away from the
neighbouring voxels, so the nudge has to be exact there: it is a multiple of NUDGE_UNIT, which
floats represent exactly in coordinates of several thousand voxels.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...base.arrays import Floats

SNAP_DECIMALS = 9
NUDGE_UNIT = 2.0**-40
"""In voxels; the resolution of the fixed point numbers of `lidar.grid_sweep`."""
NUDGE = np.array([21660, 33205, 54756]) * NUDGE_UNIT
"""1.97, 3.02 and 4.98 times 1e-8 voxels: nanometres. They differ by axis, so that diagonals are
decided as well: a beam whose components had the ratio of two nudges would still run through edges
of voxels. Beams at round angles have ratios such as 2 : 3 and 2 : 5 (30 degrees up, pitched by 90).
These nudges have no ratio that angles in steps of 15 degrees give; they are off by so much that the
rounding in a sweep through thousands of planes (`lidar.grid_sweep`) cannot decide."""
ZERO_COMPONENT = 1e-30
"""Replaces a direction component of exactly 0, so that division by it gives a huge number."""


def offsets_in_voxels(centers: Floats, position: Sequence[float], side: float) -> Floats:
    """Return centres (V, 3) as seen from the sensor, in voxel sides."""
    whole = np.round((centers - np.asarray(position)) / side - 0.5, SNAP_DECIMALS)
    return whole + (0.5 - NUDGE)


def position_in_voxels(position: Sequence[float], origin: Sequence[float], side: float) -> Floats:
    """Return the sensor's position (3,) as seen from the space's lowest corner, in voxel sides."""
    cells = (np.asarray(position) - np.asarray(origin)) / side
    return np.round(cells, SNAP_DECIMALS) + NUDGE


def without_zeros(directions: Floats) -> Floats:
    """Return directions with components of 0, or of less, replaced by `ZERO_COMPONENT`.

    What is nearer to 0 than that (an angle of 1e-320 degrees) would overflow where it divides.
    """
    return np.where(np.abs(directions) < ZERO_COMPONENT, ZERO_COMPONENT, directions)

"""Tie rules of cameras: they decide where rounding errors would decide otherwise.

Ties are common: designers put cameras at round numbers and angles, and vehicles have round
dimensions. Then corners of voxels lie in the camera's plane, centres lie on the vehicle's surface,
and rays to centres run exactly along its edges. The definition and all kernels follow the same
rules. So they agree wherever the origin of the ground frame is:

- The camera's axes have the same bits for angles a full turn apart; components that are
  mathematically zero are exactly zero.
- The position of a voxel relative to the camera is rounded, in voxels: round numbers stay round.
- All corners of a voxel have to be IN_FRONT of the camera. A corner in the camera's plane counts as
  behind it.
- The ray that tests a voxel aims at its centre, moved a little nearer to the camera along each
  axis. So a centre on a visible surface is visible. Where a ray would run along an edge, this
  nudge decides, not rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...base.arrays import Floats
from ...geometry.poses import Pose, rotation_matrix

TURN_DEG = 360.0
ANGLE_DECIMALS = 11
"""Decimals of degrees: what double precision leaves of ten turns."""
AXES_DECIMALS = 15
"""Components of axes below this are zero: they are rounding errors of a sine."""
SNAP_DECIMALS = 11
"""Decimals of positions in voxels that rounding leaves for some thousand voxels."""
IN_FRONT = 1e-6
"""In sides; the image of a nearer corner is so large that its area is only rounding errors."""
NUDGE = np.sqrt([5.0, 11.0, 26.0]) * 1e-8
"""In sides: nanometres. Their ratios are not ratios of integers, unlike directions to centres: a
nudge along the ray would decide nothing."""
MARGIN = 1e-6
"""Voxels are enlarged by this, in sides, where the forms of their area meet."""


def axes_of(pose: Pose) -> Floats:
    """(3, 3) rotation from the camera's frame to the ground frame."""
    degrees = (math.remainder(angle, TURN_DEG) for angle in pose.rotation_deg)
    turned = rotation_matrix(*(math.radians(round(d, ANGLE_DECIMALS)) for d in degrees))
    return np.round(turned, AXES_DECIMALS) + 0.0


def offsets_of(centers: Floats, position: Sequence[float] | float, side: float) -> Floats:
    """Centres relative to a camera, ground axes [m].

    Either (V, 3) relative to a position (3,), or one coordinate of each.
    """
    return np.round((centers - np.asarray(position)) / side, SNAP_DECIMALS) * side


def aims_at(offsets: Floats, side: float, nudge: Floats | float = NUDGE) -> Floats:
    """Points that the rays to voxels at offsets [m] aim at: (V, 3), or one coordinate of each."""
    toward = np.where(offsets < 0.0, side, -side)
    return offsets + toward * nudge

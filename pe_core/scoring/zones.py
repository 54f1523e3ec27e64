"""Zones of the ground: where a rig sees well and where it does not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..scene.space import PerceptionSpace

NEAR_M, FAR_M = 10.0, 40.0

ZONES = ("front", "rear", "left", "right", "near", "mid", "far")
"""Half planes before, behind, left and right of the vehicle's centre, and rings round it: nearer
than NEAR_M, farther than FAR_M, and between."""


def zone_masks(x: NDArray[np.float64], y: NDArray[np.float64]) -> dict[str, NDArray[np.bool_]]:
    """Which points (x, y) [m], broadcast together, lie in each zone."""
    x, y = np.broadcast_arrays(x, y)
    square = x * x + y * y
    near, far = square < NEAR_M**2, square > FAR_M**2
    masks = (x > 0.0, x < 0.0, y > 0.0, y < 0.0, near, ~near & ~far, far)
    return dict(zip(ZONES, masks, strict=True))


def column_zones(space: PerceptionSpace) -> dict[str, NDArray[np.bool_]]:
    """(nx, ny) columns of a space in each zone."""
    return zone_masks(space.centers(0)[:, None], space.centers(1)[None, :])

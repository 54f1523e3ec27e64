"""Why the camera row cannot come from the printed formula: the best any voxel can do.

The image of a cube of side s, nearest point at distance d, cannot be larger than that of the disk
that hides it: area at most sqrt(3) s^2 (f / d)^2 / cos^3 of the angle off the axis, and no larger
than the image. With AP = a ln m + b that bounds the entropy of each voxel from below, wherever the
camera looks and whatever it stands behind.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pe_core import ApCurve, Camera
from pe_core.metric import H_BLIND, entropy_of, precision_of

Floats = NDArray[np.float64]

SHADOW = math.sqrt(3.0)
"""The largest shadow of a cube, in faces."""


def largest_area(camera: Camera, distance: Floats, side: float) -> Floats:
    """Bound of the pixel area of a cube whose centre is at a distance [m] from the camera, (V,).

    The cube is nearer than its centre by up to half its diagonal, and a pinhole camera enlarges
    what is off its axis, at most as at the corner of the image.
    """
    nearest = np.maximum(distance - SHADOW / 2.0 * side, 1e-3)
    corner = math.hypot(camera.width, camera.height) / 2.0 / camera.focal_px
    off_axis = (1.0 + corner**2) ** 1.5
    area = SHADOW * side**2 * (camera.focal_px / nearest) ** 2 * off_axis
    return np.minimum(area, float(camera.width * camera.height))


def least_entropy(camera: Camera, distance: Floats, side: float, curve: ApCurve) -> Floats:
    """Bound of the entropy of voxels at distances [m] from below, (V,) [nats]."""
    return entropy_of(precision_of(largest_area(camera, distance, side), curve))


def farthest_at(camera: Camera, entropy: float, side: float, curve: ApCurve) -> float:
    """Distance [m] beyond which no voxel can have an entropy this low, by bisection."""
    low, high = 0.01, 1000.0
    for _ in range(60):
        middle = (low + high) / 2.0
        if least_entropy(camera, np.array([middle]), side, curve)[0] <= entropy:
            low = middle
        else:
            high = middle
    return low


def least_unseen(entropy: float, camera: Camera, curve: ApCurve) -> float:
    """Largest share of the prior that may be unseen at this PE, if the rest filled the image."""
    best = float(entropy_of(precision_of(float(camera.width * camera.height), curve)))
    return (entropy - best) / (H_BLIND - best)

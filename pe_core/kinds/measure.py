"""The measurement m = f(s, q) as it is defined.

This is what the scoring kernels are held against. Use an `Evaluator` for many voxels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..scene.sensors import Sensor
from ..scene.vehicle import Vehicle
from .table import kind_of

Floats = NDArray[np.float64]


def measure(
    sensor: Sensor, centers: ArrayLike, side: float, vehicle: Vehicle | None = None
) -> Floats:
    """Return the measurement of each voxel by one sensor.

    LiDAR: the number of beams that pass through the cube, entering it no farther than the maximum
    range and not stopped earlier by the vehicle. A cube owns its lower faces: a beam that runs
    exactly along a face belongs to the cube above it (`lidar.ties`).
    Camera: the area in pixels of the cube's image, clipped to the image; 0 when a corner lies
    behind the camera or in its plane, the centre is out of range, or the vehicle hides it
    (`camera.ties`). Through a lens that bends, what lies inside its field counts, wherever the
    corners are (`camera.bent_area`).

    Parameters
    ----------
    sensor : Sensor
    centers : (V, 3) float
        Voxel centres, ground frame [m].
    side : float
        Side of the cubes [m].
    vehicle : Vehicle, optional
        Hides what lies behind it.

    Returns
    -------
    (V,) float
        Beams or pixels.

    Raises
    ------
    InputError
        When the centres are not (V, 3) finite numbers.
    """
    centers = np.asarray(centers, dtype=float)
    if centers.ndim != 2 or centers.shape[1] != 3 or not np.isfinite(centers).all():
        raise InputError("measure", "centers", "(V, 3) finite numbers", centers.shape)
    return kind_of(sensor).measure(sensor, centers, side, vehicle)

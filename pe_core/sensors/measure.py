"""The measurement m = f(s, q) by its definition, for voxels and for objects.

Tests compare the fast kernels with it. Use an `Evaluator` for many voxels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.errors import InputError
from ..scene.objects import Objects
from ..scene.rig import Sensor
from ..scene.vehicle import Vehicle
from .kind import kind_of


def measure(
    sensor: Sensor, centers: ArrayLike, side: float, vehicle: Vehicle | None = None
) -> Floats:
    """Return the measurement of each voxel by one sensor.

    LiDAR: the number of beams that pass through the cube. A beam has to enter the cube within the
    maximum range, and before the vehicle occludes it. A cube owns its lower faces: a beam exactly
    along a face belongs to the cube above it (`lidar.tie_rules`).

    Camera: the area of the cube's image in pixels, clipped to the picture. It is 0 if a corner is
    behind the camera or in its plane, if the centre is out of range, or if the vehicle occludes
    the centre (`camera.tie_rules`). Through a lens with distortion, the part inside the lens's
    field counts, also if a corner is behind the camera (`camera.bent_area`).

    Parameters
    ----------
    sensor : Sensor
    centers : (V, 3) float
        Voxel centres, ground frame [m].
    side : float
        Side of the cubes [m].
    vehicle : Vehicle, optional
        Occludes the voxels behind it.

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


def measure_objects(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None = None, traffic: bool = False
) -> Floats:
    """Return the measurement of each object by one sensor.

    LiDAR: the number of beams whose first hit is the object, within the LiDAR's range. Camera: the
    area of the box's image in pixels, clipped to the picture, times the share of it that is not
    occluded (docs/metric.md).

    Parameters
    ----------
    sensor : Sensor
    objects : Objects
    vehicle : Vehicle, optional
        Occludes the voxels behind it.
    traffic : bool
        Whether the objects of a scene occlude each other; otherwise each is measured alone.

    Returns
    -------
    (N,) float
        Beams or pixels.

    Raises
    ------
    InputError
        When the kind of the sensor does not measure objects.
    """
    return kind_of(sensor).measure_objects(sensor, objects, vehicle, traffic)

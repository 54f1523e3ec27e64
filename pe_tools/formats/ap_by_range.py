"""m by range: what a sensor measures of a class of objects, for tables of AP by range.

AP by range is what radar benchmarks publish; a curve needs AP by m. An object stands straight ahead
of a level sensor, both in the open, and its m is the mean over its headings.
"""

from __future__ import annotations

import math

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, shown
from pe_core.geometry.poses import Pose
from pe_core.scene import Objects
from pe_core.scene.rig import Sensor, SensorModel
from pe_core.sensors import measure_objects
from pe_core.sensors.kind import PAPER_VOXEL_M, SIZES

HEADINGS = 24
"""Headings of an object whose m is averaged."""
FIRST_RAD = 0.01
"""The first heading: no side of an object is exactly along a ray."""
VOXELS_OF = "car"
"""Class whose AP a table for a curve of voxels has."""


def m_by_range(
    model: SensorModel, ranges: Floats, class_name: str | None, height: float | None = None
) -> Floats:
    """Return m (N,) at ranges (N,), from the sensor to the object's middle over the ground [m].

    Parameters
    ----------
    model : SensorModel
    ranges : (N,) float
    class_name : str or None
        A class of the road; None: m of a voxel of a car, m of the car over
        ``k = (l + w) h / (2 s^2)`` as in `derived_object_curve`.
    height : float, optional
        Of the sensor above the ground [m]; by default that of the object's middle.

    Raises
    ------
    InputError
        For a class without a size.
    """
    name = VOXELS_OF if class_name is None else class_name
    if name not in SIZES:
        raise InputError("fit", "object", f"one of {', '.join(SIZES)}", shown(name))
    length, width, tall = SIZES[name]
    middle = tall / 2.0
    pose = Pose((0.0, 0.0, middle if height is None else height))
    centers = np.column_stack([ranges, np.zeros(len(ranges)), np.full(len(ranges), middle)])
    centers = np.repeat(centers, HEADINGS, axis=0)
    yaws = np.tile(np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS) + FIRST_RAD, len(ranges))
    sizes = np.tile((length, width, tall), (len(centers), 1))
    objects = Objects(centers, sizes, yaws, np.zeros(len(centers), np.int64), (name,))
    m = measure_objects(Sensor("sensor", model, pose), objects)
    mean = m.reshape(-1, HEADINGS).mean(axis=1)
    return mean if class_name else mean * (2.0 * PAPER_VOXEL_M**2 / ((length + width) * tall))

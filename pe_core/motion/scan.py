"""The scan in time: beams on what moves (docs/time.md).

A LiDAR takes its frame over a time: what moves is met by more or fewer beams. At rest nothing
changes.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..scene.rig import Sensor
from ..sensors.lidar import LIDAR


def scan_factor(bearing_rate: ArrayLike, rate_hz: float) -> Floats:
    """Return the factor of m by a rotating scan: Omega / (Omega - omega), eq. T3.

    `bearing_rate` (N,): omega, the rate at which an object's bearing changes in the sensor's frame
        [rad/s]; positive with the scan.
    `rate_hz`: Revolutions in a second; Omega = 2 pi of it. The factor is that of objects slower
        than it.
    """
    speed = 2.0 * math.pi * rate_hz
    omega = np.clip(np.asarray(bearing_rate, dtype=float), -speed, 0.5 * speed)
    return np.asarray(speed / (speed - omega))


def factor_of(sensor: Sensor, bearings: Floats, dt: float, rate_hz: float) -> Floats:
    """Return the factor (A, K) of a sensor's m by its scan; 1 but for a LiDAR. `bearings` (A, K)
    [rad] are of frames that are `dt` [s] apart. Which way a scan turns is seldom published: the
    lower factor of both ways is taken."""
    if sensor.kind != LIDAR.name:
        return np.ones(bearings.shape)
    return scan_factor(-np.abs(np.gradient(bearings, dt, axis=1)), rate_hz)

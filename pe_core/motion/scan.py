"""The scan in time: beams on what moves, seams between sensors, latency (docs/time.md).

A sensor takes its frame over a time, and at a time of its own. What moves is met by more or fewer
beams, and two sensors see it at two places. All of it is zero, or one, at rest.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.errors import InputError
from ..scene.rig import Sensor
from ..scene.scan import SENSE, UNKNOWN
from ..sensors.lidar import LIDAR
from ..sensors.lidar.model import lidar_of

DISTANCES_M = (0.5, 1.0, 2.0, 4.0)
"""Distances up to which a box counts as found: nuScenes (arXiv 1903.11027)."""
SAME_RATE = 1e-9


def exposed(sensor: Sensor, frame: int) -> Sensor:
    """Return a sensor with the beams of one frame: a LiDAR's pattern may take several. `InputError`
    when it takes more than it has channels."""
    count = sensor.scan.exposures
    if sensor.kind != LIDAR.name or count == 1:
        return sensor
    lidar = lidar_of(sensor)
    if count > len(lidar.elevations):
        expected = f"at most {len(lidar.elevations)}, its channels"
        raise InputError(f"sensor {sensor.name!r}", "exposures", expected, count)
    channels = np.array_split(np.arange(len(lidar.elevations)), count)[frame % count]
    kept = {k: getattr(lidar, k)[channels] for k in ("elevations", "azimuth_offsets")}
    return replace(sensor, model=replace(lidar, **kept))


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
    """Return the factor (A, K) of a sensor's m by its scan; 1 but for a LiDAR that turns.
    `bearings` (A, K) [rad] are of frames that are `dt` [s] apart. While the direction of the scan
    is not known, the lower factor of both is taken."""
    if sensor.kind != LIDAR.name:
        return np.ones(bearings.shape)
    rate, sense = np.gradient(bearings, dt, axis=1), SENSE.get(sensor.scan.turns)
    return scan_factor(-np.abs(rate) if sense is None else sense * rate, rate_hz)


def seam(
    sensors: tuple[Sensor, Sensor],
    bearings: Mapping[str, Floats],
    rates: Mapping[str, float],
    speed: Floats,
) -> Floats | None:
    """Return how far apart two sensors see bodies (A, K) [m], eq. T4: |v| times their lag.

    The lag is the time between their nearest views. Where neither rate is a multiple of the other,
    they drift: it is the longest, half a frame of the faster one. None where the direction of a
    LiDAR is not known, or none of both is a LiDAR.

    `bearings, rates`: Of bodies in the ground frame [rad], and frames in a second [Hz], by sensor.
    `speed` (A, K): Of the bodies over the ground [m/s]: own motion is taken as compensated.
    """
    lidars = [sensor for sensor in sensors if sensor.kind == LIDAR.name]
    if not lidars or any(sensor.scan.turns == UNKNOWN for sensor in lidars):
        return None
    first, other = (_seen_at(s, bearings[s.name]) / rates[s.name] for s in sensors)
    slow, fast = sorted(rates[s.name] for s in sensors)
    turns = (first - other) * fast % 1.0
    lag = np.minimum(turns, 1.0 - turns)
    if abs(fast / slow - round(fast / slow)) > SAME_RATE:
        lag = np.full(lag.shape, 0.5)
    return np.asarray(speed * lag / fast)


def _seen_at(sensor: Sensor, bearings: Floats) -> Floats:
    """Return the share of its frame (A, K) after which a sensor sees bearings [rad]."""
    sense = SENSE[sensor.scan.turns] if sensor.kind == LIDAR.name else 0.0
    turns = (bearings - sensor.pose.rpy[2]) / (2.0 * math.pi)
    return np.asarray(sensor.scan.phase + sense * turns)


def ap_with_latency(
    ap: ArrayLike,
    speed: ArrayLike,
    latency_s: float,
    spread_s: float,
    scatter_m: float,
    distances_m: ArrayLike = DISTANCES_M,
) -> Floats:
    """Return AP when boxes come late, eq. T5: the mean over d of AP Phi((d - |v| tau) / s).

    `ap, speed` (N,): AP without latency, and the objects' speeds [m/s].
    `latency_s, spread_s`: tau and its standard deviation: the object has moved on by |v| tau when
        the box is used.
    `scatter_m`: Standard deviation of a box's place [m]; s also has the object's way in `spread_s`.
        Without latency, AP is that without scatter.
    `distances_m` (D,): d: distances up to which a box counts as found [m].
    """
    v, near = np.abs(np.asarray(speed, dtype=float))[..., None], np.asarray(distances_m, float)
    s = np.sqrt(scatter_m**2 + (v * spread_s) ** 2)
    found = _phi((near - v * latency_s) / s) / _phi(near / scatter_m)
    return np.asarray(np.asarray(ap, dtype=float) * found.mean(axis=-1))


def _phi(x: ArrayLike) -> Floats:
    """Return the distribution function of the standard normal distribution."""
    return np.asarray(np.vectorize(lambda v: 0.5 * math.erfc(-v / math.sqrt(2.0)))(x), dtype=float)

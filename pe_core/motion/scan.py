"""The scan in time: beams on what moves, seams between sensors, latency (docs/time.md).

A sensor takes its frame over a time, and at a time of its own. What moves is met by more or fewer
beams, and two sensors see it at two places. All of it is zero, or one, at rest.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats


def scan_factor(bearing_rate: ArrayLike, rate_hz: float) -> Floats:
    """Return the factor of m by a rotating scan: Omega / (Omega - omega), eq. T3.

    Parameters
    ----------
    bearing_rate : (N,) float
        omega, the rate at which an object's bearing changes in the sensor's frame [rad/s]; positive
        with the scan.
    rate_hz : float
        Revolutions in a second; Omega = 2 pi of it. The factor is that of objects slower than it.
    """
    speed = 2.0 * math.pi * rate_hz
    omega = np.clip(np.asarray(bearing_rate, dtype=float), -speed, 0.5 * speed)
    return np.asarray(speed / (speed - omega))


def seam(speed: ArrayLike, lag_s: ArrayLike) -> Floats:
    """Return how far two sensors see one object apart [m], eq. T4: |v| times their lag.

    The lag of two rotating scans at a bearing is the difference of their phases over the rate; of a
    camera and a scan, the time between the exposure and the beam.
    """
    return np.abs(np.asarray(speed, dtype=float)) * np.abs(np.asarray(lag_s, dtype=float))


def scan_lag(phase: float, other: float, rate_hz: float) -> float:
    """Return the lag of two rotating scans [s] from their phases [turns]: at most half a turn."""
    turns = (phase - other) % 1.0
    return min(turns, 1.0 - turns) / rate_hz


def ap_with_latency(
    ap: ArrayLike, speed: ArrayLike, latency_s: float, scatter_m: float, distances_m: ArrayLike
) -> Floats:
    """Return AP when boxes come late, eq. T5: the mean over d of AP Phi((d - |v| tau) / s).

    Parameters
    ----------
    ap, speed : (N,) float
        AP without latency, and the objects' speeds [m/s].
    latency_s : float
        tau: the object has moved on by |v| tau when the box is used.
    scatter_m : float
        s: standard deviation of a box's place [m]. Without latency, AP is that without scatter.
    distances_m : (D,) float
        d: distances up to which a box counts as found [m].
    """
    moved = np.abs(np.asarray(speed, dtype=float)) * latency_s
    near = np.asarray(distances_m, dtype=float)
    at_rest = _phi(near / scatter_m)
    found = _phi((near - moved[..., None]) / scatter_m) / at_rest
    return np.asarray(np.asarray(ap, dtype=float) * found.mean(axis=-1))


def _phi(x: ArrayLike) -> Floats:
    """Return the distribution function of the standard normal distribution."""
    return np.asarray(np.vectorize(lambda v: 0.5 * math.erfc(-v / math.sqrt(2.0)))(x), dtype=float)

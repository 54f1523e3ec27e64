"""Equations 4 to 9: from a measurement to perception entropy. One function an equation.

All functions are element-wise over arrays of any shape and return float64. Equation numbers are
those of docs/metric.md, which gives the paper's numbers beside them.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.setting import Panel, check_settings, required_setting, setting
from ..base.values import Number

AP_MIN = 0.001
AP_MAX = 0.999
"""The paper's clamp of AP "for numerical stability"."""
GAUSSIAN_2D = 1.0 + math.log(2.0 * math.pi)
BLIND_PRECISION = (1.0 / AP_MIN - 1.0) ** -2
"""1 / sigma^2 of a blind sensor: ``f`` of eq. 7."""

SLOPE = Number(1e-12, cap=1e3, noun="slope")
OFFSET = Number(cap=1e3)
NEAREST_M = 1.0
"""Shortest distance R of the range term: in the vehicle there is nothing to find."""


@dataclass(frozen=True, slots=True)
class ApCurve:
    """AP = a ln m - c ln R + b of one perception algorithm; c = 0 is the paper's curve.

    R [m] is the distance from the vehicle's origin, seen from above. Detectors with one camera lose
    more with range than fewer pixels explain: docs/validity/own/second.md.
    """

    a: float = required_setting(
        SLOPE, "AP = a ln m + b: slope", Panel("a", "a", precision=4), scored=True
    )
    b: float = required_setting(
        OFFSET, "AP = a ln m + b: value at one point", Panel("b", "b", precision=4), scored=True
    )
    c: float = setting(
        0.0,
        Number(0.0, cap=1e3, noun="slope"),
        "AP = a ln m - c ln R + b: loss with range R beyond that by m; 0 is the paper",
        Panel("c", "c", precision=4),
        scored=True,
    )

    def __post_init__(self) -> None:
        check_settings(self, "AP curve")

    @property
    def saturation(self) -> float:
        """Measurement m at which AP reaches its maximum; it is clipped from there on."""
        if self.c:  # far away it takes more than any count that is stored
            return math.inf
        exponent = (AP_MAX - self.b) / self.a
        return math.exp(exponent) if exponent < 700.0 else math.inf


@dataclass(frozen=True, slots=True)
class OwnCurve:
    """The AP curve of a sensor that has one of its own, and its kind: frame rates are by kind."""

    kind: str
    curve: ApCurve


CurveOf = str | OwnCurve
"""What an AP curve is looked up by: a kind of sensor, or a kind with a curve of its own."""


POINTPILLARS = ApCurve(0.152, 0.659)
"""LiDAR, PointPillars on KITTI moderate (Ma, Liu and Li, ICRA 2021)."""
RTM3D = ApCurve(0.055, 0.155)  # Camera, RTM3D on KITTI moderate (same source)


def average_precision(m: ArrayLike, curve: ApCurve) -> Floats:
    """AP = clip(a ln m + b, 0.001, 0.999), eq. 4; m = 0 gives 0.001."""
    measured = np.asarray(m, dtype=float)
    safe = np.where(measured > 0.0, measured, 1.0)
    ap = np.where(measured > 0.0, curve.a * np.log(safe) + curve.b, AP_MIN)
    return np.clip(ap, AP_MIN, AP_MAX)


def ranged(m: Any, curve: ApCurve, distance: Floats) -> Any:
    """Return m R^(-c/a), whose a ln m + b is a ln m - c ln R + b; m itself where c is 0. `distance`
    are R [m] of the elements of m."""
    return m * np.maximum(distance, NEAREST_M) ** (-curve.c / curve.a) if curve.c else m


def sigma_of(ap: ArrayLike) -> Floats:
    """sigma = 1 / AP - 1, eq. 5."""
    return 1.0 / np.asarray(ap, dtype=float) - 1.0


def precision_of(m: ArrayLike, curve: ApCurve) -> Floats:
    """1 / sigma^2 of a measurement, eqs. 4 and 5."""
    return sigma_of(average_precision(m, curve)) ** -2


def entropy_of(precision: ArrayLike) -> Floats:
    """H = 2 ln sigma + 1 + ln(2 pi), eq. 8, from 1 / sigma^2 [nats]."""
    return GAUSSIAN_2D - np.log(np.asarray(precision, dtype=float))


def ap_of_entropy(entropies: ArrayLike) -> Floats:
    """AP = 1 / (1 + sigma) of an entropy [nats]: eqs. 8 and 5 solved for AP."""
    sigma = np.exp((np.asarray(entropies, dtype=float) - GAUSSIAN_2D) / 2.0)
    return np.asarray(1.0 / (1.0 + sigma))


def perception_entropy(entropies: ArrayLike, weights: ArrayLike) -> float:
    """PE = sum p H / sum p, eq. 9 [nats]. Lower is better."""
    w = np.asarray(weights, dtype=float)
    return float(np.sum(w * np.asarray(entropies, dtype=float)) / np.sum(w))


H_BLIND = float(entropy_of(BLIND_PRECISION))
"""Entropy of a voxel that no sensor sees [nats]: 16.651."""
H_BEST = float(entropy_of(sigma_of(AP_MAX) ** -2))
"""Entropy of a voxel at the highest AP of one fusion group [nats]: -10.976."""

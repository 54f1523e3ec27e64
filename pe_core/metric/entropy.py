"""Equations 4 to 9: from a measurement to perception entropy. One function an equation.

All functions are element-wise over arrays of any shape and return float64. Equation numbers are
those of docs/metric.md, which gives the paper's numbers beside them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.setting import Panel, check_settings, required_setting
from ..base.values import Number

AP_MIN, AP_MAX = 0.001, 0.999
"""The paper's clamp of AP "for numerical stability"."""
GAUSSIAN_2D = 1.0 + math.log(2.0 * math.pi)
BLIND_PRECISION = (1.0 / AP_MIN - 1.0) ** -2
"""1 / sigma^2 of a blind sensor: ``f`` of eq. 7."""

SLOPE = Number(1e-12, cap=1e3, noun="slope")
OFFSET = Number(cap=1e3)


@dataclass(frozen=True, slots=True)
class ApCurve:
    """AP = a ln m + b of one perception algorithm."""

    a: float = required_setting(
        SLOPE, "AP = a ln m + b: slope", Panel("a", "a", precision=4), scored=True
    )
    b: float = required_setting(
        OFFSET, "AP = a ln m + b: value at one point", Panel("b", "b", precision=4), scored=True
    )

    def __post_init__(self) -> None:
        check_settings(self, "AP curve")

    @property
    def saturation(self) -> float:
        """Measurement m at which AP reaches its maximum; it is clipped from there on."""
        exponent = (AP_MAX - self.b) / self.a
        return math.exp(exponent) if exponent < 700.0 else math.inf


POINTPILLARS = ApCurve(0.152, 0.659)
"""LiDAR, PointPillars on KITTI moderate (Ma, Liu and Li, ICRA 2021)."""
RTM3D = ApCurve(0.055, 0.155)
"""Camera, RTM3D on KITTI moderate (same source)."""


def average_precision(m: ArrayLike, curve: ApCurve) -> Floats:
    """AP = clip(a ln m + b, 0.001, 0.999), eq. 4; m = 0 gives 0.001."""
    measured = np.asarray(m, dtype=float)
    safe = np.where(measured > 0.0, measured, 1.0)
    ap = np.where(measured > 0.0, curve.a * np.log(safe) + curve.b, AP_MIN)
    return np.clip(ap, AP_MIN, AP_MAX)


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

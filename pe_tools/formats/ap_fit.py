"""Fit of an AP curve, a and b of equation 4, to measured average precisions."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError
from pe_core.metric.entropy import AP_MAX, AP_MIN, ApCurve

Floats = NDArray[np.float64]

MIN_POINTS = 3
SATURATION = 0.02
"""A point whose AP is within this of the table's largest is saturated, and so are all after it."""


@dataclass(frozen=True, slots=True)
class ApTable:
    """AP of an algorithm, by the measurement of the objects.

    Attributes
    ----------
    m : (N,) float
        Measurement per voxel, as the metric counts it: points or pixels on an object, divided by
        its surface in voxel faces; may be below 1. For curves of whole objects not divided.
    ap : (N,) float
        Average precision, 0 to 1.
    n : (N,) float
        Number of objects of each point: the weights of a fit.
    source : str
        Name of the table, for messages.
    """

    m: Floats
    ap: Floats
    n: Floats
    source: str = "table"


@dataclass(frozen=True, slots=True)
class CurveFit:
    """A fitted curve with its standard errors, the rms residual of AP, and the points used.

    `why` (N,) is the reason why a point was left out, or an empty text.
    """

    curve: ApCurve
    a_error: float
    b_error: float
    rms: float
    table: ApTable
    why: tuple[str, ...]

    @property
    def used(self) -> NDArray[np.bool_]:
        """(N,) which points were used."""
        return np.array([not reason for reason in self.why])

    @property
    def left_out(self) -> dict[str, int]:
        """Number of points left out, by reason."""
        return {why: self.why.count(why) for why in dict.fromkeys(self.why) if why}


def fit_ap_curve(table: ApTable, saturation: float = SATURATION) -> CurveFit:
    """Find a and b of AP = a ln m + b (eq. 4) by least squares, weighted by n.

    Left out are points without a measurement (m = 0), clipped ones (AP <= 0.001 or >= 0.999), and
    saturated ones: if the AP of more than one point is within `saturation` of the largest, these
    points and all with a larger m.

    Raises
    ------
    InputError
        With fewer than three usable points, a single value of m, or an AP that falls with m.
    """
    why = _reasons(table, saturation)
    used = np.array([not reason for reason in why], dtype=bool)
    if used.sum() < MIN_POINTS:
        counts = ", ".join(f"{why.count(w)} {w}" for w in dict.fromkeys(why) if w)
        found = f"{used.sum()} of {len(why)}" + (f" ({counts})" if counts else "")
        raise InputError(table.source, "points", f"at least {MIN_POINTS} usable ones", found)
    x = np.array([math.log(m) for m in table.m[used].tolist()])
    y, weight = table.ap[used], table.n[used]
    if not np.ptp(x) > 0.0:
        raise InputError(table.source, "m", "at least two different ones", table.m[used][0])
    a, b, a_error, b_error, rms = _line(x, y, weight / weight.mean())
    if not a > 0.0:
        raise InputError(table.source, "ap", "larger AP for larger m", f"a slope of {a:.3g}")
    return CurveFit(ApCurve(a, b), a_error, b_error, rms, table, tuple(why))


def study_snippet(fit: CurveFit, kind: str, name: str | None = None) -> str:
    """Return TOML for a study: ``[ap.lidar]``, or the curve of whole objects of a class `name`."""
    where = f"ap.{kind}" if name is None else f"ap.{kind}.objects.{_key(name)}"
    used, total = int(fit.used.sum()), len(fit.why)
    return (
        f"# AP = a ln m + b, fitted to {used} of {total} points of {Path(fit.table.source).name}\n"
        f"[{where}]\n"
        f"a = {fit.curve.a:.6g} # +- {fit.a_error:.2g}\n"
        f"b = {fit.curve.b:.6g} # +- {fit.b_error:.2g}\n"
    )


def _key(name: str) -> str:
    """Return a name as a TOML key, quoted if needed."""
    plain = name.isascii() and name.isidentifier()
    return name if plain else json.dumps(name, ensure_ascii=False)


def _reasons(table: ApTable, saturation: float) -> list[str]:
    """Reason why each point is left out; an empty text for a point that is used."""
    high = table.ap > table.ap.max(initial=0.0) - saturation
    saturated_from = table.m[high].min() if high.sum() > 1 else math.inf
    return [
        "no measurement"
        if m == 0.0
        else "at the clip"
        if not AP_MIN < ap < AP_MAX
        else "saturated"
        if m >= saturated_from
        else ""
        for m, ap in zip(table.m.tolist(), table.ap.tolist(), strict=True)
    ]


def _line(x: Floats, y: Floats, weight: Floats) -> tuple[float, float, float, float, float]:
    """Slope, intercept, their standard errors and the rms residual of a weighted line fit."""
    total = weight.sum()
    mean_x, mean_y = (weight * x).sum() / total, (weight * y).sum() / total
    spread = (weight * (x - mean_x) ** 2).sum()
    a = float((weight * (x - mean_x) * (y - mean_y)).sum() / spread)
    b = float(mean_y - a * mean_x)
    square = float((weight * (y - a * x - b) ** 2).sum())
    variance = square / (len(x) - 2)
    b_error = math.sqrt(variance * (1.0 / total + mean_x**2 / spread))
    return a, b, math.sqrt(variance / spread), b_error, math.sqrt(square / total)

"""The AP curve of a perception algorithm, from a table of measurements: a and b of equation 4."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .entropy import AP_MAX, AP_MIN, ApCurve

Floats = NDArray[np.float64]

MIN_POINTS = 3
SATURATION = 0.02
"""A point whose AP is this near to the table's largest is saturated, and so is all that follows."""


@dataclass(frozen=True, slots=True)
class ApTable:
    """AP of an algorithm on objects of like measurement.

    `m` (N,) measurement a voxel, as the metric counts it: points or pixels on an object, divided by
    its surface in faces of a voxel; may be below 1. For whole objects it is not divided. `ap` (N,)
    in [0, 1]. `n` (N,) objects behind each point, the weights of a fit.
    """

    m: Floats
    ap: Floats
    n: Floats
    source: str = "table"


@dataclass(frozen=True, slots=True)
class CurveFit:
    """A fitted curve, its standard errors, its scatter, and which points were taken.

    `used` (N,) bool; `why` (N,) says of each point why it was left out, empty where it was not.
    """

    curve: ApCurve
    a_error: float
    b_error: float
    rms: float
    table: ApTable
    why: tuple[str, ...]

    @property
    def used(self) -> NDArray[np.bool_]:
        """(N,) which points were taken."""
        return np.array([not reason for reason in self.why])

    @property
    def left_out(self) -> dict[str, int]:
        """How many points were left out, by reason."""
        return {why: self.why.count(why) for why in dict.fromkeys(self.why) if why}


def fit_ap_curve(table: ApTable, saturation: float = SATURATION) -> CurveFit:
    """Find a and b of AP = a ln m + b by least squares, each point weighed by its n.

    Left out are points without a measurement (m = 0), at the clip (AP <= 0.001 or >= 0.999), and
    saturated ones: from the first point on whose AP is within `saturation` of the largest, where
    there is more than one such point.

    Raises
    ------
    InputError
        With fewer than three points left, all of one m, or an AP that falls with m.
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
    """Lines of TOML for a study: ``[ap.lidar]``, or of a class of objects that is named."""
    where = f"ap.{kind}" if name is None else f"ap.{kind}.objects.{_key(name)}"
    taken, every = int(fit.used.sum()), len(fit.why)
    return (
        f"# AP = a ln m + b, fitted to {taken} of {every} points of {Path(fit.table.source).name}\n"
        f"[{where}]\n"
        f"a = {fit.curve.a:.6g} # +- {fit.a_error:.2g}\n"
        f"b = {fit.curve.b:.6g} # +- {fit.b_error:.2g}\n"
    )


def _key(name: str) -> str:
    """Return a name as TOML has it in a key."""
    plain = name.isascii() and name.isidentifier()
    return name if plain else json.dumps(name, ensure_ascii=False)


def _reasons(table: ApTable, saturation: float) -> list[str]:
    """Why each point is left out; an empty text where it is not."""
    high = table.ap > table.ap.max(initial=0.0) - saturation
    first = table.m[high].min() if high.sum() > 1 else math.inf
    return [
        "no measurement"
        if m == 0.0
        else "at the clip"
        if not AP_MIN < ap < AP_MAX
        else "saturated"
        if m >= first
        else ""
        for m, ap in zip(table.m.tolist(), table.ap.tolist(), strict=True)
    ]


def _line(x: Floats, y: Floats, weight: Floats) -> tuple[float, float, float, float, float]:
    """Slope, intercept, their standard errors and the rms residual of a weighted straight line."""
    total = weight.sum()
    mean_x, mean_y = (weight * x).sum() / total, (weight * y).sum() / total
    spread = (weight * (x - mean_x) ** 2).sum()
    a = float((weight * (x - mean_x) * (y - mean_y)).sum() / spread)
    b = float(mean_y - a * mean_x)
    square = float((weight * (y - a * x - b) ** 2).sum())
    variance = square / (len(x) - 2)
    b_error = math.sqrt(variance * (1.0 / total + mean_x**2 / spread))
    return a, b, math.sqrt(variance / spread), b_error, math.sqrt(square / total)

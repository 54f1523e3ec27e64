"""The AP curve of a perception algorithm, from a table of measurements: a and b of equation 4."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .cells import numbered_lines, parse_number, quoted
from .entropy import AP_MAX, AP_MIN, ApCurve
from .errors import InputError
from .files import decode_text, read_bytes

Floats = NDArray[np.float64]

COLUMNS = ("m", "ap", "n")
MIN_POINTS = 3
SATURATION = 0.02
"""A point whose AP is this near to the table's largest is saturated, and so is all that follows."""


@dataclass(frozen=True, slots=True)
class ApTable:
    """AP of an algorithm on objects of like measurement.

    `m` (N,) measurement a voxel, as the metric counts it: points or pixels on an object, divided by
    its surface in faces of a voxel; may be below 1. `ap` (N,) in [0, 1]. `n` (N,) objects behind
    each point, the weights of a fit.
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


def read_ap_table(path: str | Path) -> ApTable:
    """Read a CSV with the columns m and ap, and n where the points' sizes are known.

    Lines that begin with ``#`` are comments. Columns of other names are passed over.

    Raises
    ------
    InputError
        One line with the file, the line's number, what was expected and what was found.
    """
    source = str(path)
    data = read_bytes(Path(path))
    if b"\0" in data:
        raise InputError(source, "file", "a table in text (CSV)", "binary data")
    rows = numbered_lines(decode_text(data))
    if not rows:
        raise InputError(source, "file", "a table with the columns m and ap", "nothing")
    names = [name.lower() for name in _cells(rows[0][1])]
    for name in COLUMNS[:2]:
        if names.count(name) != 1:
            found = ", ".join(names)
            raise InputError(
                source, f"line {rows[0][0]}", f"one column named {name}", quoted(found)
            )
    values = [_values(source, k, names, _cells(line)) for k, line in rows[1:]]
    m, ap, n = np.array(values, dtype=float).reshape(-1, 3).T
    return ApTable(m, ap, n, source)


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


def study_snippet(fit: CurveFit, kind: str) -> str:
    """Lines of TOML for a study: ``[ap.lidar]`` or ``[ap.camera]``."""
    taken, every = int(fit.used.sum()), len(fit.why)
    return (
        f"# AP = a ln m + b, fitted to {taken} of {every} points of {Path(fit.table.source).name}\n"
        f"[ap.{kind}]\n"
        f"a = {fit.curve.a:.6g} # +- {fit.a_error:.2g}\n"
        f"b = {fit.curve.b:.6g} # +- {fit.b_error:.2g}\n"
    )


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]


def _values(
    source: str, line: int, names: Sequence[str], cells: Sequence[str]
) -> tuple[float, float, float]:
    """m, ap and n of a row, checked."""
    where = f"line {line}"
    if len(cells) != len(names):
        raise InputError(source, where, f"{len(names)} columns", len(cells))
    row = dict(zip(names, cells, strict=True))
    m, ap, n = (parse_number(source, where, name, row.get(name, "1")) for name in COLUMNS)
    if m < 0.0:
        raise InputError(source, where, "m of 0 or more", m)
    if not 0.0 <= ap <= 1.0:
        raise InputError(source, where, "ap between 0 and 1", ap)
    if n <= 0.0:
        raise InputError(source, where, "n above 0", n)
    return m, ap, n


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

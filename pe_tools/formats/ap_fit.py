"""Tables of AP by measurement or by range, and the fit of an AP curve, a and b of equation 4."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, require_name
from pe_core.base.files import decode_text, is_binary, numbered_lines, parse_number, read_bytes
from pe_core.geometry.poses import Pose
from pe_core.metric.entropy import AP_MAX, AP_MIN, ApCurve
from pe_core.scene import Objects
from pe_core.scene.rig import Sensor, SensorModel
from pe_core.sensors import measure_objects
from pe_core.sensors.kind import PAPER_VOXEL_M, SIZES

from .csv_rows import csv_rows, separated

HEADINGS = 24  # Headings of an object whose m is averaged
FIRST_RAD = 0.01  # The first heading: no side of an object is exactly along a ray
VOXELS_OF = "car"  # Class whose AP a table for a curve of voxels has
MIN_POINTS = 3
SATURATION = 0.02
"""A point whose AP is within this of the table's largest is saturated, and so are all after it."""
COLUMNS = ("m", "ap", "n")
RANGE_COLUMN = "range_m"


@dataclass(frozen=True, slots=True)
class ApTable:
    """AP of an algorithm, by the measurement of the objects. `m` (N,): measurement per voxel, as
    the metric counts it: points or pixels on an object, divided by its surface in voxel faces; may
    be below 1. For curves of whole objects not divided. `ap` (N,): average precision, 0 to 1. `n`
    (N,): number of objects of each point: the weights of a fit. `source`: name of the table, for
    messages."""

    m: Floats
    ap: Floats
    n: Floats
    source: str = "table"


@dataclass(frozen=True, slots=True)
class CurveFit:
    """A fitted curve with its standard errors, the rms residual of AP, and the points used. `why`
    (N,) is the reason why a point was left out, or an empty text."""

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
    """Find a and b of AP = a ln m + b (eq. 4) by least squares, weighted by n. Left out are points
    without a measurement (m = 0), clipped ones (AP <= 0.001 or >= 0.999), and saturated ones: if
    the AP of more than one point is within `saturation` of the largest, these points and all with a
    larger m. Fewer than three usable points, a single value of m, or an AP that falls with m raise
    `InputError`."""
    why = _reasons(table, saturation)
    used = np.array([not reason for reason in why], dtype=bool)
    if used.sum() < MIN_POINTS:
        counts = ", ".join(f"{why.count(w)} {w}" for w in dict.fromkeys(why) if w)
        found = f"{used.sum()} of {len(why)}" + (f" ({counts})" if counts else "")
        raise InputError(table.source, "points", f"at least {MIN_POINTS} usable ones", found)
    x = np.array([math.log(m) for m in table.m[used].tolist()])
    y = table.ap[used]
    weight = table.n[used]
    if not np.ptp(x) > 0.0:
        raise InputError(table.source, "m", "at least two different ones", table.m[used][0])
    a, b, a_error, b_error, rms = _line(x, y, weight / weight.mean())
    if not a > 0.0:
        raise InputError(table.source, "ap", "larger AP for larger m", f"a slope of {a:.3g}")
    return CurveFit(ApCurve(a, b), a_error, b_error, rms, table=table, why=tuple(why))


def study_snippet(fit: CurveFit, kind: str, name: str | None = None) -> str:
    """Return TOML for a study: ``[ap.lidar]``, or the curve of whole objects of a class `name`."""
    plain = name is None or (name.isascii() and name.isidentifier())
    key = name if plain else json.dumps(name, ensure_ascii=False)
    where = f"ap.{kind}" if name is None else f"ap.objects.{kind}.{key}"
    used = int(fit.used.sum())
    total = len(fit.why)
    return (
        f"# AP = a ln m + b, fitted to {used} of {total} points of {Path(fit.table.source).name}\n"
        f"[{where}]\n"
        f"a = {fit.curve.a:.6g} # +- {fit.a_error:.2g}\n"
        f"b = {fit.curve.b:.6g} # +- {fit.b_error:.2g}\n"
    )


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
    mean_x = (weight * x).sum() / total
    mean_y = (weight * y).sum() / total
    spread = (weight * (x - mean_x) ** 2).sum()
    a = float((weight * (x - mean_x) * (y - mean_y)).sum() / spread)
    b = float(mean_y - a * mean_x)
    square = float((weight * (y - a * x - b) ** 2).sum())
    variance = square / (len(x) - 2)
    b_error = math.sqrt(variance * (1.0 / total + mean_x**2 / spread))
    return a, b, math.sqrt(variance / spread), b_error, math.sqrt(square / total)


def read_ap_table(
    path: str | Path, m_at_ranges: Callable[[Floats], Floats] | None = None
) -> ApTable:
    """Read a CSV with the columns m and ap, and optionally n, the number of objects of each point.
    Lines that begin with ``#`` are comments. Other columns are ignored. With `m_at_ranges` the
    table has a column range_m [m] in place of m, and the function returns m (N,) of ranges (N,)."""
    source = str(path)
    data = read_bytes(Path(path))
    if is_binary(data):
        raise InputError(source, "file", "a table in text (CSV)", "binary data")
    lines = numbered_lines(decode_text(data))
    columns = COLUMNS if m_at_ranges is None else (RANGE_COLUMN, *COLUMNS[1:])
    if not lines:
        expected = f"a table with the columns {columns[0]} and ap"
        raise InputError(source, "file", expected, "nothing")
    separator, rows = separated(lines)
    cells = csv_rows(source, rows, columns[:2], separator)
    values = [_values(source, *row, columns) for row in cells]
    m, ap, n = np.array(values, dtype=float).reshape(-1, 3).T
    return ApTable(m if m_at_ranges is None else m_at_ranges(m), ap, n, source)


def _values(
    source: str, where: str, row: Mapping[str, str], columns: Sequence[str]
) -> tuple[float, float, float]:
    """m or the range, ap and n of a row, checked."""
    m, ap, n = (parse_number(source, where, name, row.get(name, "1")) for name in columns)
    if m < 0.0:
        raise InputError(source, where, f"{columns[0]} of 0 or more", m)
    if not 0.0 <= ap <= 1.0:
        raise InputError(source, where, "ap between 0 and 1", ap)
    if n <= 0.0:
        raise InputError(source, where, "n above 0", n)
    return m, ap, n


def m_by_range(
    model: SensorModel, ranges: Floats, class_name: str | None, height: float | None = None
) -> Floats:
    """Return m (N,) at ranges (N,), from the sensor to the object's middle over the ground [m].
    `InputError` when for a class without a size. `class_name`: A class of the road; None: m of a
    voxel of a car, m of the car over ``k = (l + w) h / (2 s^2)`` as in `derived_object_curve`.
    `height`: of the sensor above the ground [m]; by default that of the object's middle."""
    name = VOXELS_OF if class_name is None else class_name
    require_name("fit", "object", name, SIZES)
    length, width, tall = SIZES[name]
    middle = tall / 2.0
    pose = Pose((0.0, 0.0, middle if height is None else height))
    centers = np.column_stack([ranges, np.zeros(len(ranges)), np.full(len(ranges), middle)])
    centers = np.repeat(centers, HEADINGS, axis=0)
    yaws = np.tile(np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS) + FIRST_RAD, len(ranges))
    sizes = np.tile((length, width, tall), (len(centers), 1))
    objects = Objects(centers, sizes, yaws, np.zeros(len(centers), np.int64), class_names=(name,))
    m = measure_objects(Sensor("sensor", model, pose), objects)
    mean = m.reshape(-1, HEADINGS).mean(axis=1)
    return mean if class_name else mean * (2.0 * PAPER_VOXEL_M**2 / ((length + width) * tall))

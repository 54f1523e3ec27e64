"""A table of sensors (CSV): for spreadsheets, and for people."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

from ..errors import InputError
from ..kinds import KINDS
from ..kinds.camera.lens import LENSES
from ..kinds.camera.lens.table import FOV_DEG
from ..text.values import Number, choice
from .carried import CarriedSensor
from .figures import FARTHEST, MIN_RANGE, PIXELS, figure, whole_figure
from .files import Written, plain_number, pose_from, text_of
from .limits import MAX_FRAMES, require_at_most
from .passthrough import entry_row, json_entry
from .pictures import Picture

FILE = "rig.csv"
PLACE, TURN = ("x_m", "y_m", "z_m"), ("roll_deg", "pitch_deg", "yaw_deg")
FIGURES = ("width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px")
LENS = (*FIGURES, "lens", "coefficients", "fov_deg")
RANGES = ("min_range_m", "max_range_m")
COLUMNS = ("name", "kind", "model", *PLACE, *TURN, "fusion", *LENS, *RANGES)
HEAD = """\
# Origin on the ground under the vehicle's centre; x forward, y left, z up; metres, degrees.
# R = Rz(yaw) Ry(pitch) Rx(roll); positive pitch is nose down; a camera looks along its x axis.
# Lenses: pinhole; brown-conrady k1 k2 p1 p2 k3 k4 k5 k6; kannala-brandt k1 k2 k3 k4;
# f-theta k1 to k6.
"""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return the table of a rig."""
    out = io.StringIO()
    out.write(HEAD)
    table = csv.writer(out, lineterminator="\n")
    table.writerow(COLUMNS)
    for each in sensors:
        if each.is_left_out:
            row = entry_row(each, lambda _: {}, (), ())
            table.writerow([row.get(key, "") for key in COLUMNS])
            continue
        numbers = (*each.pose.position, *each.pose.rotation_deg)
        figures = [plain_number(v) for v in numbers]
        table.writerow(
            [
                each.name,
                each.kind,
                each.known_model,
                *figures,
                each.fusion or "",
                *_lens_cells(each.picture),
                *("" if v is None else plain_number(v) for v in (each.min_range, each.max_range)),
            ]
        )
    return {FILE: out.getvalue().encode()}, []


def _lens_cells(picture: Picture | None) -> list[str]:
    """Return what the columns of a lens hold; they are empty for what is no camera."""
    if picture is None or picture.size is None:
        return [""] * len(LENS)
    lens = picture.lens
    figures = [plain_number(v) for v in (lens.fx, lens.fy, lens.cx, lens.cy)]
    values = " ".join(plain_number(getattr(lens, key)) for key in lens.coefficients)
    fov = "" if lens.fov is None else plain_number(math.degrees(lens.fov))
    return [*map(str, picture.size), *figures, lens.model, values, fov]


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read such a table; only the name and the numbers have to be there."""
    lines = [line for line in text_of(path).splitlines() if line and not line.startswith("#")]
    require_at_most(path, "file", len(lines), MAX_FRAMES, "rows")
    rows = csv.DictReader(lines)
    try:
        missing = [key for key in ("name", *PLACE, *TURN) if key not in (rows.fieldnames or ())]
        if missing:
            expected = f"the columns {', '.join(COLUMNS)}"
            raise InputError(path, missing[0], expected, "none of that name")
        return tuple(_read_row(path, k, row) for k, row in enumerate(rows))
    except csv.Error as error:
        raise InputError(path, "file", "a table (CSV)", error) from None


def _read_row(path: Path, number: int, row: dict[str, str]) -> CarriedSensor:
    numbers = [_number(path, number, row, key) for key in (*PLACE, *TURN)]
    pose = pose_from(path, f"row {number + 1}", numbers[:3], numbers[3:], degrees=True)
    kind, model, fusion = (row.get(key) or None for key in ("kind", "model", "fusion"))
    entry = "" if kind is None or kind in KINDS else json_entry({k: row.get(k) for k in COLUMNS})
    nearest = _range(path, number, row, RANGES[0], MIN_RANGE)
    farthest = _range(path, number, row, RANGES[1], FARTHEST)
    seen = kind, model, _picture(path, number, row), None, fusion
    return CarriedSensor(row["name"], pose, *seen, nearest, farthest, entry=entry)


def _range(path: Path, number: int, row: dict[str, str], key: str, rule: Number) -> float | None:
    """Return a range [m], None where its cell is empty."""
    return figure(path, f"row {number + 1}, {key}", row[key], rule) if row.get(key) else None


def _number(path: Path, number: int, row: dict[str, str], key: str) -> float:
    return figure(path, f"row {number + 1}, {key}", row[key])


def _picture(path: Path, number: int, row: dict[str, str]) -> Picture | None:
    """Return the lens of a row; None where its columns are empty."""
    if not all(row.get(key) for key in FIGURES):
        return None
    keys = FIGURES[:2]
    size = [whole_figure(path, f"row {number + 1}, {key}", row[key], PIXELS) for key in keys]
    fx, fy, cx, cy = (_number(path, number, row, key) for key in FIGURES[2:])
    lens = LENSES[choice(path, f"row {number + 1}, lens", row.get("lens") or "pinhole", LENSES)]
    words, field = (row.get("coefficients") or "").split(), f"row {number + 1}, coefficients"
    if len(words) > len(lens.coefficients):
        expected = f"at most {len(lens.coefficients)} of a {lens.model} lens"
        raise InputError(path, field, expected, len(words))
    values = [_number(path, number, {"coefficients": word}, "coefficients") for word in words]
    fov = None
    if row.get("fov_deg"):
        degrees = _number(path, number, row, "fov_deg")
        fov = math.radians(FOV_DEG.checked(path, f"row {number + 1}, fov_deg", degrees))
    figures = dict(zip(lens.coefficients, values, strict=False))
    return Picture(lens(fx, fy, cx, cy, fov, **figures), (size[0], size[1]))

"""Rigs as a CSV table, one row per sensor, for spreadsheets and for reading by eye."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core.base.csv_text import csv_text, unmarked
from pe_core.base.errors import InputError
from pe_core.base.values import Number, choice
from pe_core.sensors.camera.kind import FOV_DEG
from pe_core.sensors.camera.lens_models import LENSES
from pe_core.study.passthrough import json_entry

from .foreign_values import (
    FARTHEST,
    MAX_FRAMES,
    MIN_RANGE,
    PIXELS,
    Written,
    figure,
    plain_number,
    pose_from,
    require_at_most,
    text_of,
    whole_figure,
)
from .lens_pictures import Picture
from .passthrough import entry_row
from .portable import PortableSensor
from .portable_kinds import has_model

FILE = "rig.csv"
POSITION_KEYS, ROTATION_KEYS = ("x_m", "y_m", "z_m"), ("roll_deg", "pitch_deg", "yaw_deg")
FIGURES = ("width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px")
LENS = (*FIGURES, "lens", "coefficients", "fov_deg")
RANGES = ("min_range_m", "max_range_m")
COLUMNS = ("name", "kind", "model", *POSITION_KEYS, *ROTATION_KEYS, "fusion", *LENS, *RANGES)
PARAMETERS = "parameters"
"""Column of a rig with sensors whose models have neither lens nor beams: tables as JSON."""
HEAD = """\
# Origin on the ground under the vehicle's centre; x forward, y left, z up; metres, degrees.
# R = Rz(yaw) Ry(pitch) Rx(roll); positive pitch is nose down; a camera looks along its x axis.
# Lenses: pinhole; brown-conrady k1 k2 p1 p2 k3 k4 k5 k6; kannala-brandt k1 k2 k3 k4;
# f-theta k1 to k6.
"""


def write(sensors: tuple[PortableSensor, ...]) -> tuple[Written, list[str]]:
    """Return the table of a rig, and no messages."""
    rows = [
        entry_row(sensor, lambda _: {}, (), ()) if sensor.is_left_out else _row(sensor)
        for sensor in sensors
    ]
    columns = COLUMNS if not any(row.get(PARAMETERS) for row in rows) else (*COLUMNS, PARAMETERS)
    cells = ([row.get(column, "") for column in columns] for row in rows)
    return {FILE: (HEAD + csv_text([columns, *cells])).encode()}, []


def _row(sensor: PortableSensor) -> dict[str, str]:
    """Return the cells of a sensor by column."""
    numbers = (*sensor.pose.position, *sensor.pose.rotation_deg)
    ranges = (sensor.min_range, sensor.max_range)
    cells = (
        sensor.name,
        sensor.kind or "",
        sensor.known_model or "",
        *map(plain_number, numbers),
        sensor.fusion or "",
        *_lens_cells(sensor.picture),
        *("" if v is None else plain_number(v) for v in ranges),
        sensor.parameters,
    )
    return dict(zip((*COLUMNS, PARAMETERS), cells, strict=True))


def _lens_cells(picture: Picture | None) -> list[str]:
    """Return the cells of the lens columns; they are empty for a sensor without a lens."""
    if picture is None or picture.size is None:
        return [""] * len(LENS)
    lens = picture.lens
    figures = [plain_number(v) for v in (lens.fx, lens.fy, lens.cx, lens.cy)]
    values = " ".join(plain_number(getattr(lens, key)) for key in lens.coefficients)
    fov = "" if lens.fov is None else plain_number(math.degrees(lens.fov))
    return [*map(str, picture.size), *figures, lens.model, values, fov]


def read(path: Path) -> tuple[PortableSensor, ...]:
    """Read a table of sensors. Only the columns of name, position and angles are required.

    Raises
    ------
    InputError
        When a required column is missing, or a cell is malformed or out of range.
    """
    lines = [line for line in text_of(path).splitlines() if line and not line.startswith("#")]
    require_at_most(path, "file", len(lines), MAX_FRAMES, "rows")
    rows = csv.DictReader(lines)
    try:
        missing = [
            key
            for key in ("name", *POSITION_KEYS, *ROTATION_KEYS)
            if key not in (rows.fieldnames or ())
        ]
        if missing:
            expected = f"the columns {', '.join(COLUMNS)}"
            raise InputError(path, missing[0], expected, "none of that name")
        texts = ({key: _text(cell) for key, cell in row.items()} for row in rows)
        return tuple(_read_row(path, k, row) for k, row in enumerate(texts))
    except csv.Error as error:
        raise InputError(path, "file", "a table (CSV)", error) from None


def _text(cell: Any) -> Any:
    """Return a cell's text; cells that a row lacks or has too many stay what the reader makes."""
    return unmarked(cell) if isinstance(cell, str) else cell


def _read_row(path: Path, number: int, row: dict[str, str]) -> PortableSensor:
    numbers = [_number(path, number, row, key) for key in (*POSITION_KEYS, *ROTATION_KEYS)]
    pose = pose_from(path, f"row {number + 1}", numbers[:3], numbers[3:], degrees=True)
    kind, model, fusion = (row.get(key) or None for key in ("kind", "model", "fusion"))
    nearest = _range(path, number, row, RANGES[0], MIN_RANGE)
    farthest = _range(path, number, row, RANGES[1], FARTHEST)
    properties = kind, model, _picture(path, number, row), None, fusion, nearest, farthest
    sensor = PortableSensor(row["name"], pose, *properties, parameters=row.get(PARAMETERS) or "")
    if kind is None or has_model(sensor):
        return sensor
    cells = {key: row.get(key) for key in (*COLUMNS, PARAMETERS) if key in row}
    return replace(sensor, entry=json_entry(cells))


def _range(path: Path, number: int, row: dict[str, str], key: str, rule: Number) -> float | None:
    """Return a range [m]; None if its cell is empty."""
    return figure(path, f"row {number + 1}, {key}", row[key], rule) if row.get(key) else None


def _number(path: Path, number: int, row: dict[str, str], key: str) -> float:
    return figure(path, f"row {number + 1}, {key}", row[key])


def _picture(path: Path, number: int, row: dict[str, str]) -> Picture | None:
    """Return the lens of a row; None if one of its columns is empty."""
    if not all(row.get(key) for key in FIGURES):
        return None
    keys = FIGURES[:2]
    size = [whole_figure(path, f"row {number + 1}, {key}", row[key], PIXELS) for key in keys]
    fx, fy, cx, cy = (_number(path, number, row, key) for key in FIGURES[2:])
    lens = LENSES[choice(path, f"row {number + 1}, lens", row.get("lens") or "pinhole", LENSES)]
    coefficient_texts, field = (
        (row.get("coefficients") or "").split(),
        f"row {number + 1}, coefficients",
    )
    if len(coefficient_texts) > len(lens.coefficients):
        expected = f"at most {len(lens.coefficients)} of a {lens.model} lens"
        raise InputError(path, field, expected, len(coefficient_texts))
    values = [
        _number(path, number, {"coefficients": word}, "coefficients") for word in coefficient_texts
    ]
    fov = None
    if row.get("fov_deg"):
        degrees = _number(path, number, row, "fov_deg")
        fov = math.radians(FOV_DEG.checked(path, f"row {number + 1}, fov_deg", degrees))
    figures = dict(zip(lens.coefficients, values, strict=False))
    return Picture(lens(fx, fy, cx, cy, fov, **figures), (size[0], size[1]))

"""Rigs as a CSV table, one row per sensor, for spreadsheets and for reading by eye."""

import csv
import itertools
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, plural, shown
from pe_core.base.files import csv_text, unmarked
from pe_core.base.values import FINITE, Number, choice
from pe_core.sensors.camera.kind import FOV_DEG
from pe_core.sensors.camera.lens import LENSES
from pe_tools.formats.csv_rows import SEPARATORS, separated

from . import foreign_values as values
from .foreign_values import Export, plain_number
from .lens_pictures import Picture
from .merging import Row, merge_rows
from .portable import ForeignRig, MergeTarget, PortableRig, PortableSensor

FILE = "rig.csv"
POSITION_KEYS = ("x_m", "y_m", "z_m")
ROTATION_KEYS = ("roll_deg", "pitch_deg", "yaw_deg")
FIGURES = ("width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px")
LENS = (*FIGURES, "lens", "coefficients", "fov_deg")
RANGES = {"min_range_m": values.MIN_RANGE, "max_range_m": values.FARTHEST}
COLUMNS = ("name", "kind", "model", *POSITION_KEYS, *ROTATION_KEYS, "fusion", *LENS, *RANGES)
PARAMETERS = "parameters"
"""Column of a rig with sensors whose models have neither lens nor beams: tables as JSON."""
COMMENTS = ("#", '"#')
POSE_KEYS = (*POSITION_KEYS, *ROTATION_KEYS)
MODEL_KEYS = ("kind", "model", "fusion", *LENS, *RANGES, PARAMETERS)
SURPLUS = ""
"""Column of the cells behind the last one of the header."""
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+", re.ASCII)
"""A number of a spreadsheet in another language; with three decimals it could be one of thousands,
so it is not read."""
HEAD = """\
# Origin on the ground under the vehicle's centre; x forward, y left, z up; metres, degrees.
# R = Rz(yaw) Ry(pitch) Rx(roll); positive pitch is nose down; a camera looks along its x axis.
# Lenses: pinhole; brown-conrady k1 k2 p1 p2 k3 k4 k5 k6; kannala-brandt k1 k2 k3 k4;
# f-theta k1 to k6.
"""


@dataclass(frozen=True, slots=True)
class CsvTable:
    """A table in a file: the comments at its head, the names of its columns, and its rows."""

    head: str
    columns: Sequence[str]
    rows: list[Row]


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return the table of a rig, and no messages."""
    table = CsvTable(HEAD, COLUMNS, []) if into is None else into.document
    rows = table.rows
    merge_rows(rows, sensors, into, _row, pose_keys=POSE_KEYS, figure_keys=MODEL_KEYS)
    added = [
        column
        for column in (*COLUMNS, PARAMETERS)
        if column not in table.columns and any(row.get(column) for row in rows)
    ]
    columns = [*table.columns, *added]
    cells = ([row.get(column) or "" for column in columns] for row in rows)
    return {FILE: (table.head + csv_text([columns, *cells])).encode()}, []


def _row(sensor: PortableSensor) -> dict[str, str]:
    """Return the cells of a sensor by column; those of the lens are empty without one."""
    numbers = (*sensor.pose.position, *sensor.pose.rotation_deg)
    lens_cells = [""] * len(LENS)
    picture = sensor.picture
    if picture is not None and picture.size is not None:
        lens = picture.lens
        figures = [plain_number(v) for v in (lens.fx, lens.fy, lens.cx, lens.cy)]
        coefficients = values.spaced([getattr(lens, key) for key in lens.coefficients])
        fov = "" if lens.fov is None else plain_number(math.degrees(lens.fov))
        lens_cells = [*map(str, picture.size), *figures, lens.model, coefficients, fov]
    ranges = (sensor.min_range, sensor.max_range)
    cells = (
        sensor.name,
        sensor.kind or "",
        sensor.known_model or "",
        *map(plain_number, numbers),
        sensor.fusion or "",
        *lens_cells,
        *("" if v is None else plain_number(v) for v in ranges),
        sensor.parameters,
    )
    return dict(zip((*COLUMNS, PARAMETERS), cells, strict=True))


def read(path: Path) -> ForeignRig:
    """Read a table of sensors. Only the columns of name, position and angles are required."""
    text = values.text_of(path)
    numbered = [(n, line) for n, line in enumerate(text.splitlines(), 1) if not _is_empty(line)]
    values.require_at_most(path, "file", len(numbered), values.MAX_FRAMES, noun="rows")
    separator, lines = separated(numbered)
    rows = csv.DictReader((line for _, line in lines), restkey=SURPLUS, delimiter=separator)
    try:
        names = rows.fieldnames or ()
        for key in ("name", *POSE_KEYS):
            if key not in names:
                expected = f"the columns {', '.join(COLUMNS)}"
                raise InputError(path, key, expected, "none of that name")
        sensors = tuple(_sensor(path, f"row {k}", row) for k, row in enumerate(rows, 1))
    except csv.Error as error:
        raise InputError(path, "file", "a table (CSV)", error) from None
    comments = itertools.takewhile(lambda line: line.startswith("#"), text.splitlines())
    head = "".join(f"{line}\n" for line in comments)
    return ForeignRig(sensors, document=CsvTable(head, names, [each.entry for each in sensors]))


def _is_empty(line: str) -> bool:
    """Whether a line is a comment or has no cell that is filled. A spreadsheet puts a comment in
    quotes, and separators in rows without cells."""
    return line.startswith(COMMENTS) or not line.strip(f'{SEPARATORS}" ')


def _sensor(path: Path, place: str, row: Mapping[str, Any]) -> PortableSensor:
    """Return the sensor of a row, `place`; its entry are the cells by column."""
    if surplus := [cell for cell in row.get(SURPLUS, []) if cell.strip()]:
        expected = "as many cells as the header has columns, and a decimal point"
        raise InputError(path, place, expected, f"{plural(len(surplus), 'cell')} more")
    # Cells that a row lacks are no texts.
    cells = {k: unmarked(c) if isinstance(c, str) else c for k, c in row.items() if k != SURPLUS}

    def number(key: str, rule: Number = FINITE) -> float:
        cell = cells[key]
        if isinstance(cell, str) and DECIMAL_COMMA.fullmatch(cell.strip()):
            raise InputError(path, f"{place}, {key}", "a decimal point", shown(cell))
        return values.figure(path, f"{place}, {key}", cell, rule)

    numbers = [number(key) for key in POSE_KEYS]
    pose = values.pose_from(path, place, numbers[:3], numbers[3:], degrees=True)
    kind, model, fusion = (cells.get(key) or None for key in ("kind", "model", "fusion"))
    nearest, farthest = (
        number(key, rule) if cells.get(key) else None for key, rule in RANGES.items()
    )
    picture = _picture(path, place, cells, number) if all(map(cells.get, FIGURES)) else None
    parameters = cells.get(PARAMETERS) or ""
    name = cells["name"]
    return PortableSensor(
        name=name,
        pose=pose,
        kind=kind,
        model=model,
        picture=picture,
        scan=None,
        fusion=fusion,
        min_range=nearest,
        max_range=farthest,
        parameters=parameters,
        entry=cells,
    )


def _picture(
    path: Path, place: str, cells: Mapping[str, Any], number: Callable[..., float]
) -> Picture:
    """Return the lens of a row."""
    width, height = (
        values.whole_figure(path, f"{place}, {key}", cells[key]) for key in FIGURES[:2]
    )
    fx, fy, cx, cy = map(number, FIGURES[2:])
    lens = LENSES[choice(path, f"{place}, lens", cells.get("lens") or "pinhole", LENSES)]
    field = f"{place}, coefficients"
    words = (cells.get("coefficients") or "").split()
    if len(words) > len(lens.coefficients):
        expected = f"at most {len(lens.coefficients)} of a {lens.model} lens"
        raise InputError(path, field, expected, len(words))
    figures = [values.figure(path, field, word) for word in words]
    fov = None
    if cells.get("fov_deg"):
        fov = math.radians(FOV_DEG.checked(path, f"{place}, fov_deg", number("fov_deg")))
    bent = dict(zip(lens.coefficients, figures, strict=False))
    return Picture(lens(fx, fy, cx, cy, fov=fov, **bent), (width, height))

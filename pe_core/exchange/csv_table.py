"""A table of sensors (CSV): for spreadsheets, and for people."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from ..errors import InputError, shown
from .carried import CarriedSensor
from .files import Written, plain_number, pose_from, text_of

FILE = "rig.csv"
PLACE, TURN = ("x_m", "y_m", "z_m"), ("roll_deg", "pitch_deg", "yaw_deg")
COLUMNS = ("name", "kind", "model", *PLACE, *TURN, "fusion")
HEAD = """\
# Origin on the ground under the vehicle's centre; x forward, y left, z up; metres, degrees.
# R = Rz(yaw) Ry(pitch) Rx(roll); positive pitch is nose down; a camera looks along its x axis.
"""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return the table of a rig."""
    out = io.StringIO()
    out.write(HEAD)
    table = csv.writer(out, lineterminator="\n")
    table.writerow(COLUMNS)
    for each in sensors:
        numbers = (*each.pose.position, *each.pose.rotation_deg)
        figures = [plain_number(v) for v in numbers]
        table.writerow([each.name, each.kind, each.model, *figures, each.fusion or ""])
    return {FILE: out.getvalue().encode()}, []


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read such a table; only the name and the numbers have to be there."""
    lines = [line for line in text_of(path).splitlines() if line and not line.startswith("#")]
    rows = csv.DictReader(lines)
    missing = [key for key in ("name", *PLACE, *TURN) if key not in (rows.fieldnames or ())]
    if missing:
        raise InputError(path, missing[0], f"the columns {', '.join(COLUMNS)}", "none of that name")
    try:
        return tuple(_read_row(path, k, row) for k, row in enumerate(rows))
    except csv.Error as error:
        raise InputError(path, "file", "a table (CSV)", error) from None


def _read_row(path: Path, number: int, row: dict[str, str]) -> CarriedSensor:
    numbers = []
    for key in (*PLACE, *TURN):
        try:
            numbers.append(float(row[key]))
        except (TypeError, ValueError):
            field = f"row {number + 1}, {key}"
            raise InputError(path, field, "a number", shown(row[key])) from None
    pose = pose_from(path, f"row {number + 1}", numbers[:3], numbers[3:], degrees=True)
    kind, model, fusion = (row.get(key) or None for key in ("kind", "model", "fusion"))
    return CarriedSensor(row["name"], pose, kind, model, fusion=fusion)

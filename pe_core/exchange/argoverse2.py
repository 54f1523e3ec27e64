"""Argoverse 2: the feather tables of a log's folder `calibration`.

Ego frame: the middle of the rear axle, at its height. A camera's frame is optical; a LiDAR's has
our axes. Cameras are pinholes there: its own reader takes no notice of k1, k2, k3, nor do we.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..scene.geometry import METRES
from ..text.files import read_bytes
from ..text.tables import Table
from ..text.values import vector
from .carried import CAMERA, LIDAR, CarriedSensor
from .elsewhere import brought
from .figures import COEFFICIENT, FOCAL, PIXELS, PLACE
from .files import Written
from .frames import BODY_FROM_OPTICAL, from_quaternion, pose_of, product, quaternion
from .pictures import Picture, pinhole_picture

POSES, INTRINSICS = "egovehicle_SE3_sensor.feather", "intrinsics.feather"
TITLE, NAME = "Argoverse 2", "sensor_name"
TURN, SHIFT = ("qw", "qx", "qy", "qz"), ("tx_m", "ty_m", "tz_m")
LENS, BENT = ("fx_px", "fy_px", "cx_px", "cy_px"), ("k1", "k2", "k3")
SIZE = ("height_px", "width_px")
CONVENTIONS = {
    "frame": "middle of the rear axle at its height; x forward, y left, z up; metres",
    "rotation": "egovehicle from sensor, unit quaternion; cameras: z forward, x right, y down",
    "intrinsics": "pinhole, pixels from the upper left corner; k1, k2, k3 are 0",
}
"""What stands in the tables' metadata."""
NO_BEND = "the file's k1, k2, k3 are not applied: Argoverse's own reader projects without them"


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return the two tables."""
    feather = brought("feather", TITLE)
    poses = [_pose_row(each) for each in sensors]
    known = [_lens_row(s.name, s.picture) for s in sensors if s.picture is not None]
    columns = (NAME, *TURN, *SHIFT), (NAME, *LENS, *BENT, *SIZE)
    tables = zip((POSES, INTRINSICS), columns, (poses, known), strict=True)
    return {
        file: feather.table_bytes(_by_column(names, rows), SIZE, CONVENTIONS)
        for file, names, rows in tables
    }, []


def _by_column(names: Sequence[str], rows: Sequence[Sequence[Any]]) -> dict[str, list[Any]]:
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}


def _pose_row(each: CarriedSensor) -> list[Any]:
    rotation = each.pose.ground_from_sensor
    if each.kind == CAMERA:
        rotation = product(rotation, BODY_FROM_OPTICAL)
    return [each.name, *quaternion(rotation), *each.pose.position]


def _lens_row(name: str, picture: Picture) -> list[Any]:
    width, height = picture.size or (0, 0)
    return [name, picture.fx, picture.fy, *picture.center, 0.0, 0.0, 0.0, height, width]


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the table of poses with that of cameras beside it; a folder with both will do."""
    path = path / POSES if path.is_dir() else path
    beside = path.with_name(INTRINSICS)
    cameras = {row.text(NAME): row for row in _rows(beside)}
    return tuple(_sensor(path, row, cameras) for row in _rows(path))


def _rows(path: Path) -> list[Table]:
    """Return a table's rows by name of column."""
    data = brought("feather", TITLE).rows_of(read_bytes(path))
    if data is None:
        raise InputError(path, "file", "a feather table", "something else")
    return [Table(row, str(path), f"row {k}") for k, row in enumerate(data, 1)]


def _sensor(path: Path, row: Table, cameras: Mapping[str, Table]) -> CarriedSensor:
    name = row.text(NAME)
    turn = vector(path, row.field("qw"), [row.number(key) for key in TURN], 4)
    place = vector(path, row.field("tx_m"), [row.number(key) for key in SHIFT], 3, METRES)
    rotation = from_quaternion(path, row.field("qw"), turn)
    if name not in cameras:
        return CarriedSensor(name, pose_of(rotation, place), LIDAR)
    lens = cameras[name]
    size = lens.whole("width_px", rule=PIXELS), lens.whole("height_px", rule=PIXELS)
    rules = FOCAL, FOCAL, PLACE, PLACE
    fx, fy, cx, cy = (lens.number(k, rule=rule) for k, rule in zip(LENS, rules, strict=True))
    picture = pinhole_picture(fx, fy, cx, cy, size)
    told = NO_BEND if any(lens.number(key, 0.0, COEFFICIENT) for key in BENT) else ""
    pose = pose_of(product(rotation, BODY_FROM_OPTICAL.T), place)
    return CarriedSensor(name, pose, CAMERA, None, picture, told=told)

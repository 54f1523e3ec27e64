"""Argoverse 2: the feather tables of a log's folder `calibration`.

The ego frame has its origin in the middle of the rear axle, at the height of the axle. A camera's
frame is optical. A LiDAR's frame has the axes of the ground frame. Cameras are read as pinholes:
like Argoverse's own reader, this module ignores the distortion coefficients k1, k2 and k3.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.files import read_bytes
from pe_core.base.memory import size_text
from pe_core.base.plugins import install_hint, required_plugin
from pe_core.base.table_reader import Table
from pe_core.base.values import vector
from pe_core.geometry.poses import METRES

from .foreign_values import COEFFICIENT, FOCAL, PIXELS, PRINCIPAL_POINT, Export, FileTexts
from .frames import BODY_FROM_OPTICAL, from_quaternion, pose_of, product, quaternion
from .lens_pictures import pinhole_picture
from .portable import PortableRig, PortableSensor
from .portable_kinds import CAMERA, LIDAR

MAX_TABLE_BYTES = 64_000_000
"""Maximum size of a table's values: a few kB that are compressed may be gigabytes."""
FILES = POSES, INTRINSICS = "egovehicle_SE3_sensor.feather", "intrinsics.feather"
TITLE, NAME = "Argoverse 2", "sensor_name"
TURN, SHIFT = ("qw", "qx", "qy", "qz"), ("tx_m", "ty_m", "tz_m")
LENS, BENT = ("fx_px", "fy_px", "cx_px", "cy_px"), ("k1", "k2", "k3")
SIZE = ("height_px", "width_px")
CONVENTIONS = {
    "frame": "middle of the rear axle at its height; x forward, y left, z up; metres",
    "rotation": "egovehicle from sensor, unit quaternion; cameras: z forward, x right, y down",
    "intrinsics": "pinhole, pixels from the upper left corner; k1, k2, k3 are 0",
}
"""Metadata of the written tables."""
NO_BEND = "the file's k1, k2, k3 are not applied: Argoverse's own reader projects without them"


def write(sensors: PortableRig, _texts: FileTexts) -> Export:
    """Return the tables of poses and of intrinsics, and no messages."""
    feather, poses, intrinsics = _feather(), [], []
    for sensor in sensors:
        rotation, p = sensor.pose.ground_from_sensor, sensor.picture
        if sensor.kind == CAMERA:
            rotation = product(rotation, BODY_FROM_OPTICAL)
        poses.append((sensor.name, *quaternion(rotation), *sensor.pose.position))
        if p is not None:
            size = (p.size or (0, 0))[::-1]
            intrinsics.append((sensor.name, p.fx, p.fy, *p.center, 0.0, 0.0, 0.0, *size))
    columns = (NAME, *TURN, *SHIFT), (NAME, *LENS, *BENT, *SIZE)
    return {
        file: feather.table_bytes(names, rows, SIZE, CONVENTIONS)
        for file, names, rows in zip(FILES, columns, (poses, intrinsics), strict=True)
    }, []


def read(path: Path) -> PortableRig:
    """Read the sensors from the table of poses, or its folder, and the intrinsics beside it."""
    path = path / POSES if path.is_dir() else path
    beside = path.with_name(INTRINSICS)
    cameras = {row.text(NAME): row for row in _rows(beside)}
    return tuple(_sensor(path, row, cameras) for row in _rows(path))


def _rows(path: Path) -> list[Table]:
    """Return the rows of a feather table; each row maps column names to values."""
    feather, data = _feather(), read_bytes(path)
    size = feather.unpacked_bytes(data)
    if size is not None and size > MAX_TABLE_BYTES:
        expected = f"a feather table of at most {size_text(MAX_TABLE_BYTES)} unpacked"
        raise InputError(path, "file", expected, size_text(size))
    rows = None if size is None else feather.rows_of(data)
    if rows is None:
        raise InputError(path, "file", "a feather table", "something else")
    return [Table(row, str(path), f"row {k}") for k, row in enumerate(rows, 1)]


def _sensor(path: Path, row: Table, cameras: Mapping[str, Table]) -> PortableSensor:
    name = row.text(NAME)
    rotation_values = vector(path, row.field("qw"), [row.number(key) for key in TURN], 4)
    position = vector(path, row.field("tx_m"), [row.number(key) for key in SHIFT], 3, METRES)
    rotation = from_quaternion(path, row.field("qw"), rotation_values)
    if name not in cameras:
        return PortableSensor(name, pose_of(rotation, position), LIDAR)
    intrinsics = cameras[name]
    size = intrinsics.whole("width_px", rule=PIXELS), intrinsics.whole("height_px", rule=PIXELS)
    rules = FOCAL, FOCAL, PRINCIPAL_POINT, PRINCIPAL_POINT
    fx, fy, cx, cy = (intrinsics.number(k, rule=rule) for k, rule in zip(LENS, rules, strict=True))
    picture = pinhole_picture(fx, fy, cx, cy, size)
    note = NO_BEND if any(intrinsics.number(key, 0.0, COEFFICIENT) for key in BENT) else ""
    pose = pose_of(product(rotation, BODY_FROM_OPTICAL.T), position)
    return PortableSensor(name, pose, CAMERA, None, picture, told=note)


def _feather() -> Any:
    """Return the feather module. Raise `InputError` when its library is not installed."""
    expected = install_hint("library", "feather")
    return required_plugin("library", "feather", TITLE, "library", expected)[1]

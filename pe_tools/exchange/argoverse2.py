"""Argoverse 2: the feather tables of a log's folder `calibration`. The ego frame has its origin in
the middle of the rear axle, at the height of the axle. A camera's frame is optical. A LiDAR's frame
has the axes of the ground frame. Cameras are read as pinholes: like Argoverse's own reader, this
module ignores the distortion coefficients k1, k2 and k3."""

import io
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.files import read_bytes
from pe_core.base.plugins import required_package
from pe_core.base.table_reader import Table
from pe_core.base.values import vector
from pe_core.geometry.poses import METRES
from pe_core.sensors.camera import Pinhole

from .foreign_values import COEFFICIENT, FOCAL, PIXELS, PRINCIPAL_POINT, Export
from .frames import BODY_FROM_OPTICAL, from_quaternion, pose_of, product, quaternion
from .lens_pictures import Picture
from .portable import ForeignRig, MergeTarget, PortableRig, PortableSensor
from .portable_kinds import CAMERA, LIDAR

MAGIC = b"ARROW1"  # First bytes of an Arrow file; its stream begins after two more
STREAM = 8
MAX_ROWS = 100_000  # Columns of the null type have rows without a byte
MAX_FILE_BYTES = 100_000
"""Maximum size of a file: what is compressed may be a thousand times as large."""
FILES = POSES, INTRINSICS = "egovehicle_SE3_sensor.feather", "intrinsics.feather"
TITLE = "Argoverse 2"
NAME = "sensor_name"
TURN = ("qw", "qx", "qy", "qz")
SHIFT = ("tx_m", "ty_m", "tz_m")
LENS = ("fx_px", "fy_px", "cx_px", "cy_px")
BENT = ("k1", "k2", "k3")
SIZE = ("height_px", "width_px")
CONVENTIONS = {
    "frame": "middle of the rear axle at its height; x forward, y left, z up; metres",
    "rotation": "egovehicle from sensor, unit quaternion; cameras: z forward, x right, y down",
    "intrinsics": "pinhole, pixels from the upper left corner; k1, k2, k3 are 0",
}
"""Metadata of the written tables."""
NO_BEND = "the file's k1, k2, k3 are not applied: Argoverse's own reader projects without them"


def write(sensors: PortableRig, _into: MergeTarget | None) -> Export:
    """Return the tables of poses and of intrinsics, and no messages."""
    poses: list[Sequence[Any]] = []
    intrinsics: list[Sequence[Any]] = []
    for sensor in sensors:
        rotation = sensor.pose.ground_from_sensor
        p = sensor.picture
        if sensor.kind == CAMERA:
            rotation = product(rotation, BODY_FROM_OPTICAL)
        poses.append((sensor.name, *quaternion(rotation), *sensor.pose.position))
        if p is not None:
            size = (p.size or (0, 0))[::-1]
            intrinsics.append((sensor.name, p.fx, p.fy, *p.center, 0.0, 0.0, 0.0, *size))
    columns = (NAME, *TURN, *SHIFT), (NAME, *LENS, *BENT, *SIZE)
    return {
        file: _table_bytes(names, rows, SIZE, CONVENTIONS)
        for file, names, rows in zip(FILES, columns, (poses, intrinsics), strict=True)
    }, []


def read(path: Path) -> ForeignRig:
    """Read the sensors from the table of poses, or its folder, and the intrinsics beside it."""
    path = path / POSES if path.is_dir() else path
    beside = path.with_name(INTRINSICS)
    cameras = {row.text(NAME): row for row in _rows(beside)}
    return ForeignRig(tuple(_sensor(path, row, cameras) for row in _rows(path)))


def _rows(path: Path) -> list[Table]:
    """Return the rows of a feather table; each row maps column names to values."""
    rows = _rows_of(read_bytes(path, MAX_FILE_BYTES))
    if rows is None:
        raise InputError(path, "file", "a feather table", "something else")
    return [Table(row, str(path), f"row {k}") for k, row in enumerate(rows, 1)]


def _sensor(path: Path, row: Table, cameras: Mapping[str, Table]) -> PortableSensor:
    name = row.text(NAME)
    rotation_values = vector(path, row.field("qw"), [row.number(key) for key in TURN], 4)
    position = vector(
        path, row.field("tx_m"), [row.number(key) for key in SHIFT], count=3, rule=METRES
    )
    rotation = from_quaternion(path, row.field("qw"), rotation_values)
    if name not in cameras:
        return PortableSensor(name, pose_of(rotation, position), LIDAR)
    intrinsics = cameras[name]
    size = intrinsics.whole("width_px", rule=PIXELS), intrinsics.whole("height_px", rule=PIXELS)
    rules = FOCAL, FOCAL, PRINCIPAL_POINT, PRINCIPAL_POINT
    fx, fy, cx, cy = (intrinsics.number(k, rule=rule) for k, rule in zip(LENS, rules, strict=True))
    picture = Picture(Pinhole(fx, fy, cx, cy), size)
    note = NO_BEND if any(intrinsics.number(key, 0.0, COEFFICIENT) for key in BENT) else ""
    pose = pose_of(product(rotation, BODY_FROM_OPTICAL.T), position)
    return PortableSensor(name, pose, CAMERA, model=None, picture=picture, told=note)


def _arrow() -> tuple[Any, Any]:
    """Return pyarrow and its feather module; `InputError` when they are not installed."""
    return required_package("pyarrow"), required_package("pyarrow.feather")


def _table_bytes(
    columns: Sequence[str],
    rows: Sequence[Sequence[Any]],
    whole: Collection[str],
    metadata: Mapping[str, str],
) -> bytes:
    """Return the bytes of a feather table. The columns of `whole` hold integers, sensor_name text,
    and all others floats."""
    pyarrow, feather = _arrow()
    own = {"sensor_name": pyarrow.string(), **dict.fromkeys(whole, pyarrow.int64())}
    types = [(name, own.get(name, pyarrow.float64())) for name in columns]
    schema = pyarrow.schema(types, metadata=dict(metadata))
    by_column = {name: [row[k] for row in rows] for k, name in enumerate(columns)}
    data = io.BytesIO()
    table = pyarrow.table(by_column, schema=schema)
    feather.write_feather(table, data, compression="uncompressed")
    return data.getvalue()


def _rows_of(data: bytes) -> list[dict[str, Any]] | None:
    """Return the rows of a feather table, each by column name; None if the data are no such table.
    A table of more than `MAX_ROWS` rows is none of a rig. Only version 2 of feather, the Arrow file
    format, is read, as the stream of messages that it holds: a damaged file of the obsolete version
    1 would crash the process inside pyarrow. pyarrow reads offsets and lengths unchecked, so
    `validate` checks them all before values are read."""
    if not data.startswith(MAGIC):
        return None
    pyarrow, _ = _arrow()
    try:
        table = pyarrow.ipc.open_stream(data[STREAM:]).read_all()
        if len(table) > MAX_ROWS:
            return None
        table.validate(full=True)
        rows: list[dict[str, Any]] = table.to_pylist()
    except Exception:  # pyarrow's own, OSError, UnicodeDecodeError, OverflowError, MemoryError
        return None
    return rows

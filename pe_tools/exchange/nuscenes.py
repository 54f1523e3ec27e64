"""nuScenes: the tables sensor.json and calibrated_sensor.json. The origin of the ego frame is the
middle of the rear axle, projected to the ground. A camera's frame is optical. A LiDAR's frame has x
to the right and y forward. The distortion is that of nuImages, camera_distortion: k1, k2, p1, p2,
k3, and k4 for fisheyes."""

import hashlib
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.table_reader import Table, dump_json
from pe_core.base.values import numbers, vector
from pe_core.geometry.poses import METRES
from pe_core.sensors.camera import BrownConrady

from . import frames
from .foreign_values import Export, json_of, json_rows
from .lens_pictures import Picture, pinhole_of
from .merging import Row, is_same_pose, merge_rows
from .portable import ForeignRig, MergeTarget, PortableRig, PortableSensor
from .portable_kinds import CAMERA, LIDAR

FILES = CALIBRATED, SENSORS = "calibrated_sensor.json", "sensor.json"
FIVE = ("k1", "k2", "p1", "p2", "k3")
POSE = ("translation", "rotation")
FIGURES = ("camera_intrinsic", "camera_distortion")
AXES = {CAMERA: frames.BODY_FROM_OPTICAL, LIDAR: frames.BODY_FROM_RIGHT_FORWARD}
"""Rotation from nuScenes' sensor axes to those of this project, by kind; others have the same."""


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return the two tables, and messages on image sizes, which the tables cannot hold."""
    tables: dict[str, list[Row]] = {CALIBRATED: [], SENSORS: []}
    if into is not None:
        gone = {sensor.entry["sensor_token"] for sensor in into.gone}
        tables = {
            CALIBRATED: [r for r in into.document[CALIBRATED] if r["sensor_token"] not in gone],
            SENSORS: [r for r in into.document[SENSORS] if r["token"] not in gone],
        }
    rows = tables[CALIBRATED]
    merge_rows(rows, sensors, None, _calibrated, pose_keys=POSE, figure_keys=FIGURES)
    tables[SENSORS] += [_known(sensor) for sensor in sensors if sensor.entry is None]
    sizes = [
        f"{s.name}: nuScenes' tables have no size of a picture; it is {w} x {h}"
        for s in sensors
        if s.picture is not None and s.picture.size is not None
        for w, h in [s.picture.size]
    ]
    return {name: dump_json(rows).encode() for name, rows in tables.items()}, sizes


def _known(sensor: PortableSensor) -> dict[str, Any]:
    return {"token": _token("sensor", sensor.name), "channel": sensor.name, "modality": sensor.kind}


def _calibrated(sensor: PortableSensor) -> dict[str, Any]:
    rotation = sensor.pose.ground_from_sensor
    if sensor.kind in AXES:
        rotation = frames.product(rotation, AXES[sensor.kind])
    p = sensor.picture
    row = {
        "token": _token("calibrated", sensor.name),
        "sensor_token": _token("sensor", sensor.name),
        "translation": list(sensor.pose.position),
        "rotation": list(frames.quaternion(rotation)),
        "camera_intrinsic": [] if p is None else p.matrix,
    }
    if p is not None and isinstance(p.lens, BrownConrady):
        row["camera_distortion"] = [getattr(p.lens, key) for key in FIVE]
    return row


def _token(table: str, name: str) -> str:
    """Return a nuScenes token of 32 hexadecimal digits, a hash of the table and the name."""
    return hashlib.sha256(f"{table} {name}".encode()).hexdigest()[:32]


def read(path: Path) -> ForeignRig:
    """Read the sensors from calibrated_sensor.json, or its folder, and the sensor.json beside it.
    The last calibration of a sensor is used; a note says so if another one differs from it."""
    path = path / CALIBRATED if path.is_dir() else path
    beside = path.with_name(SENSORS)
    document = {CALIBRATED: json_of(path), SENSORS: json_of(beside)}
    names = {row.text("token"): row for row in json_rows(beside, document[SENSORS])}
    calibrations: dict[str, list[PortableSensor]] = {}
    for row in json_rows(path, document[CALIBRATED]):
        token = row.text("sensor_token")
        if token not in names:
            raise InputError(path, row.field("sensor_token"), f"one in {SENSORS}", shown(token))
        sensor = _sensor(path, row, names[token])
        calibrations.setdefault(sensor.name, []).append(sensor)
    return ForeignRig(tuple(map(_last, calibrations.values())), document=document)


def _last(calibrations: Sequence[PortableSensor]) -> PortableSensor:
    """Return the last calibration of a sensor, with a note if they are not all the same."""
    last = calibrations[-1]
    same = [
        is_same_pose(each.pose, last.pose) and each.picture == last.picture for each in calibrations
    ]
    if all(same):
        return last
    apart = max(math.dist(each.pose.position, last.pose.position) for each in calibrations)
    turned = max(frames.turn_between(each.pose, last.pose) for each in calibrations)
    note = f"the file has {len(calibrations)} calibrations, up to {apart:.3f} m and "
    note += f"{math.degrees(turned):.2f} deg from the last"
    return replace(last, told="; ".join(filter(None, (f"{note}, which is used", last.told))))


def _sensor(path: Path, row: Table, sensor_row: Table) -> PortableSensor:
    name = sensor_row.text("channel")
    kind = sensor_row.text("modality")
    position = vector(path, row.field("translation"), row.raw("translation"), count=3, rule=METRES)
    rotation_values = vector(path, row.field("rotation"), row.raw("rotation"), 4)
    rotation = frames.from_quaternion(path, row.field("rotation"), rotation_values)
    if kind in AXES:
        rotation = frames.product(rotation, AXES[kind].T)
    picture = None
    note = ""
    value = row.raw("camera_intrinsic", [])
    if value != []:
        matrix = numbers(value)
        if matrix is None or matrix.shape != (3, 3):
            raise row.error("a 3 x 3 matrix, or []", shown(value), "camera_intrinsic")
        lens, skew_note = pinhole_of(path, row.field("camera_intrinsic"), matrix)
        picture = Picture(lens)
        if row.raw("camera_distortion", []):
            picture, note = _bent(row, picture)
        note = "; ".join(filter(None, (skew_note, note)))
    pose = frames.pose_of(rotation, position)
    return PortableSensor(name, pose, kind, model=None, picture=picture, told=note, entry=row.table)


def _bent(row: Table, picture: Picture) -> tuple[Picture, str]:
    """Return the intrinsics with nuImages' distortion, and a note on accuracy (may be empty)."""
    values = row.raw("camera_distortion")
    coefficients = numbers(values)
    if coefficients is None or coefficients.ndim != 1 or len(coefficients) not in (4, 5, 6):
        expected = "4 to 6 numbers: k1, k2, p1, p2, k3, k4"
        raise row.error(expected, shown(values), "camera_distortion")
    k1, k2, p1, p2, k3, k4 = [*map(float, coefficients), 0.0, 0.0][:6]
    lens = picture.lens
    note = "its sixth coefficient, of r^8, is left out" if k4 else ""
    return Picture(
        BrownConrady(
            fx=lens.fx,
            fy=lens.fy,
            cx=lens.cx,
            cy=lens.cy,
            fov=None,
            k1=k1,
            k2=k2,
            p1=p1,
            p2=p2,
            k3=k3,
        )
    ), note

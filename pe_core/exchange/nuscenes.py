"""nuScenes: the tables sensor.json and calibrated_sensor.json.

Ego frame: the rear axle on the ground. A camera's frame is optical; a LiDAR's has x to the right
and y forward. Distortion is nuImages' camera_distortion: k1, k2, p1, p2, k3, of fisheyes also k4.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from ..errors import InputError, shown
from ..kinds.camera import BrownConrady
from ..scene.geometry import METRES
from ..text.tables import Table
from ..text.values import numbers, vector
from .carried import CAMERA, LIDAR, CarriedSensor
from .files import Written, json_bytes, json_of, json_rows
from .fourth_power import with_fourth
from .frames import (
    BODY_FROM_OPTICAL,
    BODY_FROM_RIGHT_FORWARD,
    Floats,
    from_quaternion,
    pose_of,
    product,
    quaternion,
)
from .passthrough import entry_row, json_entry
from .pictures import Picture, pinhole_picture

CALIBRATED, SENSORS = "calibrated_sensor.json", "sensor.json"
FIVE = ("k1", "k2", "p1", "p2", "k3")
POSE, FIGURES = ("translation", "rotation"), ("camera_intrinsic", "camera_distortion")
AXES = {CAMERA: BODY_FROM_OPTICAL, LIDAR: BODY_FROM_RIGHT_FORWARD}
"""A kind's axes there, in ours; other kinds have ours."""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return the two tables."""
    calibrated = [entry_row(each, _calibrated, POSE, FIGURES, CALIBRATED) for each in sensors]
    known = [entry_row(each, _known, (), (), SENSORS) for each in sensors]
    sizes = [
        f"{s.name}: nuScenes' tables have no size of a picture; it is {w} x {h}"
        for s in sensors
        if s.picture is not None and s.picture.size is not None
        for w, h in [s.picture.size]
    ]
    return {CALIBRATED: json_bytes(calibrated), SENSORS: json_bytes(known)}, sizes


def _known(each: CarriedSensor) -> dict[str, Any]:
    return {"token": _token("sensor", each.name), "channel": each.name, "modality": each.kind}


def _calibrated(each: CarriedSensor) -> dict[str, Any]:
    rotation = each.pose.ground_from_sensor
    if each.kind in AXES:
        rotation = product(rotation, AXES[each.kind])
    p = each.picture
    row = {
        "token": _token("calibrated", each.name),
        "sensor_token": _token("sensor", each.name),
        "translation": list(each.pose.position),
        "rotation": list(quaternion(rotation)),
        "camera_intrinsic": [] if p is None else p.matrix,
    }
    if p is not None and isinstance(p.lens, BrownConrady):
        row["camera_distortion"] = [getattr(p.lens, key) for key in FIVE]
    return row


def _token(table: str, name: str) -> str:
    """Return a token as nuScenes has them, 32 hexadecimal digits, the same every time."""
    return hashlib.sha256(f"{table} {name}".encode()).hexdigest()[:32]


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read calibrated_sensor.json with the sensor.json beside it; a folder with both will do.

    Of a sensor that was calibrated several times the last is taken.
    """
    path = path / CALIBRATED if path.is_dir() else path
    beside = path.with_name(SENSORS)
    names = {row.text("token"): row for row in json_rows(beside, json_of(beside))}
    found = {}
    for row in json_rows(path, json_of(path)):
        token = row.text("sensor_token")
        if token not in names:
            raise InputError(path, row.field("sensor_token"), f"one in {SENSORS}", shown(token))
        sensor = _sensor(path, row, names[token])
        found[sensor.name] = sensor
    return tuple(found.values())


def _sensor(path: Path, row: Table, known: Table) -> CarriedSensor:
    name, kind = known.text("channel"), known.text("modality")
    place = vector(path, row.field("translation"), row.raw("translation"), 3, METRES)
    turn = vector(path, row.field("rotation"), row.raw("rotation"), 4)
    rotation = from_quaternion(path, row.field("rotation"), turn)
    if kind in AXES:
        rotation = product(rotation, AXES[kind].T)
    picture = _picture(path, row.field("camera_intrinsic"), row.raw("camera_intrinsic", []))
    told = ""
    if picture is not None and row.raw("camera_distortion", []):
        picture, told = _bent(path, row, picture)
    entry = json_entry({CALIBRATED: row.data, SENSORS: known.data})
    return CarriedSensor(
        name, pose_of(rotation, place), kind, None, picture, told=told, entry=entry
    )


def _picture(path: Path, field: str, value: Any) -> Picture | None:
    if value == []:
        return None
    matrix: Floats | None = numbers(value)
    if matrix is None or matrix.shape != (3, 3):
        raise InputError(path, field, "a 3 x 3 matrix, or []", shown(value))
    fx, fy, cx, cy = (float(matrix[k]) for k in ((0, 0), (1, 1), (0, 2), (1, 2)))
    return pinhole_picture(fx, fy, cx, cy)


def _bent(path: Path, row: Table, picture: Picture) -> tuple[Picture, str]:
    """Return a picture with nuImages' distortion, and what has to be known of it, if anything."""
    field, values = row.field("camera_distortion"), row.raw("camera_distortion")
    found = numbers(values)
    if found is None or found.ndim != 1 or len(found) not in (4, 5, 6):
        raise InputError(path, field, "4 to 6 numbers: k1, k2, p1, p2, k3, k4", shown(values))
    k1, k2, p1, p2, k3, k4 = [*map(float, found), 0.0, 0.0][:6]
    if k4:
        return with_fourth(picture, (k1, k2, k3, k4), (p1, p2))
    lens = picture.lens
    place = lens.fx, lens.fy, lens.cx, lens.cy
    return Picture(BrownConrady(*place, None, k1, k2, p1, p2, k3)), ""

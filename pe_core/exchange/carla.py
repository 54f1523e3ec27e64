"""CARLA's objects.json, as its ROS bridge spawns sensors: right-handed, degrees."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..text.tables import Table
from ..text.values import Number
from .carried import CAMERA, LIDAR, CarriedSensor, Scan, uneven
from .figures import CHANNELS, PIXELS, RANGE
from .files import Written, json_bytes, json_of, json_rows, named_numbers, pose_from
from .pictures import Picture, picture_of_fov

FILE = "objects.json"
TYPES = {CAMERA: "sensor.camera.rgb", LIDAR: "sensor.lidar.ray_cast"}
VEHICLE = {"type": "vehicle.*", "id": "ego_vehicle"}
FRAMES_A_SECOND = 10
SCAN_KEYS = (
    *("channels", "upper_fov", "lower_fov", "range", "points_per_second", "rotation_frequency"),
)
FOV = Number(0.0, 180.0, above=True, below=True, unit="degrees", noun="angle")
UP = Number(-90.0, 90.0, unit="degrees", noun="angle")
RATE = Number(0.0, above=True, cap=1e12)
PLACE, TURN = ("x", "y", "z"), ("roll", "pitch", "yaw")


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return an ego vehicle with the rig."""
    rows = [_row(each) for each in sensors if each.kind in TYPES]
    lines = [f"{s.name}: CARLA has no {s.kind}; left out" for s in sensors if s.kind not in TYPES]
    return {FILE: json_bytes({"objects": [{**VEHICLE, "sensors": rows}]})}, lines + uneven(
        sensors, "CARLA"
    )


def _row(each: CarriedSensor) -> dict[str, Any]:
    numbers = (*each.pose.position, *each.pose.rotation_deg)
    row: dict[str, Any] = {
        "type": TYPES[each.kind or ""],
        "id": each.name,
        "spawn_point": dict(zip((*PLACE, *TURN), numbers, strict=True)),
    }
    if each.picture is not None and each.picture.size is not None:
        width, height = each.picture.size
        fov = math.degrees(2.0 * math.atan(width / (2.0 * each.picture.fx)))
        row |= {"image_size_x": width, "image_size_y": height, "fov": fov}
    if each.scan is not None:
        row |= _lidar(each.scan)
    return row


def _lidar(scan: Scan) -> dict[str, Any]:
    return {
        "range": scan.max_range,
        "channels": scan.channels,
        "points_per_second": scan.beam_count * FRAMES_A_SECOND,
        "upper_fov": math.degrees(scan.high),
        "lower_fov": math.degrees(scan.low),
        "rotation_frequency": FRAMES_A_SECOND,
    }


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the sensors of the first vehicle that has some."""
    top = Table(json_of(path), str(path))
    for vehicle in json_rows(path, top.raw("objects"), "objects"):
        rows = json_rows(path, vehicle.raw("sensors", []), vehicle.field("sensors"))
        found = [_sensor(path, row) for row in rows if "spawn_point" in row]
        if found:
            return tuple(found)
    raise InputError(path, "objects", "a vehicle with sensors", "none")


def _sensor(path: Path, row: Table) -> CarriedSensor:
    spawn, words = row.table("spawn_point"), row.text("type")
    place, turn = (
        [spawn.number(key, 0.0) for key in TURN] if keys is TURN else named_numbers(spawn, keys)
        for keys in (PLACE, TURN)
    )
    pose = pose_from(path, row.field("spawn_point"), place, turn, degrees=True)
    kind = next((kind for kind in (CAMERA, LIDAR) if f".{kind}." in words), None)
    where = CarriedSensor(row.text("id"), pose, kind)
    if kind == CAMERA and all(key in row for key in ("image_size_x", "image_size_y", "fov")):
        return replace(where, picture=_picture(row))
    if kind == LIDAR and all(key in row for key in SCAN_KEYS):
        return replace(where, scan=_scan(row))
    return where


def _picture(row: Table) -> Picture:
    size = row.whole("image_size_x", rule=PIXELS), row.whole("image_size_y", rule=PIXELS)
    return picture_of_fov(math.radians(row.number("fov", rule=FOV)), size)


def _scan(row: Table) -> Scan:
    frames, channels = (
        row.number("rotation_frequency", rule=RATE),
        row.whole("channels", rule=CHANNELS),
    )
    beams = row.number("points_per_second", rule=RATE) / frames
    low, high = (math.radians(row.number(key, rule=UP)) for key in ("lower_fov", "upper_fov"))
    if low > high:
        raise row.error("lower_fov", "an angle up to upper_fov", f"{math.degrees(low):g}")
    azimuths = max(round(beams / channels), 1)
    return Scan(channels, low, high, azimuths, (-math.pi, math.pi), row.number("range", rule=RANGE))

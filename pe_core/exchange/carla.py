"""CARLA's objects.json, as its ROS bridge spawns sensors: right-handed, degrees."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..kinds.lidar import Lidar
from ..text.tables import Table
from .carried import CAMERA, LIDAR, CarriedSensor, Picture, beam_fan, uneven
from .files import Written, json_bytes, json_of, json_rows, named_numbers, pose_from

FILE = "objects.json"
TYPES = {CAMERA: "sensor.camera.rgb", LIDAR: "sensor.lidar.ray_cast"}
VEHICLE = {"type": "vehicle.*", "id": "ego_vehicle"}
FRAMES_A_SECOND = 10
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
    if isinstance(each.sensor_model, Lidar):
        row |= _lidar(each.sensor_model)
    return row


def _lidar(model: Lidar) -> dict[str, Any]:
    channels, low, high, _ = beam_fan(model) or (0, 0.0, 0.0, True)
    return {
        "range": model.max_range,
        "channels": channels,
        "points_per_second": model.beam_count * FRAMES_A_SECOND,
        "upper_fov": math.degrees(high),
        "lower_fov": math.degrees(low),
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
    picture = None
    if all(key in row for key in ("image_size_x", "image_size_y", "fov")):
        width, height = row.whole("image_size_x"), row.whole("image_size_y")
        focal = width / (2.0 * math.tan(math.radians(row.number("fov")) / 2.0))
        picture = Picture(focal, focal, width / 2.0, height / 2.0, (width, height))
    return CarriedSensor(row.text("id"), pose, kind, None, picture)

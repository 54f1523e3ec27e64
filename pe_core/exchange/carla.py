"""CARLA's objects.json, as its ROS bridge spawns sensors: right-handed, degrees."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..text.tables import Table
from ..text.values import Number
from .carried import CAMERA, LIDAR, CarriedSensor, Scan, uneven
from .figures import CHANNELS, PIXELS, RANGE
from .files import Written, json_bytes, json_of, json_rows, json_text, named_numbers, pose_from
from .frame_names import with_legal_frames
from .passthrough import ORIGIN, entry_row, json_entry
from .pictures import Picture, picture_of_fov

FILE = "objects.json"
TYPES = {CAMERA: "sensor.camera.rgb", LIDAR: "sensor.lidar.ray_cast"}
VEHICLE = {"type": "vehicle.*", "id": "ego_vehicle"}
FRAMES_A_SECOND = 10
TINY_DEG = 1e-6
SCAN_KEYS = (
    *("channels", "upper_fov", "lower_fov", "range", "points_per_second", "rotation_frequency"),
)
FOV = Number(0.0, 180.0, above=True, below=True, unit="degrees", noun="angle")
UP = Number(-90.0, 90.0, unit="degrees", noun="angle")
AROUND = Number(0.0, 360.0, above=True, unit="degrees", noun="angle")
RATE, TURNS = Number(0.0, above=True, cap=1e12), Number(1e-3, cap=1e6)
"""Points and turns a second."""
SPAWN, LISTS, ACROSS = "spawn_point", ("sensors", "objects"), "horizontal_fov"
FIGURES = ("image_size_x", "image_size_y", "fov", *SCAN_KEYS, ACROSS)
PLACE, TURN = ("x", "y", "z"), ("roll", "pitch", "yaw")


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return an ego vehicle with the rig."""
    return _written({"objects": [dict(VEHICLE)]}, sensors)


def write_over(
    texts: Mapping[str, str], sensors: tuple[CarriedSensor, ...]
) -> tuple[Written, list[str]]:
    """Return the file that came in, with the rig on its vehicle."""
    return _written(json_text("passthrough", texts.get(FILE, "")), sensors)


def _written(document: Any, sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a document with the rig on its first vehicle that has none yet."""
    named, lines = with_legal_frames(sensors)
    known = [each for each in named if each.is_left_out or each.kind in TYPES]
    lines += [f"{s.name}: CARLA has no {s.kind}; left out" for s in named if s not in known]
    rows = [entry_row(each, _row, (SPAWN,), FIGURES) for each in known]
    vehicle, key = _place_of_sensors("passthrough", document)
    vehicle[key] = rows
    lines += [line for each in named if (line := _turned_line(each))]
    return {FILE: json_bytes(document)}, lines + uneven(named, "CARLA")


def _turned_line(each: CarriedSensor) -> str:
    """Return a line on a LiDAR whose azimuths are not as far to the left as to the right."""
    low, high = each.scan.fov if each.scan is not None else (0.0, 0.0)
    if abs(math.degrees(low + high)) < TINY_DEG:
        return ""
    ends = " to ".join(f"{math.degrees(end):g}" for end in (low, high))
    return (
        f"{each.name}: CARLA's horizontal_fov is to both sides alike; its azimuths are {ends} deg"
    )


def _place_of_sensors(source: object, document: Any) -> tuple[dict[str, Any], str]:
    """Return the first object that has a list of sensors, else a vehicle, and the list's key."""
    objects = document.get("objects") if isinstance(document, dict) else None
    mappings = [each for each in objects or () if isinstance(each, dict)]
    for each in mappings:
        for key in LISTS:
            if key in each:
                return each, key
    vehicle = next((o for o in mappings if str(o.get("type")).startswith("vehicle.")), None)
    if vehicle is None:
        raise InputError(source, "objects", "a vehicle with sensors", "none")
    return vehicle, LISTS[0]


def _row(each: CarriedSensor) -> dict[str, Any]:
    numbers = (*each.pose.position, *each.pose.rotation_deg)
    row: dict[str, Any] = {
        "type": TYPES[each.kind or ""],
        "id": each.name,
        SPAWN: dict(zip((*PLACE, *TURN), numbers, strict=True)),
    }
    if each.picture is not None and each.picture.size is not None:
        width, height = each.picture.size
        fov = math.degrees(2.0 * math.atan(width / (2.0 * each.picture.fx)))
        row |= {"image_size_x": width, "image_size_y": height, "fov": fov}
    if each.scan is not None:
        row |= _lidar(each.scan)
    return row


def _lidar(scan: Scan) -> dict[str, Any]:
    low, high = scan.fov
    across = math.degrees(high - low)
    return {
        **({ACROSS: across} if across < 360.0 - TINY_DEG else {}),
        "range": scan.max_range,
        "channels": scan.channels,
        "points_per_second": scan.beam_count * FRAMES_A_SECOND,
        "upper_fov": math.degrees(scan.high),
        "lower_fov": math.degrees(scan.low),
        "rotation_frequency": FRAMES_A_SECOND,
    }


def source(path: Path) -> dict[str, str]:
    """Return the file's text without its sensors, which go in again."""
    document = json_of(path)
    vehicle, key = _place_of_sensors(path, document)
    vehicle[key] = []
    return {FILE: json_entry(document)}


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the sensors of the first vehicle that has some."""
    document = json_of(path)
    vehicle, key = _place_of_sensors(path, document)
    rows = json_rows(path, vehicle.get(key, []), f"{vehicle.get('id', 'vehicle')}.{key}")
    found = tuple(_sensor(path, row) for row in rows)
    if not any("spawn_point" in row for row in rows):
        raise InputError(path, "objects", "a vehicle with sensors", "none")
    return found


def _sensor(path: Path, row: Table) -> CarriedSensor:
    words = row.text("type")
    if SPAWN not in row:  # a pseudo sensor: CARLA's own view of the world
        return CarriedSensor(row.text("id"), ORIGIN, "pseudo", entry=json_entry(row.data))
    spawn = row.table(SPAWN)
    place, turn = (
        [spawn.number(key, 0.0) for key in TURN] if keys is TURN else named_numbers(spawn, keys)
        for keys in (PLACE, TURN)
    )
    pose = pose_from(path, row.field(SPAWN), place, turn, degrees=True)
    kind = next((kind for kind in (CAMERA, LIDAR) if f".{kind}." in words), None)
    kind = kind or words.removeprefix("sensor.").removeprefix("other.")
    where = CarriedSensor(row.text("id"), pose, kind, entry=json_entry(row.data))
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
        row.number("rotation_frequency", rule=TURNS),
        row.whole("channels", rule=CHANNELS),
    )
    beams = row.number("points_per_second", rule=RATE) / frames
    low, high = (math.radians(row.number(key, rule=UP)) for key in ("lower_fov", "upper_fov"))
    if low > high:
        raise row.error("lower_fov", "an angle up to upper_fov", f"{math.degrees(low):g}")
    azimuths = max(round(beams / channels), 1)
    half = math.radians(row.number(ACROSS, 360.0, rule=AROUND)) / 2.0
    return Scan(channels, low, high, azimuths, (-half, half), row.number("range", rule=RANGE))

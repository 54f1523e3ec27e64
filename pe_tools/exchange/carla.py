"""CARLA's objects.json, from which its ROS document spawns sensors. Coordinates are right-handed,
angles are in degrees. Autoware's interface to CARLA has a file of that name with a list of sensors
alone: its numbers are in CARLA's own coordinates, which are left-handed."""

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.table_reader import Table, dump_json
from pe_core.base.values import Number

from . import foreign_values as values
from .foreign_values import PIXELS, RANGE, RPY, XYZ, Export, json_of, json_rows
from .frames import with_legal_frames
from .lens_pictures import picture_of_fov
from .merging import merge_rows
from .portable import (
    ORIGIN,
    FieldOfView,
    ForeignRig,
    MergeTarget,
    PortableRig,
    PortableSensor,
    Scan,
    uneven,
)
from .portable_kinds import CAMERA, LIDAR, RADAR

FILE = "objects.json"
TYPES = {CAMERA: "camera.rgb", LIDAR: "lidar.ray_cast", RADAR: "other.radar"}
KINDS = {type_name: kind for kind, type_name in TYPES.items()}
"""Kinds by type, without the prefix `sensor.`: the types that model a real sensor of these kinds.
Other cameras and LiDARs are left out: their figures do not describe what a detector sees."""
GROUND_TRUTH = "ground truth"
TRUTH_TYPES = frozenset(
    {
        "camera.cosmos_visualization",
        "camera.depth",
        "camera.instance_segmentation",
        "camera.normals",
        "camera.optical_flow",
        "camera.semantic_segmentation",
        "lidar.ray_cast_semantic",
    }
)
"""Types that show the simulated world without error (CARLA's sensors reference)."""
SPECTATOR = "spectator"
SPECTATOR_NAMES = ("rgb_view", "spectator")
"""Cameras behind the vehicle that show it to a person: carla_manual_control shows `rgb_view`."""
FRAMES_A_SECOND = 10
TINY_DEG = 1e-6
SCAN_KEYS = (
    "channels",
    "upper_fov",
    "lower_fov",
    "range",
    "points_per_second",
    "rotation_frequency",
)
FOV = Number(0.0, 180.0, above=True, below=True, unit="degrees", noun="angle")
UP = Number(-90.0, 90.0, unit="degrees", noun="angle")
AROUND = Number(0.0, 360.0, above=True, unit="degrees", noun="angle")
RATE = Number(0.0, above=True, cap=1e12)
TURNS = Number(1e-3, cap=1e6)
"""Points per second, and rotations per second."""
SPAWN = "spawn_point"
LISTS = ("sensors", "objects")
MIRRORED = ("y", "pitch", "yaw")
"""Coordinates that have the other sign in CARLA's own frame, whose y axis is to the right."""
OWN_FRAME = "a list of sensors alone: read in CARLA's own coordinates, y to the right"
ACROSS = "horizontal_fov"
UPWARDS = "vertical_fov"
RADAR_FOV_DEG = 30.0
RADAR_RANGE_M = 100.0
"""CARLA's defaults of a radar: both angles, and the range (sensors reference)."""
FIGURES = ("image_size_x", "image_size_y", "fov", *SCAN_KEYS, ACROSS, UPWARDS)


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return a document whose first vehicle carries the rig, and messages on losses."""
    document: Any = {"objects": [{"type": "vehicle.*", "id": "ego_vehicle"}]}
    if into is not None:
        document = into.document
    named, lines = with_legal_frames(sensors, taken=() if into is None else into.taken)
    supported = [sensor for sensor in named if sensor.kind in TYPES]
    lines += [f"{s.name}: CARLA has no {s.kind}; left out" for s in named if s not in supported]
    vehicle, key = _place_of_sensors(FILE, document)
    rows = vehicle.setdefault(key, [])
    row = partial(_row, is_own=_is_own_frame(document))
    merge_rows(rows, supported, into, row, pose_keys=(SPAWN,), figure_keys=FIGURES)
    for sensor in named:
        low, high = sensor.scan.fov if sensor.scan is not None else (0.0, 0.0)
        if abs(math.degrees(low + high)) >= TINY_DEG:
            ends = f"{math.degrees(low):g} to {math.degrees(high):g} deg"
            text = f"CARLA's horizontal_fov is to both sides alike; its azimuths are {ends}"
            lines.append(f"{sensor.name}: {text}")
    return {FILE: dump_json(document).encode()}, lines + uneven(named, "CARLA")


def _place_of_sensors(source: object, document: Any) -> tuple[dict[str, Any], str]:
    """Return the object that holds the sensors, and the key of its list of sensors. It is the first
    object with such a list, or else the first vehicle."""
    if _is_own_frame(document):
        return document, LISTS[0]
    objects = document.get("objects") if isinstance(document, dict) else None
    mappings = [mapping for mapping in objects or () if isinstance(mapping, dict)]
    for mapping in mappings:
        for key in LISTS:
            if key in mapping:
                return mapping, key
    vehicle = next((o for o in mappings if str(o.get("type")).startswith("vehicle.")), None)
    if vehicle is None:
        raise InputError(source, "objects", "a vehicle with sensors", "none")
    return vehicle, LISTS[0]


def _is_own_frame(document: Any) -> bool:
    """Whether a document is a list of sensors alone, in CARLA's own coordinates."""
    return isinstance(document, dict) and "objects" not in document and LISTS[0] in document


def _row(sensor: PortableSensor, *, is_own: bool) -> dict[str, Any]:
    row: dict[str, Any] = {"type": f"sensor.{TYPES[sensor.kind or '']}", "id": sensor.name}
    numbers = values.pose_numbers(sensor.pose, degrees=True)
    row[SPAWN] = {key: _signed(key, value, is_own) for key, value in numbers.items()}
    if sensor.picture is not None and sensor.picture.size is not None:
        width, height = sensor.picture.size
        fov = math.degrees(2.0 * math.atan(width / (2.0 * sensor.picture.fx)))
        row |= {"image_size_x": width, "image_size_y": height, "fov": fov}
    if sensor.scan is not None:
        across = math.degrees(sensor.scan.fov[1] - sensor.scan.fov[0])
        row |= {
            **({ACROSS: across} if across < 360.0 - TINY_DEG else {}),
            "range": sensor.scan.max_range,
            "channels": sensor.scan.channels,
            "points_per_second": sensor.scan.beam_count * FRAMES_A_SECOND,
            "upper_fov": math.degrees(sensor.scan.high),
            "lower_fov": math.degrees(sensor.scan.low),
            "rotation_frequency": FRAMES_A_SECOND,
        }
    if sensor.field is not None:
        for key, ends in ((ACROSS, sensor.field.across), (UPWARDS, sensor.field.up)):
            row[key] = math.degrees(2.0 * max(map(abs, ends)))
        row["range"] = sensor.field.max_range
    return row


def _signed(key: str, value: float, is_own: bool) -> float:
    """Return a coordinate of CARLA's own frame in the right-handed one, or the other way round."""
    return 0.0 - value if is_own and key in MIRRORED else value


def read(path: Path) -> ForeignRig:
    """Read the sensors of the first vehicle that has a list of sensors, one with a spawn point."""
    document = json_of(path)
    vehicle, key = _place_of_sensors(path, document)
    rows = json_rows(path, vehicle.get(key, []), f"{vehicle.get('id', 'vehicle')}.{key}")
    is_own = _is_own_frame(document)
    sensors = tuple(_sensor(path, row, is_own) for row in rows)
    if not any("spawn_point" in row for row in rows):
        raise InputError(path, "objects", "a vehicle with sensors", "none")
    return ForeignRig(sensors, [OWN_FRAME] if is_own else [], document)


def _sensor(path: Path, row: Table, is_own: bool) -> PortableSensor:
    type_name = row.text("type")
    if SPAWN not in row:  # a pseudo sensor: CARLA's own view of the world
        return PortableSensor(row.text("id"), ORIGIN, "pseudo", entry=row.table)
    spawn = row.at(SPAWN, {})
    numbers = dict(zip(XYZ, values.named_numbers(spawn, XYZ), strict=True))
    numbers |= {key: spawn.number(key, 0.0) for key in RPY}
    position, angles = ([_signed(key, numbers[key], is_own) for key in keys] for keys in (XYZ, RPY))
    pose = values.pose_from(path, row.field(SPAWN), position, angles, degrees=True)
    kind = _kind(type_name.removeprefix("sensor."), row.text("id"))
    sensor = PortableSensor(row.text("id"), pose, kind, entry=row.table)
    if kind == CAMERA and all(key in row for key in ("image_size_x", "image_size_y", "fov")):
        size = row.whole("image_size_x", rule=PIXELS), row.whole("image_size_y", rule=PIXELS)
        picture = picture_of_fov(math.radians(row.number("fov", rule=FOV)), size)
        return replace(sensor, picture=picture)
    if kind == LIDAR and all(key in row for key in SCAN_KEYS):
        return replace(sensor, scan=_scan(row))
    if kind == RADAR and any(key in row for key in (ACROSS, UPWARDS, "range")):  # to both sides
        across, up = (
            math.radians(row.number(key, RADAR_FOV_DEG, rule=rule)) / 2.0
            for key, rule in ((ACROSS, AROUND), (UPWARDS, FOV))
        )
        reach = row.number("range", RADAR_RANGE_M, rule=RANGE)
        return replace(sensor, field=FieldOfView((-across, across), (-up, up), reach))
    return sensor


def _kind(type_name: str, name: str) -> str:
    """Return the kind of a sensor by its type, without the prefix `sensor.`, and by its name."""
    if type_name in TRUTH_TYPES:
        return GROUND_TRUTH
    kind = KINDS.get(type_name) or type_name.removeprefix("other.")
    return SPECTATOR if kind == CAMERA and name.lower() in SPECTATOR_NAMES else kind


def _scan(row: Table) -> Scan:
    frames = row.number("rotation_frequency", rule=TURNS)
    channels = row.whole("channels", rule=values.CHANNELS)
    beams = row.number("points_per_second", rule=RATE) / frames
    low, high = (math.radians(row.number(key, rule=UP)) for key in ("lower_fov", "upper_fov"))
    if low > high:
        raise row.error("an angle up to upper_fov", f"{math.degrees(low):g}", "lower_fov")
    azimuths = max(round(beams / channels), 1)
    half = math.radians(row.number(ACROSS, 360.0, rule=AROUND)) / 2.0
    return Scan(
        channels, low, high, azimuths, fov=(-half, half), max_range=row.number("range", rule=RANGE)
    )

"""Autoware's sensor kit: sensors_calibration.yaml and sensor_kit_calibration.yaml.

The origin base_link is the middle of the rear axle, projected to the ground. Units are metres and
radians. A camera's frame is called NAME/camera_link and has the axes of the ground frame. A LiDAR's
frame is called NAME_base_link; it is at the base of the housing where the catalogue knows that
height. A sensor name that ends in _link is used as the frame name unchanged. The module
`autoware_kit` updates an existing kit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.table_reader import Table
from pe_core.geometry.poses import Pose
from pe_tools.exchange.yaml_text import comments_of, parse_yaml_blocks

from .camera_info import info_files, with_info
from .foreign_values import Written, named_numbers, plain_number, pose_from, text_of
from .frame_tree import with_legal_frames
from .frames import composed, seen_from
from .portable import PortableSensor, merged_lines
from .portable_kinds import CAMERA, LIDAR, RADAR

BASE, KIT = "base_link", "sensor_kit_base_link"
TO_KIT, IN_KIT = "sensors_calibration.yaml", "sensor_kit_calibration.yaml"
LENS_FRAME, FOOT_FRAME, OWN_FRAME = "/camera_link", "_base_link", "_link"
RADAR_FRAME = "/radar_link"
FRAMES = {CAMERA: LENS_FRAME, LIDAR: FOOT_FRAME, RADAR: RADAR_FRAME}
POSITION_KEYS, ROTATION_KEYS = ("x", "y", "z"), ("roll", "pitch", "yaw")
KitUnit = tuple[str, dict[str, Pose]]
"""File name of a unit, and the poses of its frames by frame name."""
HEAD = "# Metres and radians; R = Rz(yaw) Ry(pitch) Rx(roll); x forward, y left, z up.\n"


def write(sensors: tuple[PortableSensor, ...]) -> tuple[Written, list[str]]:
    """Return the two files of a new kit and a camera_info file per camera, with messages."""
    named, lines = with_legal_frames(sensors, slashes=True, frames=frames_of, taken=(BASE, KIT))
    kit = _kit(named)
    frames = {frame_of(s): (seen_from(kit, base_frame(s)), s.known_model or "") for s in named}
    files = {TO_KIT: _yaml(BASE, {KIT: (kit, "")}), IN_KIT: _yaml(KIT, frames)}
    return {**files, **info_files(named)}, [*lines, *base_lines(named)]


def _kit(sensors: Sequence[PortableSensor]) -> Pose:
    """Return the pose of the kit: the mean sensor position, rounded to centimetres, not rotated."""
    middle = [sum(s.pose.position[k] for s in sensors) / len(sensors) for k in range(3)]
    x, y, z = (round(v, 2) for v in middle)
    return Pose((x, y, z))


def frame_of(sensor: PortableSensor) -> str:
    """Return the name of a sensor's frame."""
    if sensor.name.endswith(OWN_FRAME):
        return sensor.name
    return sensor.name + FRAMES.get(sensor.kind or "", "")


def frames_of(sensor: PortableSensor) -> tuple[str, ...]:
    """Return all frame names of a sensor; in Autoware a sensor has exactly one frame."""
    return (frame_of(sensor),)


def base_frame(sensor: PortableSensor) -> Pose:
    """Return the pose of a sensor's frame; a LiDAR's frame is at the base of its housing."""
    height = _height(sensor)
    return composed(sensor.pose, Pose((0.0, 0.0, -height))) if height else sensor.pose


def _height(sensor: PortableSensor) -> float:
    """Return the height of a sensor's origin above its frame [m]."""
    return catalog.scan_above_base(sensor.model) if sensor.kind == LIDAR else 0.0


def base_lines(sensors: Sequence[PortableSensor]) -> list[str]:
    """Return messages that say, for each LiDAR, where its frame is relative to the scan centre."""
    return merged_lines(
        (sensor.name, _base_text(sensor)) for sensor in sensors if sensor.kind == LIDAR
    )


def _base_text(sensor: PortableSensor) -> str:
    if height := _height(sensor):
        return (
            f"its frame is {1000.0 * height:.1f} mm below the centre of its scan ({sensor.model})"
        )
    return (
        f"its frame is written at the centre of its scan; Autoware's description of {sensor.model} "
        "may want the base of the housing"
    )


def _yaml(parent: str, frames: Mapping[str, tuple[Pose, str]]) -> bytes:
    lines = [f"{parent}:"]
    for name, (pose, model) in frames.items():
        lines += [f"  {line}" for line in frame_lines(name, pose, model)]
    return (HEAD + "\n".join(lines) + "\n").encode()


def frame_lines(name: str, pose: Pose, model: str) -> list[str]:
    """Return the YAML lines of a frame; the model name becomes a comment."""
    return [
        f"{name}:" + (f"  # {model}" if model else ""),
        *(f"  {key}: {value}" for key, value in pose_texts(pose).items()),
    ]


def pose_texts(pose: Pose) -> dict[str, str]:
    """Return the coordinates and angles of a pose as text, by YAML key."""
    numbers = zip((*POSITION_KEYS, *ROTATION_KEYS), (*pose.position, *pose.rpy), strict=True)
    return {key: plain_number(value) for key, value in numbers}


def read(path: Path) -> tuple[PortableSensor, ...]:
    """Read the sensors of a kit.

    LiDAR poses are those of the frames in the files. `lifted` moves a pose from the base of the
    housing to the scan centre, once the model is known.

    Parameters
    ----------
    path : Path
        Folder of the kit, or one of its files.

    Raises
    ------
    InputError
        When a file is missing or wrong.
    """
    folder = path if path.is_dir() else path.parent
    texts = kit_texts(folder)
    base, units = units_of(folder, texts)
    inside = {
        name: composed(base[parent], pose)
        for parent, (_, frames) in units.items()
        for name, pose in frames.items()
    }
    rest = {name: pose for name, pose in base.items() if name not in units}
    models = models_of(texts.values())
    sensors = [_sensor(frame, pose, models) for frame, pose in {**inside, **rest}.items()]
    return with_info(folder, sensors)


def models_of(texts: Iterable[str]) -> dict[str, str]:
    """Return catalogue model names by frame, read from the comments that `write` adds to frames."""
    catalogued = catalog.entries()
    return {
        path[-1]: comment
        for text in texts
        for path, comment in comments_of(text).items()
        if comment in catalogued
    }


def kit_texts(folder: Path) -> dict[str, str]:
    """Return the calibration texts of a kit by file name; the file of base_link comes first."""
    file_names = sorted(path.name for path in folder.glob("*_calibration.yaml"))
    units = [name for name in file_names if name not in (TO_KIT, IN_KIT)]
    kit = [IN_KIT] if IN_KIT in file_names or not units else []
    return {name: text_of(folder / name) for name in (TO_KIT, *kit, *units)}


def units_of(folder: Path, texts: Mapping[str, str]) -> tuple[dict[str, Pose], dict[str, KitUnit]]:
    """Return the poses of the frames on base_link, and the units by the name of their root frame.

    A unit is the sensor kit itself or one of several groups, each in a file UNIT_calibration.yaml.
    The kit aip_x2 of TIER IV, for example, has the units top_unit and front_unit.
    """
    base = dict(_frames(folder / TO_KIT, texts[TO_KIT], BASE))
    units = {}
    for name, text in texts.items():
        if name == TO_KIT:
            continue
        parent = _parent(folder / name, text)
        if parent not in base:
            raise InputError(folder / TO_KIT, BASE, parent, ", ".join(base))
        units[parent] = name, dict(_frames(folder / name, text, parent))
    return base, units


def _parent(path: Path, text: str) -> str:
    """Return the parent of all frames in a unit's file; there must be exactly one."""
    parents = list(parse_yaml_blocks(str(path), text))
    if len(parents) != 1:
        raise InputError(path, "file", "one frame, and others on it", ", ".join(parents) or "none")
    return parents[0]


def _frames(path: Path, text: str, parent: str) -> Iterator[tuple[str, Pose]]:
    """Yield the name of each frame below a parent, and its pose in the parent's frame."""
    data: Any = parse_yaml_blocks(str(path), text)
    top = Table(data, str(path))
    if parent not in top:
        raise InputError(path, parent, "a mapping of frames", "nothing")
    frames = top.raw(parent)
    table = Table(frames, str(path), parent)
    for name in frames:
        row = table.table(name)
        position, angles = (named_numbers(row, keys) for keys in (POSITION_KEYS, ROTATION_KEYS))
        yield name, pose_from(path, row.path, position, angles)


def _sensor(frame: str, pose: Pose, models: Mapping[str, str]) -> PortableSensor:
    model = models.get(frame)
    if frame.endswith(LENS_FRAME):
        return PortableSensor(frame.removesuffix(LENS_FRAME), pose, CAMERA, model)
    if frame.endswith(RADAR_FRAME):
        return PortableSensor(frame.removesuffix(RADAR_FRAME), pose, RADAR, model)
    name = frame.removesuffix(FOOT_FRAME)
    return PortableSensor(name, pose, LIDAR if name != frame else None, model)


def lifted(sensor: PortableSensor) -> PortableSensor:
    """Return a sensor whose pose is moved from its frame to the scan centre.

    Only a LiDAR with a known model is moved; other sensors are returned unchanged.
    """
    if not (height := _height(sensor)):
        return sensor
    note = f"{1000.0 * height:.1f} mm from its frame up to the centre of its scan ({sensor.model})"
    return replace(sensor, pose=composed(sensor.pose, Pose((0.0, 0.0, height))), told=note)

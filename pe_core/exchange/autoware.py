"""Autoware's sensor kit: sensors_calibration.yaml and sensor_kit_calibration.yaml.

base_link is the rear axle on the ground; metres, radians. A camera's frame is NAME/camera_link,
with our axes; a LiDAR's is NAME_base_link, at the foot of its housing where that is known; a name
that ends in _link is the frame's own. Written over a kit that is there, its structure stays: where
the kit is, whose frames are in it and whose on base_link, their order, and what is no sensor.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..scene.geometry import Pose
from ..text.tables import Table
from ..text.yaml_blocks import parse_yaml_blocks
from .camera_info import info_files, with_info
from .carried import CAMERA, LIDAR, CarriedSensor
from .files import Written, named_numbers, plain_number, pose_from, text_of
from .frame_names import with_legal_frames
from .frames import composed, pose_of, product, turned

BASE, KIT = "base_link", "sensor_kit_base_link"
TO_KIT, IN_KIT = "sensors_calibration.yaml", "sensor_kit_calibration.yaml"
LENS_FRAME, FOOT_FRAME, OWN_FRAME = "/camera_link", "_base_link", "_link"
PLACE, TURN = ("x", "y", "z"), ("roll", "pitch", "yaw")
FEET_M = {"VLP-16": 0.0377, "Pandar40P": 0.047}
"""From the foot of a housing up to the centre of the scan, as tier4's sensor_component_description
(03ba094) mounts these models; other models' frames are written at the centre of the scan."""
Unit = tuple[str, dict[str, Pose]]
"""A file, and the frames in it."""
HEAD = "# Metres and radians; R = Rz(yaw) Ry(pitch) Rx(roll); x forward, y left, z up.\n"


def foot_of(model: str | None) -> float:
    """Return how far below the centre of its scan Autoware has a LiDAR's frame [m]."""
    words = (model or "").split()
    return next((FEET_M[word] for word in words if word in FEET_M), 0.0)


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return the kit's two files, and its cameras' lenses."""
    return _written(sensors, {KIT: _kit(sensors)}, {KIT: (IN_KIT, {})})


def write_over(folder: Path, sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return the files of a kit that is there, with the sensors of ours where they are now."""
    return _written(sensors, *_read_files(folder))


def _written(
    sensors: tuple[CarriedSensor, ...], base: Mapping[str, Pose], units: Mapping[str, Unit]
) -> tuple[Written, list[str]]:
    """Return the files, from frames on base_link and in units; others go into the first unit."""
    named, lines = with_legal_frames(sensors, slashes=True)
    own = {_frame(each): each for each in named}
    there = {*base, *(frame for _, frames in units.values() for frame in frames)}
    files = {TO_KIT: _yaml(BASE, _placed(base, own, None))}
    for number, (parent, (file, frames)) in enumerate(units.items()):
        new = [] if number else [frame for frame in own if frame not in there]
        placed = _placed(frames, own, base[parent], new)
        files[file] = _yaml(parent, placed)
    kept = [frame for frame in there if frame not in own and frame not in units]
    files |= info_files(named)
    lines += [f"{frame}: kept as it stood in the kit" for frame in sorted(kept)]
    lines += [
        f"{s.name}: its frame is written at the centre of its scan; Autoware's description of "
        f"{s.model} may want the foot of the housing"
        for s in named
        if s.kind == LIDAR and not foot_of(s.model)
    ]
    return files, lines


def _placed(
    frames: Mapping[str, Pose],
    own: Mapping[str, CarriedSensor],
    unit: Pose | None,
    new: Sequence[str] = (),
) -> dict[str, tuple[Pose, str]]:
    """Return frames of a file in their order, those of sensors where these are, and new ones."""
    return {
        frame: (_seen_from(unit, own[frame]), own[frame].model or "")
        if frame in own
        else (frames[frame], "")
        for frame in (*frames, *new)
    }


def _kit(sensors: Sequence[CarriedSensor]) -> Pose:
    """Return where the kit is: amid the sensors, level, to the centimetre."""
    middle = [sum(s.pose.position[k] for s in sensors) / len(sensors) for k in range(3)]
    x, y, z = (round(v, 2) for v in middle)
    return Pose((x, y, z))


def _seen_from(kit: Pose | None, each: CarriedSensor) -> Pose:
    """Return a sensor's frame in the kit, or on base_link."""
    frame = each.pose
    if each.kind == LIDAR and foot_of(each.model):
        frame = composed(frame, Pose((0.0, 0.0, -foot_of(each.model))))
    if kit is None:
        return frame
    apart = [a - b for a, b in zip(frame.position, kit.position, strict=True)]
    if kit.rpy == (0.0, 0.0, 0.0):
        x, y, z = apart
        return Pose((x, y, z), frame.rpy)
    back = kit.ground_from_sensor.T
    return pose_of(product(back, frame.ground_from_sensor), turned(back, apart))


def _frame(each: CarriedSensor) -> str:
    if each.name.endswith(OWN_FRAME):
        return each.name
    return each.name + {CAMERA: LENS_FRAME, LIDAR: FOOT_FRAME}.get(each.kind or "", "")


def _yaml(parent: str, frames: Mapping[str, tuple[Pose, str]]) -> bytes:
    lines = [f"{parent}:"]
    for name, (pose, model) in frames.items():
        lines.append(f"  {name}:" + (f"  # {model}" if model else ""))
        numbers = zip((*PLACE, *TURN), (*pose.position, *pose.rpy), strict=True)
        lines += [f"    {key}: {plain_number(value)}" for key, value in numbers]
    return (HEAD + "\n".join(lines) + "\n").encode()


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read a kit: a folder with all its files, or one of them.

    Frames come as they are: a LiDAR's foot is lifted to the centre of its scan when its model has
    been chosen.

    Raises
    ------
    InputError
        When a file is missing or wrong.
    """
    folder = path if path.is_dir() else path.parent
    base, units = _read_files(folder)
    inside = {
        name: composed(base[parent], pose)
        for parent, (_, frames) in units.items()
        for name, pose in frames.items()
    }
    rest = {name: pose for name, pose in base.items() if name not in units}
    found = [_sensor(name, pose) for name, pose in {**inside, **rest}.items()]
    return with_info(folder, found)


def _read_files(folder: Path) -> tuple[dict[str, Pose], dict[str, Unit]]:
    """Return the frames on base_link, and units by their frames: the kit, or several of them.

    A unit's file is UNIT_calibration.yaml, as tier4's aip_x2 has them: top_unit, front_unit, ...
    """
    base = dict(_frames(folder / TO_KIT, BASE))
    found = sorted(folder.glob("*_calibration.yaml"))
    files = [each for each in found if each.name not in (TO_KIT, IN_KIT)]
    units = {}
    for file in (folder / IN_KIT, *files):
        if file.name == IN_KIT and files and not file.exists():
            continue
        parent = _parent(file)
        if parent not in base:
            raise InputError(folder / TO_KIT, BASE, parent, ", ".join(base))
        units[parent] = file.name, dict(_frames(file, parent))
    return base, units


def _parent(path: Path) -> str:
    """Return the one frame that a unit's file hangs its frames on."""
    parents = list(parse_yaml_blocks(str(path), text_of(path)))
    if len(parents) != 1:
        raise InputError(path, "file", "one frame, and others on it", ", ".join(parents) or "none")
    return parents[0]


def _frames(path: Path, parent: str) -> Iterator[tuple[str, Pose]]:
    """Yield names and poses of the frames in a parent."""
    data: Any = parse_yaml_blocks(str(path), text_of(path))
    top = Table(data, str(path))
    if parent not in top:
        raise InputError(path, parent, "a mapping of frames", "nothing")
    frames = top.raw(parent)
    table = Table(frames, str(path), parent)
    for name in frames:
        row = table.table(name)
        place, turn = (named_numbers(row, keys) for keys in (PLACE, TURN))
        yield name, pose_from(path, row.path, place, turn)


def _sensor(frame: str, pose: Pose) -> CarriedSensor:
    if frame.endswith(LENS_FRAME):
        return CarriedSensor(frame.removesuffix(LENS_FRAME), pose, CAMERA)
    name = frame.removesuffix(FOOT_FRAME)
    return CarriedSensor(name, pose, LIDAR if name != frame else None)


def lifted(each: CarriedSensor) -> CarriedSensor:
    """Return a LiDAR at the centre of its scan, now that its model is known."""
    if each.kind != LIDAR or not foot_of(each.model):
        return each
    return each.moved(composed(each.pose, Pose((0.0, 0.0, foot_of(each.model)))))

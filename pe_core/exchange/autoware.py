"""Autoware's sensor kit: sensors_calibration.yaml and sensor_kit_calibration.yaml.

base_link is the rear axle on the ground; metres, radians. A camera's frame is NAME/camera_link,
with our axes; a LiDAR's is NAME_base_link, at the base of its housing where that is known; a name
that ends in _link is the frame's own. `autoware_kit` writes into a kit that is there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from .. import catalog
from ..errors import InputError
from ..scene.geometry import Pose
from ..text.tables import Table
from ..text.yaml_blocks import parse_yaml_blocks
from ..text.yaml_edit import comments_of
from .camera_info import info_files, with_info
from .carried import CAMERA, LIDAR, CarriedSensor, merged_lines
from .files import Written, named_numbers, plain_number, pose_from, text_of
from .frame_names import with_legal_frames
from .frames import composed, seen_from

BASE, KIT = "base_link", "sensor_kit_base_link"
TO_KIT, IN_KIT = "sensors_calibration.yaml", "sensor_kit_calibration.yaml"
LENS_FRAME, FOOT_FRAME, OWN_FRAME = "/camera_link", "_base_link", "_link"
PLACE, TURN = ("x", "y", "z"), ("roll", "pitch", "yaw")
KitUnit = tuple[str, dict[str, Pose]]
"""A file, and the frames in it."""
HEAD = "# Metres and radians; R = Rz(yaw) Ry(pitch) Rx(roll); x forward, y left, z up.\n"


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a new kit's two files, and its cameras' lenses."""
    named, lines = with_legal_frames(sensors, slashes=True, frames=frames_of, taken=(BASE, KIT))
    kit = _kit(named)
    frames = {frame_of(s): (seen_from(kit, base_frame(s)), s.known_model or "") for s in named}
    files = {TO_KIT: _yaml(BASE, {KIT: (kit, "")}), IN_KIT: _yaml(KIT, frames)}
    return {**files, **info_files(named)}, [*lines, *base_lines(named)]


def _kit(sensors: Sequence[CarriedSensor]) -> Pose:
    """Return where the kit is: amid the sensors, level, to the centimetre."""
    middle = [sum(s.pose.position[k] for s in sensors) / len(sensors) for k in range(3)]
    x, y, z = (round(v, 2) for v in middle)
    return Pose((x, y, z))


def frame_of(each: CarriedSensor) -> str:
    """Return the name of a sensor's frame."""
    if each.name.endswith(OWN_FRAME):
        return each.name
    return each.name + {CAMERA: LENS_FRAME, LIDAR: FOOT_FRAME}.get(each.kind or "", "")


def frames_of(each: CarriedSensor) -> tuple[str, ...]:
    """Return the names of all frames of a sensor: it has one."""
    return (frame_of(each),)


def base_frame(each: CarriedSensor) -> Pose:
    """Return where a sensor's frame is: a LiDAR's is at the base of its housing."""
    height = _height(each)
    return composed(each.pose, Pose((0.0, 0.0, -height))) if height else each.pose


def _height(each: CarriedSensor) -> float:
    """Return how far a sensor is above its frame [m]."""
    return catalog.scan_above_base(each.model) if each.kind == LIDAR else 0.0


def base_lines(sensors: Sequence[CarriedSensor]) -> list[str]:
    """Return lines on LiDARs whose frames are not at their scan, or should not be."""
    return merged_lines((each.name, _base_text(each)) for each in sensors if each.kind == LIDAR)


def _base_text(each: CarriedSensor) -> str:
    if height := _height(each):
        return f"its frame is {1000.0 * height:.1f} mm below the centre of its scan ({each.model})"
    return (
        f"its frame is written at the centre of its scan; Autoware's description of {each.model} "
        "may want the base of the housing"
    )


def _yaml(parent: str, frames: Mapping[str, tuple[Pose, str]]) -> bytes:
    lines = [f"{parent}:"]
    for name, (pose, model) in frames.items():
        lines += [f"  {line}" for line in frame_lines(name, pose, model)]
    return (HEAD + "\n".join(lines) + "\n").encode()


def frame_lines(name: str, pose: Pose, model: str) -> list[str]:
    """Return the lines of a frame."""
    return [
        f"{name}:" + (f"  # {model}" if model else ""),
        *(f"  {key}: {value}" for key, value in pose_texts(pose).items()),
    ]


def pose_texts(pose: Pose) -> dict[str, str]:
    """Return a pose's numbers by their keys."""
    numbers = zip((*PLACE, *TURN), (*pose.position, *pose.rpy), strict=True)
    return {key: plain_number(value) for key, value in numbers}


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
    texts = kit_texts(folder)
    base, units = units_of(folder, texts)
    inside = {
        name: composed(base[parent], pose)
        for parent, (_, frames) in units.items()
        for name, pose in frames.items()
    }
    rest = {name: pose for name, pose in base.items() if name not in units}
    models = models_of(texts.values())
    found = [_sensor(frame, pose, models) for frame, pose in {**inside, **rest}.items()]
    return with_info(folder, found)


def models_of(texts: Iterable[str]) -> dict[str, str]:
    """Return the catalogue's models that comments behind frames name, as `write` has them."""
    known = catalog.entries()
    return {
        path[-1]: comment
        for text in texts
        for path, comment in comments_of(text).items()
        if comment in known
    }


def kit_texts(folder: Path) -> dict[str, str]:
    """Return the texts of a kit's calibrations by file name: that of base_link is the first."""
    found = sorted(each.name for each in folder.glob("*_calibration.yaml"))
    units = [name for name in found if name not in (TO_KIT, IN_KIT)]
    kit = [IN_KIT] if IN_KIT in found or not units else []
    return {name: text_of(folder / name) for name in (TO_KIT, *kit, *units)}


def units_of(folder: Path, texts: Mapping[str, str]) -> tuple[dict[str, Pose], dict[str, KitUnit]]:
    """Return the frames on base_link, and units by their frames: the kit, or several of them.

    A unit's file is UNIT_calibration.yaml, as tier4's aip_x2 has them: top_unit, front_unit, ...
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
    """Return the one frame that a unit's file hangs its frames on."""
    parents = list(parse_yaml_blocks(str(path), text))
    if len(parents) != 1:
        raise InputError(path, "file", "one frame, and others on it", ", ".join(parents) or "none")
    return parents[0]


def _frames(path: Path, text: str, parent: str) -> Iterator[tuple[str, Pose]]:
    """Yield names and poses of the frames in a parent."""
    data: Any = parse_yaml_blocks(str(path), text)
    top = Table(data, str(path))
    if parent not in top:
        raise InputError(path, parent, "a mapping of frames", "nothing")
    frames = top.raw(parent)
    table = Table(frames, str(path), parent)
    for name in frames:
        row = table.table(name)
        place, turn = (named_numbers(row, keys) for keys in (PLACE, TURN))
        yield name, pose_from(path, row.path, place, turn)


def _sensor(frame: str, pose: Pose, models: Mapping[str, str]) -> CarriedSensor:
    model = models.get(frame)
    if frame.endswith(LENS_FRAME):
        return CarriedSensor(frame.removesuffix(LENS_FRAME), pose, CAMERA, model)
    name = frame.removesuffix(FOOT_FRAME)
    return CarriedSensor(name, pose, LIDAR if name != frame else None, model)


def lifted(each: CarriedSensor) -> CarriedSensor:
    """Return a LiDAR at the centre of its scan, now that its model is known."""
    if not (height := _height(each)):
        return each
    told = f"{1000.0 * height:.1f} mm from its frame up to the centre of its scan ({each.model})"
    return replace(each, pose=composed(each.pose, Pose((0.0, 0.0, height))), told=told)

"""Update of an existing Autoware sensor kit: the sensors of a rig are written into its files.

Frames that did not move keep their numbers. All files keep their comments, order and structure.
The pose of the kit, the parent of each frame, and frames that are no sensors do not change either.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from pe_core import catalog
from pe_core.base.table_reader import Table
from pe_core.geometry.poses import Pose
from pe_core.scene.vehicle_description import Reference
from pe_tools.exchange.yaml_text import (
    KeyPath,
    parse_yaml_blocks,
    with_added_lines,
    with_comments,
    with_values,
)

from .autoware import (
    BASE,
    POSITION_KEYS,
    ROTATION_KEYS,
    TO_KIT,
    KitUnit,
    base_frame,
    base_lines,
    frame_lines,
    frame_of,
    frames_of,
    kit_texts,
    models_of,
    pose_texts,
    units_of,
)
from .camera_info import info_files, info_name, picture_of_info
from .foreign_values import Written, named_numbers, text_of
from .frame_tree import with_legal_frames
from .frames import seen_from
from .lens_pictures import alike
from .passthrough import is_there, is_turned_so
from .portable import PortableSensor
from .portable_kinds import CAMERA

NO_INFO = "the kit has no camera_info of it; its lens is not written"


def source(path: Path) -> dict[str, str]:
    """Return the texts of a kit's calibration and camera_info files by file name."""
    folder = path if path.is_dir() else path.parent
    texts = kit_texts(folder)
    for frame in _all_frames(*units_of(folder, texts)):
        name = info_name(frame.removesuffix("/camera_link"))
        if (folder / name).is_file():
            texts[name] = text_of(folder / name)
    return texts


def _all_frames(base: Mapping[str, Pose], units: Mapping[str, KitUnit]) -> list[str]:
    return [*base, *(frame for _, frames in units.values() for frame in frames)]


def write_over(
    texts: Mapping[str, str], sensors: tuple[PortableSensor, ...]
) -> tuple[Written, list[str]]:
    """Return the files of an existing kit with updated sensor poses, and messages.

    Parameters
    ----------
    texts : mapping of str to str
        Texts of the existing files by file name, from `source`.
    sensors : tuple of PortableSensor
        Sensors in the frame base_link.

    Raises
    ------
    InputError
        When an existing file is malformed.
    """
    calibrations = {name: text for name, text in texts.items() if "/" not in name}
    base, units = units_of(Path(), calibrations)
    included = [sensor for sensor in sensors if not sensor.is_left_out]
    taken = (BASE, *units)
    named, lines = with_legal_frames(included, slashes=True, frames=frames_of, taken=taken)
    sensor_by_frame, kit_frames = (
        {frame_of(sensor): sensor for sensor in named},
        _all_frames(base, units),
    )
    added = [sensor for frame, sensor in sensor_by_frame.items() if frame not in kit_frames]
    files = {TO_KIT: _patched(texts[TO_KIT], BASE, base, sensor_by_frame, None)}
    for number, (parent, (file, frames)) in enumerate(units.items()):
        files[file] = _patched(texts[file], parent, frames, sensor_by_frame, base[parent])
        for sensor in () if number else added:
            frame = frame_lines(
                frame_of(sensor),
                seen_from(base[parent], base_frame(sensor)),
                sensor.known_model or "",
            )
            files[file] = with_added_lines(files[file], (parent,), frame)
    infos, lens_lines = _infos(texts, named, added)
    untouched = [
        frame for frame in kit_frames if frame not in sensor_by_frame and frame not in units
    ]
    lines += [f"kept as they stood in the kit: {', '.join(sorted(untouched))}"] if untouched else []
    written = {name: text.encode() for name, text in {**files, **infos}.items()}
    return written, [*lines, *lens_lines, *base_lines(named)]


def _patched(
    text: str,
    parent: str,
    frames: Mapping[str, Pose],
    sensor_by_frame: Mapping[str, PortableSensor],
    unit_pose: Pose | None,
) -> str:
    """Return the text of a file with the new poses of the frames that moved.

    `unit_pose` is the pose of the unit on base_link; None for frames directly on base_link.
    """
    values: dict[KeyPath, str] = {}
    for frame, old in frames.items():
        if frame in sensor_by_frame:
            now = base_frame(sensor_by_frame[frame])
            now = now if unit_pose is None else seen_from(unit_pose, now)
            texts = pose_texts(now)
            values |= {(parent, frame, key): texts[key] for key in _changed(old, now)}
    comments: dict[KeyPath, str] = {}
    for frame in models_of([text]):
        model = _catalogued(sensor_by_frame[frame]) if frame in sensor_by_frame else None
        if model is not None:
            comments[parent, frame] = model
    return with_comments(with_values(text, values), comments)


def _catalogued(sensor: PortableSensor) -> str | None:
    """Return the model name for the comment behind a frame.

    The text is empty for a model outside the catalogue. None means that the comment stays: a
    camera outside the catalogue is described by its camera_info file.
    """
    model = sensor.known_model or ""
    if model in catalog.entries():
        return model
    return None if sensor.kind == CAMERA else ""


def _changed(old: Pose, now: Pose) -> Iterator[str]:
    """Yield the keys to rewrite: changed coordinates, or all angles if the rotation changed."""
    for key, a, b in zip(POSITION_KEYS, old.position, now.position, strict=True):
        if not is_there(a, b):
            yield key
    if not is_turned_so(old, now):
        yield from ROTATION_KEYS


def _infos(
    texts: Mapping[str, str], named: Sequence[PortableSensor], added: Sequence[PortableSensor]
) -> tuple[dict[str, str], list[str]]:
    """Return the camera_info files, and messages on cameras that have none.

    A file is rewritten only when the lens has changed, and created only for an added camera.
    """
    files = {name: text for name, text in texts.items() if "/" in name}
    fresh = {name: data.decode() for name, data in info_files(named).items()}
    lines = []
    for sensor in named:
        name = info_name(sensor.name)
        if sensor.kind != CAMERA or sensor.picture is None:
            continue
        if name in files:
            if not alike(picture_of_info(name, files[name]), sensor.picture):
                files[name] = fresh[name]
        elif sensor in added:
            files[name] = fresh[name]
        else:
            lines.append(f"{sensor.name}: {NO_INFO}")
    return files, lines


NODES, PARAMETERS = "/**", "ros__parameters"
KEYS = ("wheel_radius", "wheel_base", "front_overhang", "rear_overhang")


def read_vehicle_info(path: str | Path) -> Reference:
    """Return the reference points of a vehicle from Autoware's vehicle_info file.

    The origin of the ground frame is below the middle of the vehicle's length.

    Raises
    ------
    InputError
        When the file cannot be read, or a number is missing or impossible.
    """
    path = Path(path)
    top = Table(parse_yaml_blocks(str(path), text_of(path)), str(path))
    nodes = top.table(NODES) if NODES in top else top
    radius, base, front, rear = named_numbers(nodes.table(PARAMETERS), KEYS)
    middle = (rear + base + front) / 2.0
    return Reference(rear - middle, radius, base, front, rear)

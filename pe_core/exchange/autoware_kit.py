"""A sensor kit of Autoware that is there, with a rig's sensors written into its files.

Frames that did not move keep their numbers, and all files their comments, order and structure:
where the kit is, whose frames are in it and whose on base_link, and what is no sensor.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from .. import catalog
from ..scene.geometry import Pose
from ..text.yaml_edit import KeyPath, with_comments, with_more_lines, with_values
from .autoware import (
    BASE,
    PLACE,
    TO_KIT,
    TURN,
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
from .carried import CAMERA, CarriedSensor
from .files import Written, text_of
from .frame_names import with_legal_frames
from .frames import seen_from
from .passthrough import is_there, is_turned_so
from .pictures import alike

NO_INFO = "the kit has no camera_info of it; its lens is not written"


def source(path: Path) -> dict[str, str]:
    """Return the texts of a kit's calibrations, and of its cameras' lenses."""
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
    texts: Mapping[str, str], sensors: tuple[CarriedSensor, ...]
) -> tuple[Written, list[str]]:
    """Return the files of a kit that is there, with the sensors of ours where they are now."""
    calibrations = {name: text for name, text in texts.items() if "/" not in name}
    base, units = units_of(Path(), calibrations)
    ours = [each for each in sensors if not each.is_left_out]
    taken = (BASE, *units)
    named, lines = with_legal_frames(ours, slashes=True, frames=frames_of, taken=taken)
    own, there = {frame_of(each): each for each in named}, _all_frames(base, units)
    new = [each for frame, each in own.items() if frame not in there]
    files = {TO_KIT: _patched(texts[TO_KIT], BASE, base, own, None)}
    for number, (parent, (file, frames)) in enumerate(units.items()):
        files[file] = _patched(texts[file], parent, frames, own, base[parent])
        for each in () if number else new:
            frame = frame_lines(
                frame_of(each), seen_from(base[parent], base_frame(each)), each.known_model or ""
            )
            files[file] = with_more_lines(files[file], (parent,), frame)
    infos, untold = _infos(texts, named, new)
    kept = [frame for frame in there if frame not in own and frame not in units]
    lines += [f"kept as they stood in the kit: {', '.join(sorted(kept))}"] if kept else []
    written = {name: text.encode() for name, text in {**files, **infos}.items()}
    return written, [*lines, *untold, *base_lines(named)]


def _patched(
    text: str,
    parent: str,
    frames: Mapping[str, Pose],
    own: Mapping[str, CarriedSensor],
    unit: Pose | None,
) -> str:
    """Return a file's text, with the frames of those that moved where these are now."""
    values: dict[KeyPath, str] = {}
    for frame, old in frames.items():
        if frame in own:
            now = base_frame(own[frame])
            now = now if unit is None else seen_from(unit, now)
            texts = pose_texts(now)
            values |= {(parent, frame, key): texts[key] for key in _changed(old, now)}
    comments: dict[KeyPath, str] = {}
    for frame in models_of([text]):
        model = _catalogued(own[frame]) if frame in own else None
        if model is not None:
            comments[parent, frame] = model
    return with_comments(with_values(text, values), comments)


def _catalogued(each: CarriedSensor) -> str | None:
    """Return what a comment says of a sensor's model; None of a lens, which a file says."""
    model = each.known_model or ""
    if model in catalog.entries():
        return model
    return None if each.kind == CAMERA else ""


def _changed(old: Pose, now: Pose) -> Iterator[str]:
    """Yield the keys of what is no longer so: numbers of a place, all three of a turn."""
    for key, a, b in zip(PLACE, old.position, now.position, strict=True):
        if not is_there(a, b):
            yield key
    if not is_turned_so(old, now):
        yield from TURN


def _infos(
    texts: Mapping[str, str], named: Sequence[CarriedSensor], new: Sequence[CarriedSensor]
) -> tuple[dict[str, str], list[str]]:
    """Return the files of lenses, as they were unless the lens is another, and lines on others."""
    files = {name: text for name, text in texts.items() if "/" in name}
    fresh = {name: data.decode() for name, data in info_files(named).items()}
    lines = []
    for each in named:
        name = info_name(each.name)
        if each.kind != CAMERA or each.picture is None:
            continue
        if name in files:
            if not alike(picture_of_info(name, files[name]), each.picture):
                files[name] = fresh[name]
        elif each in new:
            files[name] = fresh[name]
        else:
            lines.append(f"{each.name}: {NO_INFO}")
    return files, lines

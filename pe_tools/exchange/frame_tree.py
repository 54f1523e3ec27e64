"""Trees of frames: poses relative to the root, and legal, unique frame names."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.file_stem import is_reserved
from pe_core.geometry.poses import Pose

from .foreign_values import MAX_FRAMES, require_at_most
from .frames import composed
from .portable import PortableSensor
from .portable_kinds import CAMERA

ORIGIN = Pose((0.0, 0.0, 0.0))
Hung = Mapping[str, tuple[str, Pose]]
"""Parent frame and pose in the parent frame, by frame name."""


def poses_from_root(path: Path, hung: Hung, frames: Collection[str], noun: str) -> dict[str, Pose]:
    """Return the poses of all `frames` in the root frame, by name, ordered by depth.

    Frames of equal depth are in the order of `hung`. Each pose is computed once, from that of its
    parent, so the time is linear in the number of frames. `noun` is the word for a frame in this
    format. More than `MAX_FRAMES`, not exactly one root or a cycle raise `InputError`.
    """
    require_at_most(path, noun, len(frames), MAX_FRAMES, f"{noun}s")
    roots = [name for name in frames if name not in hung]
    if len(roots) != 1:
        found = "none: they go in a circle" if not roots else ", ".join(roots)
        raise InputError(path, noun, "one root", found)
    order = {name: number for number, name in enumerate(hung)}
    children: dict[str, list[str]] = {}
    for name, (parent, _) in hung.items():
        children.setdefault(parent, []).append(name)
    poses, level = {roots[0]: ORIGIN}, roots
    while level := [child for name in level for child in children.get(name, ())]:
        level.sort(key=order.__getitem__)
        for name in level:
            parent, pose = hung[name]
            poses[name] = composed(poses[parent], pose)
    if len(poses) < len(frames):
        field = f"{noun} {next(name for name in hung if name not in poses)}"
        raise InputError(path, field, "a chain of parents that ends at the root", "a circle")
    return poses


OPTICAL = "_optical"
"""Suffix of the name of a camera's optical frame."""
ILLEGAL, ILLEGAL_IN_TF = (re.compile(f"[^A-Za-z0-9_{more}]+") for more in ("", "/"))


def legal_frame(name: str, *, slashes: bool = False) -> str:
    """Return a frame name of letters, digits and underscores that begins with a letter.

    With `slashes`, the name may also contain ``/``, as frame names of tf2 may. Files are named
    after frames: no part of the name is one that Windows keeps for a device.
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    legal = (ILLEGAL_IN_TF if slashes else ILLEGAL).sub("_", plain).strip("_/")
    legal = "/".join(f"sensor_{p}" if is_reserved(p) else p for p in legal.split("/"))
    return legal if legal[:1].isalpha() else f"sensor_{legal}".rstrip("_")


def with_legal_frames(
    sensors: Sequence[PortableSensor],
    *,
    slashes: bool = False,
    frames: Callable[[PortableSensor], Collection[str]] = lambda sensor: (sensor.name,),
    taken: Collection[str] = (),
    not_ending: str = "",
) -> tuple[tuple[PortableSensor, ...], list[str]]:
    """Return sensors with legal names and unique frames, and a message for each renamed sensor.

    `frames` returns the names of all frames of a sensor, `taken` are names in use. No name may have
    the suffix `not_ending`, which marks another sort of frame. For `slashes` see `legal_frame`.
    """
    used, renamed, lines = set(taken), [], []
    for sensor in sensors:
        legal = legal_frame(sensor.name, slashes=slashes)
        if not_ending and legal.endswith(not_ending):
            legal += "_sensor"
        named, number = replace(sensor, name=legal), 2
        while used & set(frames(named)):
            named, number = replace(sensor, name=f"{legal}_{number}"), number + 1
        used |= set(frames(named))
        renamed.append(named)
        if named.name != sensor.name:
            lines.append(f"{sensor.name}: called {named.name}, which is a legal frame of its own")
    return tuple(renamed), lines


def with_optical_frames(
    sensors: Sequence[PortableSensor], taken: Collection[str]
) -> tuple[tuple[PortableSensor, ...], list[str]]:
    """Return sensors with legal names; each camera also has an optical frame (REP 103)."""

    def own_and_optical(sensor: PortableSensor) -> tuple[str, ...]:
        return (sensor.name, sensor.name + OPTICAL) if sensor.kind == CAMERA else (sensor.name,)

    return with_legal_frames(sensors, frames=own_and_optical, taken=taken, not_ending=OPTICAL)

"""Frames that hang on one another, as joints of robots and transforms of ROS do, to their root."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from ..errors import InputError
from ..scene.geometry import Pose
from .frames import composed
from .limits import MAX_FRAMES, require_at_most

ORIGIN = Pose((0.0, 0.0, 0.0))
Hung = Mapping[str, tuple[str, Pose]]
"""Frames by name: the frame each hangs on, and its pose in that one."""


def poses_from_root(path: Path, hung: Hung, frames: Collection[str], noun: str) -> dict[str, Pose]:
    """Return the poses of all frames in their root, by name, from the root outward.

    Frames of one depth come in the order of `hung`. The time is that of one pass: a frame's pose
    is that of its parent and one product more.

    Parameters
    ----------
    path : Path
        The file, for messages.
    hung : mapping
    frames : collection of str
        All frames, those that hang on none too.
    noun : str
        What the file calls a frame.

    Raises
    ------
    InputError
        When there are more than `MAX_FRAMES`, no root or two, or frames go in a circle.
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
        lost = next(name for name in hung if name not in poses)
        raise InputError(path, f"{noun} {lost}", "a way to the root", "a circle")
    return poses

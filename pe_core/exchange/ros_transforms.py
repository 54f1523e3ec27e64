"""ROS 2 static transforms: a launch file of tf2's static_transform_publisher.

Lenses stand beside it, in camera_info.
Read back from there, and from lines of a shell that call the publisher.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..errors import InputError, shown
from ..scene.geometry import Pose
from ..text.xml_text import parse_xml
from .camera_info import info_files, with_info
from .carried import CAMERA, CarriedSensor
from .figures import figure
from .files import Written, plain_number, pose_from, text_of
from .frame_names import OPTICAL, with_optical_frames
from .frame_tree import poses_from_root
from .frames import OPTICAL_RPY, from_quaternion, pose_of
from .limits import LONGEST_LINE, MAX_FRAMES, require_at_most
from .passthrough import pose_of_entry

FILE, ROOT = "rig.launch.xml", "base_link"
AXES = (
    "x forward, y left, z up; metres, radians. NAME_optical looks along z, x right, y down (REP "
    "103). "
)
OURS, THEIRS = " is on the ground under the vehicle's centre: ", " is that of the imported file: "
PUBLISHER = "static_transform_publisher"
PLACE, TURN, QUATERNION = ("x", "y", "z"), ("roll", "pitch", "yaw"), ("qw", "qx", "qy", "qz")
ENDS = ("frame-id", "child-frame-id")
EQUALS = re.compile(r"(--[a-z-]+)=")
"""Between an option and its value, in place of a blank."""
ARGS = re.compile(rf"{PUBLISHER}[\"']?(?:\s+args=[\"'])?([^<\"'\n]*)")


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a launch file with a publisher for each sensor."""
    return _written(sensors, ROOT, OURS)


def write_over(
    texts: Mapping[str, str], sensors: tuple[CarriedSensor, ...]
) -> tuple[Written, list[str]]:
    """Return such a file on the root of the one that came in."""
    launch = parse_xml("passthrough", texts.get(FILE, "").encode())
    return _written(sensors, launch.get("root", ROOT), THEIRS)


def source(path: Path) -> dict[str, str]:
    """Return an empty launch file that names the root of this one."""
    links = _links(path / FILE if path.is_dir() else path)
    root = next(parent for parent, _ in links.values() if parent not in links)
    return {FILE: tostring(Element("launch", {"root": root}), "unicode")}


def _written(
    sensors: tuple[CarriedSensor, ...], root: str, where: str
) -> tuple[Written, list[str]]:
    kept = [each for each in sensors if each.is_left_out]
    ours = [each for each in sensors if not each.is_left_out]
    named, lines = with_optical_frames(ours, (root, *(each.name for each in kept)))
    launch = Element("launch")
    for each in named:
        _publisher(launch, root, each.name, each.pose)
        if each.kind == CAMERA:
            optical = Pose((0.0, 0.0, 0.0), OPTICAL_RPY)
            _publisher(launch, each.name, each.name + OPTICAL, optical)
    for each in kept:
        _publisher(launch, root, each.name, pose_of_entry(each))
    indent(launch)
    text = f"<!-- {root}{where}{AXES}-->\n{tostring(launch, 'unicode')}\n"
    return {FILE: text.encode(), **info_files(named)}, lines


def _publisher(launch: Element, parent: str, child: str, pose: Pose) -> None:
    named = zip((*PLACE, *TURN), (*pose.position, *pose.rpy), strict=True)
    numbers = " ".join(f"--{key} {plain_number(value)}" for key, value in named)
    args = f"{numbers} --{ENDS[0]} {parent} --{ENDS[1]} {child}"
    SubElement(launch, "node", {"pkg": "tf2_ros", "exec": PUBLISHER, "args": args})


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the transforms of all calls of the publisher in a file, in the frame of their root.

    A frame with an optical one below it is a camera; of others the file says no kind.

    Raises
    ------
    InputError
        When there is no call, a number is none, or frames have two roots or a circle.
    """
    path = path / FILE if path.is_dir() else path
    links = _links(path)
    frames = dict.fromkeys(name for child, (parent, _) in links.items() for name in (parent, child))
    poses = poses_from_root(path, links, frames, "frame")
    optical = {name for name in links if name.endswith(OPTICAL)}
    cameras = {links[name][0] for name in optical}
    named = [name for name in links if name not in optical]
    found = [CarriedSensor(n, poses[n], CAMERA if n in cameras else None) for n in named]
    return with_info(path.parent, found)


def _links(path: Path) -> dict[str, tuple[str, Pose]]:
    """Return frames by name: the one that each hangs on, and its pose there."""
    calls = ARGS.findall(without_comments(text_of(path)))
    require_at_most(path, "file", len(calls), MAX_FRAMES, f"calls of {PUBLISHER}")
    links: dict[str, tuple[str, Pose]] = {}
    for number, found in enumerate(calls):
        require_at_most(path, f"transform {number + 1}", len(found), LONGEST_LINE, "characters")
        parent, child, pose = _transform(path, f"transform {number + 1}", found)
        if child in links:
            raise InputError(path, f"frame {child}", "one parent", "two")
        links[child] = parent, pose
    if not links:
        raise InputError(path, "file", f"calls of {PUBLISHER}", "none")
    return links


def _transform(path: Path, field: str, args: str) -> tuple[str, str, Pose]:
    """Return parent, child and pose of one call."""
    try:
        words = shlex.split(EQUALS.sub(r"\1 ", args))
    except ValueError as error:
        raise InputError(path, field, "arguments", error) from None
    given = dict(zip(words[::2], words[1::2], strict=False))
    ends = [given.get(f"--{end}", "") for end in ENDS]
    if not all(ends):
        raise InputError(path, field, "--frame-id and --child-frame-id", shown(args.strip()))
    place = [_number(path, field, given, key) for key in PLACE]
    if any(f"--{key}" in given for key in QUATERNION):
        default = {"qw": "1"}
        turn = [_number(path, field, default | _bare(given), key, "") for key in QUATERNION]
        pose = pose_of(from_quaternion(path, field, turn), place)
    else:
        pose = pose_from(path, field, place, [_number(path, field, given, key) for key in TURN])
    return ends[0], ends[1], pose


def _bare(given: dict[str, str]) -> dict[str, str]:
    return {key.removeprefix("--"): value for key, value in given.items()}


def _number(path: Path, field: str, given: dict[str, str], key: str, dashes: str = "--") -> float:
    return figure(path, f"{field}, {key}", given.get(f"{dashes}{key}", "0"))


def without_comments(text: str) -> str:
    """Return XML without its comments, in one pass; one that never ends takes all the rest."""
    kept, begin = [], 0
    while (start := text.find("<!--", begin)) >= 0:
        kept.append(text[begin:start])
        end = text.find("-->", start + 4)
        if end < 0:
            return "".join(kept)
        begin = end + 3
    return "".join([*kept, text[begin:]])

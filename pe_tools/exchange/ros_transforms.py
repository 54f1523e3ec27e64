"""ROS 2 static transforms: a launch file of tf2's static_transform_publisher.

Camera intrinsics are beside it, in the folder camera_info. Import also reads shell scripts that
call the publisher.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from pe_core.base.errors import InputError, shown
from pe_core.geometry.poses import Pose
from pe_tools.formats.xml_text import parse_xml

from .camera_info import info_files, with_info
from .foreign_values import (
    MAX_FRAMES,
    MAX_LINE_LENGTH,
    Export,
    FileTexts,
    figure,
    plain_number,
    pose_from,
    require_at_most,
    text_of,
)
from .frames import (
    OPTICAL,
    OPTICAL_RPY,
    from_quaternion,
    pose_of,
    poses_from_root,
    with_optical_frames,
)
from .passthrough import pose_of_entry
from .portable import PortableRig, PortableSensor
from .portable_kinds import CAMERA

FILE, ROOT = "rig.launch.xml", "base_link"
FILES = (FILE,)
AXES = (
    "x forward, y left, z up; metres, radians. NAME_optical looks along z, x right, y down (REP "
    "103). "
)
OURS, THEIRS = " is on the ground under the vehicle's centre: ", " is that of the imported file: "
PUBLISHER = "static_transform_publisher"
POSITION_KEYS, ROTATION_KEYS = ("x", "y", "z"), ("roll", "pitch", "yaw")
QUATERNION = ("qw", "qx", "qy", "qz")
ENDS = ("frame-id", "child-frame-id")
EQUALS = re.compile(r"(--[a-z-]+)=")
"""Between an option and its value, in place of a blank."""
ARGS = re.compile(rf"{PUBLISHER}[\"']?(?:\s+args=[\"'])?([^<\"'\n]*)")


def write(sensors: PortableRig, texts: FileTexts) -> Export:
    """Return a launch file with a publisher for each sensor, with the root of an imported one."""
    root, origin_text = ROOT, OURS
    if texts:
        launch = parse_xml("passthrough", texts.get(FILE, "").encode())
        root, origin_text = launch.get("root", ROOT), THEIRS
    left_out = [sensor for sensor in sensors if sensor.is_left_out]
    included = [sensor for sensor in sensors if not sensor.is_left_out]
    named, lines = with_optical_frames(included, (root, *(sensor.name for sensor in left_out)))
    launch = Element("launch")
    for sensor in named:
        _publisher(launch, root, sensor.name, sensor.pose)
        if sensor.kind == CAMERA:
            optical = Pose((0.0, 0.0, 0.0), OPTICAL_RPY)
            _publisher(launch, sensor.name, sensor.name + OPTICAL, optical)
    for sensor in left_out:
        _publisher(launch, root, sensor.name, pose_of_entry(sensor))
    indent(launch)
    files = {FILE: f"<!-- {root}{origin_text}{AXES}-->\n{tostring(launch, 'unicode')}\n"}
    files |= info_files(named)
    return {name: text.encode() for name, text in files.items()}, lines


def source(path: Path) -> dict[str, str]:
    """Return an empty launch file that stores the root frame of this file, for `write_over`."""
    links = _links(path / FILE if path.is_dir() else path)
    root = next(parent for parent, _ in links.values() if parent not in links)
    return {FILE: tostring(Element("launch", {"root": root}), "unicode")}


def _publisher(launch: Element, parent: str, child: str, pose: Pose) -> None:
    named = zip((*POSITION_KEYS, *ROTATION_KEYS), (*pose.position, *pose.rpy), strict=True)
    numbers = " ".join(f"--{key} {plain_number(value)}" for key, value in named)
    args = f"{numbers} --{ENDS[0]} {parent} --{ENDS[1]} {child}"
    SubElement(launch, "node", {"pkg": "tf2_ros", "exec": PUBLISHER, "args": args})


def read(path: Path) -> PortableRig:
    """Read the transforms of all calls of the publisher in a file, in the frame of their root.

    A frame with an optical frame below it is a camera; the kind of others is unknown.
    """
    path = path / FILE if path.is_dir() else path
    links = _links(path)
    frames = dict.fromkeys(name for child, (parent, _) in links.items() for name in (parent, child))
    poses = poses_from_root(path, links, frames, "frame")
    optical = {name for name in links if name.endswith(OPTICAL)}
    cameras = {links[name][0] for name in optical}
    names = [name for name in links if name not in optical]
    sensors = [PortableSensor(n, poses[n], CAMERA if n in cameras else None) for n in names]
    return with_info(path.parent, sensors)


def _links(path: Path) -> dict[str, tuple[str, Pose]]:
    """Return the parent and the pose in the parent frame, by frame name."""
    calls = ARGS.findall(without_comments(text_of(path)))
    require_at_most(path, "file", len(calls), MAX_FRAMES, f"calls of {PUBLISHER}")
    links: dict[str, tuple[str, Pose]] = {}
    for number, arguments in enumerate(calls):
        field = f"transform {number + 1}"
        require_at_most(path, field, len(arguments), MAX_LINE_LENGTH, "characters")
        parent, child, pose = _transform(path, field, arguments)
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
    options = dict(zip(words[::2], words[1::2], strict=False))
    ends = [options.get(f"--{end}", "") for end in ENDS]
    if not all(ends):
        raise InputError(path, field, "--frame-id and --child-frame-id", shown(args.strip()))

    def values(keys: Sequence[str]) -> list[float]:
        defaults = {"qw": "1"}
        return [
            figure(path, f"{field}, {key}", options.get(f"--{key}", defaults.get(key, "0")))
            for key in keys
        ]

    position = values(POSITION_KEYS)
    if any(f"--{key}" in options for key in QUATERNION):
        pose = pose_of(from_quaternion(path, field, values(QUATERNION)), position)
    else:
        pose = pose_from(path, field, position, values(ROTATION_KEYS))
    return ends[0], ends[1], pose


def without_comments(text: str) -> str:
    """Return XML without its comments, in one pass; an unclosed comment extends to the end."""
    first, *parts = text.split("<!--")
    return first + "".join(part.partition("-->")[2] for part in parts)

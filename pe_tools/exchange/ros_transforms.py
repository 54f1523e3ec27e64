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

from . import foreign_values as values
from . import frames
from .camera_info import info_files, with_info
from .foreign_values import RPY, XYZ, Export, FileTexts
from .portable import PortableRig, PortableSensor
from .portable_kinds import CAMERA

FILE, ROOT = "rig.launch.xml", "base_link"
PUBLISHER = "static_transform_publisher"
QUATERNION = ("qw", "qx", "qy", "qz")
ENDS = ("frame-id", "child-frame-id")
EQUALS = re.compile(r"(--[a-z-]+)=")
"""Between an option and its value, in place of a blank."""
ARGS = re.compile(rf"{PUBLISHER}[\"']?(?:\s+args=[\"'])?([^<\"'\n]*)")


def write(sensors: PortableRig, texts: FileTexts) -> Export:
    """Return a launch file with a publisher for each sensor, with the root of an imported one."""
    root = ROOT
    if texts:
        root = parse_xml("passthrough", texts.get(FILE, "").encode()).get("root", ROOT)
    launch = Element("launch")
    linked, lines = frames.linked(sensors, root)
    for _, links in linked:
        for parent, child, pose in links:
            numbers = values.pose_numbers(pose).items()
            args = " ".join(f"--{key} {values.plain_number(value)}" for key, value in numbers)
            args += f" --{ENDS[0]} {parent} --{ENDS[1]} {child}"
            SubElement(launch, "node", {"pkg": "tf2_ros", "exec": PUBLISHER, "args": args})
    indent(launch)
    head = f"<!-- {root}{frames.origin_text(texts)}{frames.AXES}-->\n"
    files = {FILE: f"{head}{tostring(launch, 'unicode')}\n"}
    files |= info_files(sensor for sensor, _ in linked if not sensor.is_left_out)
    return {name: text.encode() for name, text in files.items()}, lines


def source(path: Path) -> dict[str, str]:
    """Return an empty launch file that stores the root frame of this file, for `write`."""
    links = _links(path / FILE if path.is_dir() else path)
    root = next(parent for parent, _ in links.values() if parent not in links)
    return {FILE: tostring(Element("launch", {"root": root}), "unicode")}


def read(path: Path) -> PortableRig:
    """Read the transforms of all calls of the publisher in a file, in the frame of their root.

    A frame with an optical frame below it is a camera; the kind of others is unknown.
    """
    path = path / FILE if path.is_dir() else path
    links = _links(path)
    names = dict.fromkeys(name for child, (parent, _) in links.items() for name in (parent, child))
    poses = frames.poses_from_root(path, links, names, "frame")
    optical = {name for name in links if name.endswith(frames.OPTICAL)}
    cameras = {links[name][0] for name in optical}
    sensors = [
        PortableSensor(name, poses[name], CAMERA if name in cameras else None)
        for name in links
        if name not in optical
    ]
    return with_info(path.parent, sensors)


def _links(path: Path) -> dict[str, tuple[str, Pose]]:
    """Return the parent and the pose in the parent frame, by frame name."""
    calls = ARGS.findall(without_comments(values.text_of(path)))
    values.require_at_most(path, "file", len(calls), values.MAX_FRAMES, f"calls of {PUBLISHER}")
    links: dict[str, tuple[str, Pose]] = {}
    for number, arguments in enumerate(calls):
        field = f"transform {number + 1}"
        longest = values.MAX_LINE_LENGTH
        values.require_at_most(path, field, len(arguments), longest, "characters")
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

    def numbers(keys: Sequence[str]) -> list[float]:
        texts = [(key, options.get(f"--{key}", "1" if key == "qw" else "0")) for key in keys]
        return [values.figure(path, f"{field}, {key}", text) for key, text in texts]

    position = numbers(XYZ)
    if any(f"--{key}" in options for key in QUATERNION):
        rotation = frames.from_quaternion(path, field, numbers(QUATERNION))
        return ends[0], ends[1], frames.pose_of(rotation, position)
    return ends[0], ends[1], values.pose_from(path, field, position, numbers(RPY))


def without_comments(text: str) -> str:
    """Return XML without its comments, in one pass; an unclosed comment extends to the end."""
    first, *parts = text.split("<!--")
    return first + "".join(part.partition("-->")[2] for part in parts)

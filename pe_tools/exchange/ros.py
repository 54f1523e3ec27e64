"""ROS 2 static transforms: a launch file of tf2's static_transform_publisher.

Import also reads shell scripts that call the publisher. Camera intrinsics are beside it, see
`camera_info`.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.sax.saxutils import escape, unescape

from pe_core.base.errors import InputError, shown
from pe_core.geometry.poses import Pose
from pe_tools.formats.xml_text import without_comments

from . import foreign_values as values
from . import frames
from .camera_info import info_files, with_info
from .foreign_values import RPY, XYZ, Export
from .merging import gone_lines
from .portable import ORIGIN, ForeignRig, MergeTarget, PortableRig, PortableSensor
from .portable_kinds import CAMERA

FILE = "rig.launch.xml"
ROOT = "base_link"
PUBLISHER = "static_transform_publisher"
QUATERNION = ("qw", "qx", "qy", "qz")
ENDS = ("frame-id", "child-frame-id")
EQUALS = re.compile(r"(--[a-z-]+)=")  # Between an option and its value, in place of a blank
NODE = re.compile(r"<node\b([^<]*)")
ATTRIBUTE = re.compile(r"""(?<![\w.:-])([\w.:-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
QUOTED = r"""(?<=[\s=])"[^"\n<]*"|(?<=[\s=])'[^'\n<]*'"""
CONTINUED = r"\\\r?\n"  # The end of a line that goes on in the next one
CALL = re.compile(rf"{PUBLISHER}[\"']?((?:[^<\"'\n\\]|{CONTINUED}|{QUOTED})*)")
"""Nodes of a launch file up to the next tag, their attributes, and calls in other files: the
arguments of a shell, some of which may be in quotes."""
REMARK = re.compile(r"^[ \t]*#.*$", re.MULTILINE)  # A line of a script that is not run
END = re.compile(r"\s+(&&?|\|\|?|>>?|2>&1|#|--ros-args)(\s|$)|\s*;")
"""What is behind the arguments of a call: the shell's end of a command, or ROS's own arguments."""
OLD_NODE = re.compile(r"<node\b[^<]*\btype\s*=")  # A node of ROS 1
POSITIONAL = ("x", "y", "z", "yaw", "pitch", "roll")
POSITIONAL_QUATERNION = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Numbers before both frames in a call without options; ROS 1 has a period [ms] after these."""


@dataclass(frozen=True, slots=True)
class LaunchCall:
    """A call of the publisher: where it is in the text of the file, its arguments, and the text
    behind these."""

    start: int
    end: int
    args: str
    tail: str

    @classmethod
    def at(cls, span: tuple[int, int], text: str) -> LaunchCall:
        """Return the call of a text at a place of the file."""
        end = END.search(text)
        length = len(text) if end is None else end.start()
        first, last = span
        return cls(first, last, text[:length], text[length:])


@dataclass(frozen=True, slots=True)
class Transforms:
    """The content of a file: its text, the calls by the frame that they place, the frames on their
    parents, and the poses of all frames in the root frame, by name."""

    text: str
    calls: dict[str, LaunchCall]
    links: dict[str, tuple[str, Pose]]
    poses: dict[str, Pose]

    @property
    def root(self) -> str:
        """Name of the frame without a parent."""
        return next(name for name in self.poses if name not in self.links)


@dataclass(frozen=True, slots=True)
class FrameEntry:
    """The frame of a file that carries a sensor, and the sensor's pose there."""

    frame: str
    pose: Pose


NEW = Transforms(f"<!-- {ROOT}{frames.AXES}-->\n<launch>\n</launch>\n", {}, {}, {ROOT: ORIGIN})


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return a launch file with a publisher for each sensor, or a file with its calls updated. Its
    frames that are gone stay, with a message."""
    document: Transforms = NEW if into is None else into.document
    linked, lines = frames.linked(sensors, document.root, document.poses)
    added = [link for sensor, links in linked if sensor.entry is None for link in links]
    text = _with_calls(_with_moves(document, sensors), added)
    if into is not None:
        lines += gone_lines(sensor.entry.frame for sensor in into.gone)
    files = {FILE: text} | info_files(sensor for sensor, _ in linked)
    return {name: text.encode() for name, text in files.items()}, lines


def _with_moves(document: Transforms, sensors: PortableRig) -> str:
    """Return the text of a file with the arguments of the frames that moved."""
    wanted = {}
    for sensor in sensors:
        if (entry := sensor.entry) is not None:
            frame = document.poses[entry.frame]
            wanted[entry.frame] = frames.carried_along(sensor, entry.pose, frame)
    text = document.text
    places, _ = frames.new_places(document.links, document.poses, wanted)
    for child in sorted(places, key=lambda name: -document.calls[name].start):
        call = document.calls[child]
        order = _order(_words(call.args))
        ends = " ".join(_words(call.args)[len(order) :])
        if not order:
            ends = _ends(document.links[child][0], child)
        blank = " " if call.args[:1] == " " else ""
        args = f"{blank}{_numbers_text(order, places[child])} {ends}{call.tail}"
        if "<node" in text:
            args = escape(args, {'"': "&quot;", "'": "&apos;"})
        text = text[: call.start] + args + text[call.end :]
    return text


def _with_calls(text: str, added: Iterable[tuple[str, str, Pose]]) -> str:
    """Return the text of a file with calls for more frames, in the form of the file."""
    place = text.rfind("</launch>")
    is_launch = place >= 0 or "<node" in text
    is_old = OLD_NODE.search(text) is not None  # whose publisher knows no options
    lines = []
    for parent, child, pose in added:
        if is_old:
            args = f"{_numbers_text(POSITIONAL, pose)} {parent} {child}"
            line = f'  <node pkg="tf2_ros" type="{PUBLISHER}" name="{child}" args="{args}" />'
        else:
            args = f"{_numbers_text((), pose)} {_ends(parent, child)}"
            line = f'  <node pkg="tf2_ros" exec="{PUBLISHER}" args="{args}" />'
        lines.append(line if is_launch else f"ros2 run tf2_ros {PUBLISHER} {args}")
    place = place if place >= 0 else len(text)
    before = text[:place]
    if lines and not before.endswith("\n"):
        before += "\n"
    return before + "".join(f"{line}\n" for line in lines) + text[place:]


def _ends(parent: str, child: str) -> str:
    return f"--{ENDS[0]} {parent} --{ENDS[1]} {child}"


def _numbers_text(order: Sequence[str], pose: Pose) -> str:
    """Return the numbers of a call: as options, or alone in an order."""
    numbers = values.pose_numbers(pose)
    if not order:
        pairs = numbers.items()
        return " ".join(f"--{key} {values.plain_number(value)}" for key, value in pairs)
    turn = frames.quaternion(pose.ground_from_sensor)
    numbers |= dict(zip(QUATERNION, turn, strict=True))
    return values.spaced([numbers[key] for key in order])


def read(path: Path) -> ForeignRig:
    """Read the transforms of all calls of the publisher in a file, in the frame of their root. A
    frame with one optical frame below it is a camera, that looks along the optical axis; so is an
    optical frame on its own. The kind of others is unknown."""
    path = path / FILE if path.is_dir() else path
    text = values.text_of(path)
    links, calls = _links(path, text)
    names = dict.fromkeys(name for child, (parent, _) in links.items() for name in (parent, child))
    poses = frames.poses_from_root(path, links, names, "frame")
    owners = frames.camera_frames({child: parent for child, (parent, _) in links.items()})
    optical_of = {owner: name for name, owner in owners.items() if owner in links}
    sensors = []
    for name in links:
        owner = owners.get(name)
        if owner in links:
            continue
        sensor = PortableSensor(owner or name, poses[name], CAMERA if owner else None)
        if name in optical_of:
            sensor = frames.as_camera(sensor, poses[optical_of[name]])
        else:
            sensor = frames.with_body_axes(sensor, name)
        sensors.append(replace(sensor, entry=FrameEntry(name, sensor.pose)))
    document = Transforms(text, calls, links, poses)
    return ForeignRig(with_info(path.parent, sensors), document=document)


def _links(path: Path, text: str) -> tuple[dict[str, tuple[str, Pose]], dict[str, LaunchCall]]:
    """Return the parent and the pose in the parent frame, and the calls, by frame name."""
    calls = _calls(without_comments(text))
    values.require_at_most(
        path, "file", len(calls), values.MAX_FRAMES, noun=f"calls of {PUBLISHER}"
    )
    links: dict[str, tuple[str, Pose]] = {}
    by_frame: dict[str, LaunchCall] = {}
    for number, call in enumerate(calls):
        arguments = call.args
        field = f"transform {number + 1}"
        longest = values.MAX_LINE_LENGTH
        values.require_at_most(path, field, len(arguments), longest, noun="characters")
        parent, child, pose = _transform(path, field, arguments)
        if child in links:
            raise InputError(path, f"frame {child}", "one parent", "two")
        links[child] = parent, pose
        by_frame[child] = call
    if not links:
        raise InputError(path, "file", f"calls of {PUBLISHER}", "none")
    return links, by_frame


def _calls(text: str) -> list[LaunchCall]:
    """Return the calls of the publisher: nodes of a launch file, else lines of a script."""
    calls = []
    for node in NODE.finditer(text):
        if PUBLISHER not in node[1]:
            continue
        if len(node[1]) > 2 * values.MAX_LINE_LENGTH:  # it is refused by its length
            calls.append(LaunchCall(*node.span(1), node[1], ""))
            continue
        found = {each[1]: each for each in ATTRIBUTE.finditer(text, *node.span(1))}
        attributes = {key: unescape(each[2] or each[3] or "") for key, each in found.items()}
        if PUBLISHER in (attributes.get("exec"), attributes.get("type")):
            args = found.get("args")
            span = (0, 0) if args is None else args.span(2 if args[2] is not None else 3)
            calls.append(LaunchCall.at(span, attributes.get("args", "")))
    if "<node" in text:
        return calls
    text = REMARK.sub(lambda remark: " " * len(remark[0]), text)
    return [LaunchCall.at(call.span(1), call[1]) for call in CALL.finditer(text)]


def _transform(path: Path, field: str, args: str) -> tuple[str, str, Pose]:
    """Return parent, child and pose of one call."""
    try:
        words = _words(args)
    except ValueError as error:
        raise InputError(path, field, "arguments", error) from None
    options = _positional(words) or dict(zip(words[::2], words[1::2], strict=False))
    ends = [options.get(f"--{end}", "") for end in ENDS]
    if not all(ends):
        expected = "--frame-id and --child-frame-id, or 6 or 7 numbers and two frames"
        raise InputError(path, field, expected, shown(args.strip()))

    def figures(keys: Sequence[str]) -> list[float]:
        texts = [(key, options.get(f"--{key}", "1" if key == "qw" else "0")) for key in keys]
        return [values.figure(path, f"{field}, {key}", text) for key, text in texts]

    position = figures(XYZ)
    if any(f"--{key}" in options for key in QUATERNION):
        rotation = frames.from_quaternion(path, field, figures(QUATERNION))
        return ends[0], ends[1], frames.pose_of(rotation, position)
    return ends[0], ends[1], values.pose_from(path, field, position, figures(RPY))


def _words(args: str) -> list[str]:
    return shlex.split(EQUALS.sub(r"\1 ", re.sub(CONTINUED, " ", args)))


def _positional(words: Sequence[str]) -> dict[str, str]:
    """Return a call of numbers and frames as options; empty if it is none."""
    order = _order(words)
    numbers = dict(zip((f"--{key}" for key in order), words, strict=False))
    ends = dict(zip((f"--{end}" for end in ENDS), words[len(order) :], strict=False))
    return numbers | ends if order else {}


def _order(words: Sequence[str]) -> Sequence[str]:
    """Return the order of the numbers in a call without options; empty if it is none. It has x, y,
    z, then yaw, pitch, roll or a quaternion, parent and child, and in ROS 1 a period."""
    keys = {f"--{key}" for key in (*XYZ, *RPY, *QUATERNION, *ENDS)}
    if keys & set(words):
        return ()
    is_number = [values.PLAIN.fullmatch(word) is not None for word in words]
    for order in (POSITIONAL_QUATERNION, POSITIONAL):
        count = len(order)
        is_call = len(words) == count + 2 or (len(words) == count + 3 and is_number[-1])
        if is_call and all(is_number[:count]) and not any(is_number[count : count + 2]):
            return order
    return ()

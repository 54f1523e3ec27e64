"""ROS 2 static transforms: a launch file of tf2's static_transform_publisher.

Import also reads shell scripts that call the publisher.

Camera intrinsics are beside it, one file camera_info/NAME.yaml per camera. ROS calls the
Brown-Conrady distortion plumb_bob, or rational_polynomial if it has a denominator. It calls the
Kannala-Brandt distortion equidistant.
"""

import re
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring
from xml.sax.saxutils import escape, unescape

import numpy as np

from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.table_reader import Table
from pe_core.base.values import numbers
from pe_core.geometry.poses import Pose
from pe_core.sensors.camera import BrownConrady, KannalaBrandt, Lens, Pinhole
from pe_tools.formats.yaml_text import parse_yaml

from . import foreign_values as values
from . import frames
from .foreign_values import RPY, XYZ, Export
from .lens_pictures import Picture
from .merging import gone_lines
from .portable import ForeignRig, MergeTarget, PortableRig, PortableSensor
from .portable_kinds import CAMERA, camera_of

FILE, ROOT = "rig.launch.xml", "base_link"
PUBLISHER = "static_transform_publisher"
QUATERNION = ("qw", "qx", "qy", "qz")
ENDS = ("frame-id", "child-frame-id")
EQUALS = re.compile(r"(--[a-z-]+)=")  # Between an option and its value, in place of a blank
NODE = re.compile(r"<node\b([^<]*)")
ATTRIBUTE = re.compile(r"""(?<![\w.:-])([\w.:-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
CALL = re.compile(rf"{PUBLISHER}[\"']?([^<\"'\n]*)")
"""Nodes of a launch file up to the next tag, their attributes, and calls in other files."""
END = re.compile(r"\s+(&&?|\|\|?|>>?|2>&1|#|--ros-args)(\s|$)|\s*;")
EXEC = re.compile(r"<node\b[^<]*\bexec\s*=")  # A node of ROS 2; one of ROS 1 has a type instead
NO_LINE_END = re.compile(r"[^\n]")
END_WORDS = frozenset(("&", "&&", "|", "||", ";", ">", ">>", "2>&1", "#", "--ros-args"))
"""Words behind the arguments of a call, and where the first of them is."""
POSITIONAL = ("x", "y", "z", "yaw", "pitch", "roll")
POSITIONAL_QUATERNION = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Numbers before both frames in a call without options; ROS 1 has a period [ms] after these."""

FOLDER = "camera_info"
PLUMB_BOB, RATIONAL, EQUIDISTANT = "plumb_bob", "rational_polynomial", "equidistant"
FEWEST = {PLUMB_BOB: (4, 5), RATIONAL: (8,), EQUIDISTANT: (4,)}
"""Allowed numbers of coefficients by distortion model. Further coefficients must be 0."""
LENSES: dict[str, type[Lens]] = {
    PLUMB_BOB: BrownConrady,
    RATIONAL: BrownConrady,
    EQUIDISTANT: KannalaBrandt,
    "fisheye": KannalaBrandt,
}


@dataclass(frozen=True, slots=True)
class Call:
    """A call of the publisher: where its arguments are in the text of the file, and these."""

    start: int
    end: int
    args: str


@dataclass(frozen=True, slots=True)
class Transforms:
    """The content of a file: its text, the calls by the frame that they place, the frames on their
    parents, and the poses of all frames in the root frame, by name."""

    text: str
    calls: dict[str, Call]
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


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return a launch file with a publisher for each sensor, or a file with its calls updated. Its
    frames that are gone stay, with a message."""
    document: Transforms | None = None if into is None else into.document
    root = ROOT if document is None else document.root
    taken = () if document is None else document.poses
    linked, lines = frames.linked(sensors, root, taken)
    added = [link for sensor, links in linked if sensor.entry is None for link in links]
    if into is None or document is None:
        text = _new(added)
    else:
        text = _updated(document, sensors, added)
        lines += gone_lines(sensor.entry.frame for sensor in into.gone)
    files = {FILE: text} | info_files(sensor for sensor, _ in linked)
    return {name: text.encode() for name, text in files.items()}, lines


def _new(links: Iterable[tuple[str, str, Pose]]) -> str:
    launch = Element("launch")
    for parent, child, pose in links:
        args = _options_text(parent, child, pose)
        SubElement(launch, "node", {"pkg": "tf2_ros", "exec": PUBLISHER, "args": args})
    indent(launch)
    return f"<!-- {ROOT}{frames.AXES}-->\n{tostring(launch, 'unicode')}\n"


def _options_text(parent: str, child: str, pose: Pose) -> str:
    pairs = values.pose_numbers(pose).items()
    args = " ".join(f"--{key} {values.plain_number(value)}" for key, value in pairs)
    return f"{args} --{ENDS[0]} {parent} --{ENDS[1]} {child}"


def _positional_text(order: Sequence[str], pose: Pose) -> str:
    """Return the numbers of a call without options."""
    w, x, y, z = frames.quaternion(pose.ground_from_sensor)
    turn = dict(zip(QUATERNION, (w, x, y, z), strict=True))
    numbers = values.pose_numbers(pose) | turn
    return values.spaced([numbers[key] for key in order])


def _updated(
    document: Transforms, sensors: PortableRig, added: Sequence[tuple[str, str, Pose]]
) -> str:
    """Return the text with the arguments of frames that moved, and calls for added ones."""
    wanted = {
        sensor.entry.frame: frames.carried_along(
            sensor, sensor.entry.pose, document.poses[sensor.entry.frame]
        )
        for sensor in sensors
        if sensor.entry is not None
    }
    text = document.text
    is_launch = "<node" in text
    places, _ = frames.new_places(document.links, document.poses, wanted)
    for child in sorted(places, key=lambda name: -document.calls[name].start):
        call = document.calls[child]
        args = _new_args(call.args, document.links[child][0], child, places[child])
        args = escape(args, {'"': "&quot;", "'": "&apos;"}) if is_launch else args
        text = text[: call.start] + args + text[call.end :]
    is_old = is_launch and not EXEC.search(text)
    lines = []
    for parent, child, pose in added:
        args = _options_text(parent, child, pose)
        if is_old:  # a launch file of ROS 1, whose publisher knows no options
            args = f"{_positional_text(POSITIONAL, pose)} {parent} {child}"
            lines.append(f'<node pkg="tf2_ros" type="{PUBLISHER}" name="{child}" args="{args}"/>')
        elif is_launch:
            lines.append(f'<node pkg="tf2_ros" exec="{PUBLISHER}" args="{args}"/>')
        else:
            lines.append(f"ros2 run tf2_ros {PUBLISHER} {args}")
    if not lines:
        return text
    before, end, after = text.rpartition("</launch>") if is_launch else (text, "", "")
    indentation = "  " if is_launch else ""
    new = "".join(f"{indentation}{line}\n" for line in lines)
    return f"{before}{'' if before.endswith(chr(10)) else chr(10)}{new}{end}{after}"


def _new_args(args: str, parent: str, child: str, pose: Pose) -> str:
    """Return the arguments of a call with another pose; what follows them in a script stays."""
    end = END.search(args)
    tail = "" if end is None else args[end.start() :]
    blank = " " if args[:1] == " " else ""
    words = _until_end(_words(args))
    order = _order(words)
    if not order:
        return f"{blank}{_options_text(parent, child, pose)}{tail}"
    others = " ".join(words[len(order) :])
    return f"{blank}{_positional_text(order, pose)} {others}{tail}"


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


def _links(path: Path, text: str) -> tuple[dict[str, tuple[str, Pose]], dict[str, Call]]:
    """Return the parent and the pose in the parent frame, and the calls, by frame name."""
    calls = _calls(without_comments(text))
    values.require_at_most(path, "file", len(calls), values.MAX_FRAMES, f"calls of {PUBLISHER}")
    links: dict[str, tuple[str, Pose]] = {}
    by_frame: dict[str, Call] = {}
    for number, call in enumerate(calls):
        arguments = call.args
        field = f"transform {number + 1}"
        longest = values.MAX_LINE_LENGTH
        values.require_at_most(path, field, len(arguments), longest, "characters")
        parent, child, pose = _transform(path, field, arguments)
        if child in links:
            raise InputError(path, f"frame {child}", "one parent", "two")
        links[child] = parent, pose
        by_frame[child] = call
    if not links:
        raise InputError(path, "file", f"calls of {PUBLISHER}", "none")
    return links, by_frame


def _calls(text: str) -> list[Call]:
    """Return the calls of the publisher: nodes of a launch file, else lines of a script."""
    calls = []
    for node in NODE.finditer(text):
        if PUBLISHER not in node[1]:
            continue
        if len(node[1]) > 2 * values.MAX_LINE_LENGTH:  # it is refused by its length
            calls.append(Call(*node.span(1), node[1]))
            continue
        found = {each[1]: each for each in ATTRIBUTE.finditer(node[1])}
        attributes = {key: unescape(each[2] or each[3] or "") for key, each in found.items()}
        if PUBLISHER in (attributes.get("exec"), attributes.get("type")):
            args = found.get("args")
            if args is None:
                calls.append(Call(*node.span(1), ""))
                continue
            start, end = args.span(2 if args[2] is not None else 3)
            first = node.start(1)
            calls.append(Call(first + start, first + end, attributes["args"]))
    if "<node" in text:
        return calls
    return [Call(*call.span(1), call[1]) for call in CALL.finditer(text)]


def _transform(path: Path, field: str, args: str) -> tuple[str, str, Pose]:
    """Return parent, child and pose of one call."""
    try:
        words = _until_end(_words(args))
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
    return shlex.split(EQUALS.sub(r"\1 ", args))


def _until_end(words: Sequence[str]) -> list[str]:
    """Return the words of a call up to the shell's end of a command, or ROS's own arguments."""
    ends = (k for k, word in enumerate(words) if word in END_WORDS or word.endswith(";"))
    end = next(ends, len(words))
    last = [word[:-1] for word in words[end : end + 1] if word.endswith(";") and word != ";"]
    return [*words[:end], *last]


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


def without_comments(text: str) -> str:
    """Return XML with blanks in place of its comments, in one pass; an unclosed comment extends to
    the end."""
    first, *parts = text.split("<!--")
    plain = [first]
    for part in parts:
        comment, end, after = part.partition("-->")
        plain += [NO_LINE_END.sub(" ", f"<!--{comment}{end}"), after]
    return "".join(plain)


def info_name(camera: str) -> str:
    """Return the path of a camera's file, relative to the folder of the rig."""
    return f"{FOLDER}/{camera}.yaml"


def info_files(sensors: Iterable[PortableSensor]) -> dict[str, str]:
    """Return the texts of the camera_info files of a rig by name; lenses are models of OpenCV."""
    return {
        info_name(sensor.name): _text(sensor.name, sensor.picture, sensor.picture.size)
        for sensor in sensors
        if sensor.picture is not None and sensor.picture.size is not None
    }


def _text(name: str, picture: Picture, size: tuple[int, int]) -> str:
    lens, (width, height) = picture.lens, size
    model, bent = EQUIDISTANT, [float(getattr(lens, key)) for key in lens.coefficients]
    if not isinstance(lens, KannalaBrandt):
        model = RATIONAL if any(bent[5:]) else PLUMB_BOB
        bent = bent if model == RATIONAL else (bent or [0.0] * 5)[:5]
    k = [value for row in picture.matrix for value in row]
    p = [value for row in picture.matrix for value in (*row, 0.0)]
    identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    lines = [f"image_width: {width}", f"image_height: {height}", f"camera_name: {name}"]
    lines += _matrix("camera_matrix", 3, k)
    lines += [f"distortion_model: {model}"]
    lines += _matrix("distortion_coefficients", 1, bent)
    lines += _matrix("rectification_matrix", 3, identity) + _matrix("projection_matrix", 3, p)
    return "\n".join(lines) + "\n"


def _matrix(key: str, rows: int, data: Sequence[float]) -> list[str]:
    texts, cols = ", ".join(map(values.plain_number, data)), len(data) // rows
    return [f"{key}:", f"  rows: {rows}", f"  cols: {cols}", f"  data: [{texts}]"]


def with_info(folder: Path, sensors: Iterable[PortableSensor]) -> PortableRig:
    """Return sensors with the intrinsics in `folder`; a sensor with intrinsics is a camera."""
    result = []
    for sensor in sensors:
        path = folder / info_name(sensor.name)
        if path.is_file():
            picture, note = read_info(str(path), values.text_of(path))
            told = "; ".join(filter(None, [sensor.told, note]))
            sensor = replace(sensor, kind=CAMERA, picture=picture, told=told)
        result.append(sensor)
    return tuple(result)


def read_info(source: str, text: str) -> tuple[Picture | None, str]:
    """Return the intrinsics in the text of a camera_info file, and a message (may be empty). If the
    file is damaged, or its lens is not known or is that of no camera, they are None and the message
    says why."""
    try:
        picture = picture_of_info(source, text)
        camera_of(source, picture)
        return picture, ""
    except InputError as error:
        return None, f"its lens is left out: {error.at(f'{FOLDER}/{Path(source).name}')}"


def picture_of_info(source: str, text: str) -> Picture:
    """Return the intrinsics in the text of a camera_info file. A number that is missing, or a
    distortion model that is none of `LENSES`, raises `InputError`."""
    top = Table(parse_yaml(source, text), source)
    size = (
        top.whole("image_width", rule=values.PIXELS),
        top.whole("image_height", rule=values.PIXELS),
    )
    k = _data(top.table("camera_matrix"), (9,))
    model = top.text("distortion_model", PLUMB_BOB)
    if model not in LENSES:
        raise top.error("distortion_model", one_of(LENSES, model), shown(model))
    bent = _data(top.table("distortion_coefficients"), FEWEST.get(model, (4,)))
    intrinsics = k[0], k[4], k[2], k[5]
    if not any(bent) and LENSES[model] is BrownConrady:
        return Picture(Pinhole(*intrinsics), size)
    return Picture(LENSES[model](*intrinsics, None, *bent), size)


def _data(table: Table, lengths: Sequence[int]) -> list[float]:
    """Return the finite numbers of a matrix; beyond the greatest length there may be zeros."""
    value, most = table.raw("data"), max(lengths)
    found = numbers(value) if isinstance(value, list) else None
    data = [] if found is None or not np.isfinite(found).all() else found.ravel().tolist()
    if len(data) not in lengths and (len(data) < most or any(data[most:])):
        expected = f"{' or '.join(map(str, lengths))} numbers"
        raise InputError(table.source, table.field("data"), expected, shown(value))
    return data[:most]

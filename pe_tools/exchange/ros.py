"""ROS 2 static transforms: a launch file of tf2's static_transform_publisher.

Import also reads shell scripts that call the publisher.

Camera intrinsics are beside it, one file camera_info/NAME.yaml per camera. ROS calls the
Brown-Conrady distortion plumb_bob, or rational_polynomial if it has a denominator. It calls the
Kannala-Brandt distortion equidistant.
"""

import re
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring
from xml.sax.saxutils import unescape

import numpy as np

from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.table_reader import Table
from pe_core.base.values import numbers
from pe_core.geometry.poses import Pose
from pe_core.sensors.camera import BrownConrady, KannalaBrandt, Lens, Pinhole
from pe_tools.formats.xml_text import parse_xml
from pe_tools.formats.yaml_text import parse_yaml

from . import foreign_values as values
from . import frames
from .foreign_values import RPY, XYZ, Export, FileTexts
from .lens_pictures import Picture
from .portable import PortableRig, PortableSensor
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
END_WORDS = frozenset(("&", "&&", "|", "||", ";", ">", ">>", "2>&1", "#", "--ros-args"))
"""Words behind the arguments of a call."""
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


def write(sensors: PortableRig, texts: FileTexts) -> Export:
    """Return a launch file with a publisher for each sensor, with the root of an imported one."""
    root = ROOT
    if texts:
        root = parse_xml("passthrough", texts.get(FILE, "").encode()).get("root", ROOT)
    launch = Element("launch")
    linked, lines = frames.linked(sensors, root)
    for _, links in linked:
        for parent, child, pose in links:
            pairs = values.pose_numbers(pose).items()
            args = " ".join(f"--{key} {values.plain_number(value)}" for key, value in pairs)
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
    """Read the transforms of all calls of the publisher in a file, in the frame of their root. A
    frame with one optical frame below it is a camera, that looks along the optical axis; so is an
    optical frame on its own. The kind of others is unknown."""
    path = path / FILE if path.is_dir() else path
    links = _links(path)
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
            sensors.append(frames.as_camera(sensor, poses[optical_of[name]]))
        else:
            sensors.append(frames.with_body_axes(sensor, name))
    return with_info(path.parent, sensors)


def _links(path: Path) -> dict[str, tuple[str, Pose]]:
    """Return the parent and the pose in the parent frame, by frame name."""
    calls = _calls(without_comments(values.text_of(path)))
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


def _calls(text: str) -> list[str]:
    """Return the arguments of the publisher in each call: of nodes of a launch file, else of lines
    of a script."""
    calls = []
    for node in NODE.finditer(text):
        if PUBLISHER not in node[1]:
            continue
        if len(node[1]) > 2 * values.MAX_LINE_LENGTH:  # it is refused by its length
            calls.append(node[1])
            continue
        found = ATTRIBUTE.findall(node[1])
        attributes = {key: unescape(double or single) for key, double, single in found}
        if PUBLISHER in (attributes.get("exec"), attributes.get("type")):
            calls.append(attributes.get("args", ""))
    return calls if "<node" in text else CALL.findall(text)


def _transform(path: Path, field: str, args: str) -> tuple[str, str, Pose]:
    """Return parent, child and pose of one call."""
    try:
        words = shlex.split(EQUALS.sub(r"\1 ", args))
    except ValueError as error:
        raise InputError(path, field, "arguments", error) from None
    words = _until_end(words)
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


def _until_end(words: Sequence[str]) -> list[str]:
    """Return the words of a call up to the shell's end of a command, or ROS's own arguments."""
    ends = (k for k, word in enumerate(words) if word in END_WORDS or word.endswith(";"))
    end = next(ends, len(words))
    last = [word[:-1] for word in words[end : end + 1] if word.endswith(";") and word != ";"]
    return [*words[:end], *last]


def _positional(words: Sequence[str]) -> dict[str, str]:
    """Return a call of numbers and frames as options; empty if it is none. It has x, y, z, then
    yaw, pitch, roll or a quaternion, parent and child, and in ROS 1 a period."""
    keys = {f"--{key}" for key in (*XYZ, *RPY, *QUATERNION, *ENDS)}
    if keys & set(words):
        return {}
    is_number = [values.PLAIN.fullmatch(word) is not None for word in words]
    for order in (POSITIONAL_QUATERNION, POSITIONAL):
        count = len(order)
        is_call = len(words) == count + 2 or (len(words) == count + 3 and is_number[-1])
        if is_call and all(is_number[:count]) and not any(is_number[count : count + 2]):
            numbers = dict(zip((f"--{key}" for key in order), words, strict=False))
            ends = dict(zip((f"--{end}" for end in ENDS), words[count:], strict=False))
            return numbers | ends
    return {}


def without_comments(text: str) -> str:
    """Return XML without its comments, in one pass; an unclosed comment extends to the end."""
    first, *parts = text.split("<!--")
    return first + "".join(part.partition("-->")[2] for part in parts)


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

"""URDF: links and fixed joints, an optical frame for each camera (REP 103).

Intrinsics stand in Gazebo's sensor elements, as far as these can say them; the model's name beside
them, where readers of URDF pass over what they do not know.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..errors import InputError, shown
from ..kinds import KINDS
from ..scene.geometry import Pose
from ..text.files import read_bytes
from ..text.xml_text import parse_xml
from .carried import CAMERA, LIDAR, CarriedSensor, uneven
from .figures import FARTHEST, MIN_RANGE, figure, figures
from .files import Written, plain_number, pose_from, spaced
from .frame_names import OPTICAL, with_optical_frames
from .frame_tree import poses_from_root
from .frames import OPTICAL_RPY, seen_from
from .gazebo_camera import picture_in, write_clip, write_picture
from .gazebo_element import SensorElement
from .gazebo_lidar import scan_in, write_scan
from .limits import MAX_FRAMES, require_at_most
from .passthrough import entry_row, pose_entry, pose_of_entry

RANGES = ("min_range", "max_range")
FILE, ROOT, NAME = "rig.urdf", "base_link", "rig"
ON_GROUND = "base_footprint"
"""The link on the ground under a robot (REP 120)."""
AXES = (
    "x forward, y left, z up; metres, radians. NAME_optical looks along z, x right, y down (REP "
    "103). Links have a mass and joints are preserved, so that Gazebo keeps each sensor's frame; "
    "gravity does not move them. "
)
OURS, THEIRS = " is on the ground under the vehicle's centre: ", " is that of the imported file: "
GAZEBO_KINDS = {CAMERA: CAMERA, LIDAR: "gpu_lidar"}
KIND_WORDS = {CAMERA: CAMERA, LIDAR: LIDAR, "ray": LIDAR, "depth": CAMERA}
"""What a word in a Gazebo sensor's type says of its kind."""
INERTIA_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
MASS_KG, INERTIA = 0.01, 1e-5
"""Of every link [kg, kg m2]: Gazebo has none without (sdformat's issue 199), nor below 1e-5 kg."""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a robot that is nothing but the rig."""
    return _written(sensors, NAME, ROOT, OURS)


def write_over(
    texts: Mapping[str, str], sensors: tuple[CarriedSensor, ...]
) -> tuple[Written, list[str]]:
    """Return such a robot under the name and on the root of the one that came in."""
    robot = parse_xml("passthrough", texts.get(FILE, "").encode())
    link = robot.find("link")
    root = ROOT if link is None else link.get("name", ROOT)
    return _written(sensors, robot.get("name", NAME), root, THEIRS)


def source(path: Path) -> dict[str, str]:
    """Return a robot of the same name with nothing but the link where poses are taken."""
    robot = _robot(path)
    skeleton = Element("robot", {"name": robot.get("name", NAME)})
    SubElement(skeleton, "link", {"name": _origin_of(_poses(path, robot))})
    return {FILE: tostring(skeleton, "unicode")}


def _written(
    sensors: tuple[CarriedSensor, ...], name: str, root: str, where: str
) -> tuple[Written, list[str]]:
    kept = [each for each in sensors if each.is_left_out]
    ours = [each for each in sensors if not each.is_left_out]
    named, lines = with_optical_frames(ours, (root, *(each.name for each in kept)))
    robot = Element("robot", {"name": name})
    _link(robot, root)
    for each in named:
        _joint(robot, root, each.name, each.pose)
        if each.kind == CAMERA:
            _joint(robot, each.name, each.name + OPTICAL, Pose((0.0, 0.0, 0.0), OPTICAL_RPY))
        _gazebo(robot, each)
    for each in kept:
        _as_it_came(robot, root, each)
    indent(robot)
    text = f'<?xml version="1.0"?>\n<!-- {root}{where}{AXES}-->\n{tostring(robot, "unicode")}\n'
    return {FILE: text.encode()}, lines + uneven(named, "Gazebo")


def _link(robot: Element, name: str) -> None:
    """Add a link that Gazebo takes for one, and that gravity does not move."""
    inertial = SubElement(SubElement(robot, "link", {"name": name}), "inertial")
    SubElement(inertial, "mass", {"value": repr(MASS_KG)})
    values = {key: repr(INERTIA if key[1] == key[2] else 0.0) for key in INERTIA_KEYS}
    SubElement(inertial, "inertia", values)
    block = SubElement(robot, "gazebo", {"reference": name})
    SubElement(block, "turnGravityOff").text = "true"


def _joint(robot: Element, parent: str, child: str, pose: Pose) -> None:
    """Add a link on a fixed joint, which Gazebo is not to fuse with the parent."""
    _link(robot, child)
    name = f"{child}_joint"
    joint = SubElement(robot, "joint", {"name": name, "type": "fixed"})
    SubElement(joint, "parent", {"link": parent})
    SubElement(joint, "child", {"link": child})
    SubElement(joint, "origin", {"xyz": spaced(pose.position), "rpy": spaced(pose.rpy)})
    block = SubElement(robot, "gazebo", {"reference": name})
    SubElement(block, "preserveFixedJoint").text = "true"


def _gazebo(robot: Element, each: CarriedSensor) -> None:
    block = SubElement(robot, "gazebo", {"reference": each.name})
    kind = GAZEBO_KINDS.get(each.kind or "")
    known = {"kind": each.kind or "", "model": each.known_model or "", "fusion": each.fusion or ""}
    known |= {k: "" if (v := getattr(each, k)) is None else plain_number(v) for k in RANGES}
    known = {k: v for k, v in known.items() if v or k in ("kind", "model")}
    SubElement(block, "perception_entropy", known)
    if kind is None or (each.picture is None and each.scan is None):
        return
    sensor = SubElement(block, "sensor", {"name": each.name, "type": kind})
    if each.picture is not None and each.picture.size is not None:
        camera = SubElement(sensor, CAMERA)
        write_picture(camera, each.picture, each.picture.size)
        write_clip(camera, each.min_range, each.max_range)
    elif each.scan is not None:
        write_scan(SubElement(sensor, LIDAR), each.scan)


def _as_it_came(robot: Element, root: str, each: CarriedSensor) -> None:
    """Add a link of another kind with all that Gazebo was told of it."""
    _joint(robot, root, each.name, pose_of_entry(each))
    entry = entry_row(each, lambda _: {}, (), ())
    for block in entry.get("gazebo", ()):
        robot.append(parse_xml("passthrough", str(block).encode()))


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the sensors of a robot, in the frame of its root.

    Sensors are the links that Gazebo's sensors refer to. Where there are none: links with an
    optical frame, and those that nothing hangs on and that have no body.

    Raises
    ------
    InputError
        When it is no URDF, has no root or two, goes in a circle, or has no sensor.
    """
    robot = _robot(path)
    in_root = _poses(path, robot)
    told = {each.get("reference", ""): each for each in robot.iter("gazebo") if _is_sensor(each)}
    names = [name for name in in_root if name in told] or list(_bodiless(robot, in_root))
    if not names:
        raise InputError(path, "link", "links of sensors", "none")
    origin = _origin_of(in_root)
    poses = {name: seen_from(in_root[origin], pose) for name, pose in in_root.items()}
    found = [_sensor(path, name, poses, told.get(name)) for name in names]
    is_ours = next(robot.iter("perception_entropy"), None) is not None
    line = "" if is_ours else _origin_line(origin, in_root)
    return tuple(_with_entry(replace(each, told=line), robot) for each in found)


def _robot(path: Path) -> Element:
    robot = parse_xml(str(path), read_bytes(path))
    if robot.tag != "robot":
        raise InputError(path, "file", "URDF, a <robot>", f"<{robot.tag}>")
    return robot


def _origin_of(poses: dict[str, Pose]) -> str:
    """Return the link that poses are taken in: the one on the ground (REP 120), else the root."""
    return ON_GROUND if ON_GROUND in poses else next(iter(poses))


def _origin_line(origin: str, poses: dict[str, Pose]) -> str:
    """Return where poses of a robot of another program are taken."""
    if origin == ON_GROUND:
        return (
            f"taken in {ON_GROUND}, which is on the ground; if that is not under the middle of the "
            "vehicle, --at says where it is"
        )
    return (
        f"taken in the robot's root, {next(iter(poses))}; if that is not on the ground under the "
        "middle of the vehicle, --at says where it is"
    )


def _with_entry(each: CarriedSensor, robot: Element) -> CarriedSensor:
    """Return a sensor of another kind with what Gazebo is told of its link."""
    if each.kind is None or each.kind in KINDS:
        return each
    blocks = [b for b in robot.iter("gazebo") if b.get("reference") == each.name]
    texts = [tostring(block, "unicode").strip() for block in blocks]
    return replace(each, entry=pose_entry(each, gazebo=texts))


def _is_sensor(block: Element) -> bool:
    return block.find("sensor") is not None or block.find("perception_entropy") is not None


def _poses(path: Path, robot: Element) -> dict[str, Pose]:
    """Return where links are, by name, from the root outward."""
    links = dict.fromkeys(link.get("name", "") for link in robot.iter("link"))
    require_at_most(path, "link", len(links), MAX_FRAMES, "links")
    joints = {}
    for joint in robot.findall("joint"):
        child, parent = (_end(path, joint, end, links) for end in ("child", "parent"))
        if child in joints:
            raise InputError(path, f"link {child}", "one parent", "two")
        joints[child] = parent, _origin(path, joint)
    return poses_from_root(path, joints, links, "link")


def _end(path: Path, joint: Element, end: str, links: Collection[str]) -> str:
    element = joint.find(end)
    name = "" if element is None else element.get("link", "")
    if name not in links:
        field = f"joint {joint.get('name', '')!r}, {end}"
        raise InputError(path, field, "the name of a link", shown(name))
    return name


def _origin(path: Path, joint: Element) -> Pose:
    """Return where a joint puts its child; movable ones are taken as they stand."""
    element, field = joint.find("origin"), f"joint {joint.get('name', '')!r}"
    values = {} if element is None else element.attrib
    keys = ("xyz", "rpy")
    numbers = [figures(path, f"{field}, {k}", values.get(k, "0 0 0"), (3,)) for k in keys]
    return pose_from(path, field, *numbers)


def _bodiless(robot: Element, poses: dict[str, Pose]) -> Iterator[str]:
    """Yield the links that may be sensors where nothing says so."""
    joints, links = robot.findall("joint"), robot.findall("link")
    parents = {end.get("link") for joint in joints for end in joint.iter("parent")}
    heavy = {link.get("name") for link in links if link.find("inertial") is not None}
    for name in list(poses)[1:]:
        is_end = name not in parents and name not in heavy
        if OPTICAL not in name and (is_end or _optical_of(name, poses)):
            yield name


def _optical_of(name: str, poses: dict[str, Pose]) -> str | None:
    """Return the optical frame of a link, by its name."""
    stem = name.removesuffix("_link").removesuffix("_frame")
    endings = (OPTICAL, f"{OPTICAL}_frame", f"{OPTICAL}_link")
    return next((s + e for s in (name, stem) for e in endings if s + e in poses), None)


def _sensor(path: Path, name: str, poses: dict[str, Pose], block: Element | None) -> CarriedSensor:
    kind = CAMERA if _optical_of(name, poses) else None
    if block is None:
        return CarriedSensor(name, poses[name], kind)
    own, sensor = block.find("perception_entropy"), block.find("sensor")
    model = own.get("model") if own is not None else None
    if sensor is not None:
        words = sensor.get("type", "")
        kind = next((k for word, k in KIND_WORDS.items() if word in words), words or kind)
    if own is not None:
        kind = own.get("kind") or kind
    inside = SensorElement(path, name, sensor)
    known = {} if own is None else _known(path, name, own)
    seen = picture_in(inside), scan_in(inside)
    return CarriedSensor(name, poses[name], kind, model or None, *seen, **known)


def _known(path: Path, name: str, own: Element) -> dict[str, Any]:
    """Return a sensor's fusion group and ranges, as far as our own element says them."""
    rules = dict(zip(RANGES, (MIN_RANGE, FARTHEST), strict=True))
    ranges = {
        key: figure(path, f"sensor of {name}, {key}", own.get(key), rule)
        for key, rule in rules.items()
        if own.get(key) is not None
    }
    return {"fusion": own.get("fusion") or None, **ranges}

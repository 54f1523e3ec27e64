"""URDF: links and fixed joints, an optical frame for each camera (REP 103).

Intrinsics stand in Gazebo's sensor elements, as far as these can say them; the model's name beside
them, where readers of URDF pass over what they do not know.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..errors import InputError, shown
from ..scene.geometry import Pose
from ..text.files import read_bytes
from ..text.xml_text import parse_xml
from .carried import CAMERA, LIDAR, CarriedSensor, uneven
from .figures import FARTHEST, MIN_RANGE, figure, figures
from .files import Written, plain_number, pose_from, spaced
from .frame_names import with_legal_frames
from .frame_tree import poses_from_root
from .frames import OPTICAL_RPY
from .gazebo_camera import picture_in, write_clip, write_picture
from .gazebo_element import SensorElement
from .gazebo_lidar import scan_in, write_scan
from .limits import MAX_FRAMES, require_at_most

RANGES = ("min_range", "max_range")
FILE, ROOT, OPTICAL = "rig.urdf", "base_link", "_optical"
CONVENTIONS = (
    " base_link is on the ground under the vehicle's centre: x forward, y left, z up; metres, "
    "radians. NAME_optical looks along z, x right, y down (REP 103). "
)
GAZEBO_KINDS = {CAMERA: CAMERA, LIDAR: "gpu_lidar"}
KIND_WORDS = {CAMERA: CAMERA, LIDAR: LIDAR, "ray": LIDAR, "depth": CAMERA}
"""What a word in a Gazebo sensor's type says of its kind."""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a robot that is nothing but the rig."""
    named, lines = with_legal_frames(sensors)
    robot = Element("robot", {"name": "rig"})
    SubElement(robot, "link", {"name": ROOT})
    for each in named:
        _joint(robot, ROOT, each.name, each.pose.position, each.pose.rpy)
        if each.kind == CAMERA:
            _joint(robot, each.name, each.name + OPTICAL, (0.0, 0.0, 0.0), OPTICAL_RPY)
        _gazebo(robot, each)
    indent(robot)
    text = f'<?xml version="1.0"?>\n<!--{CONVENTIONS}-->\n{tostring(robot, "unicode")}\n'
    return {FILE: text.encode()}, lines + uneven(named, "Gazebo")


def _joint(robot: Element, parent: str, child: str, xyz: object, rpy: object) -> None:
    SubElement(robot, "link", {"name": child})
    joint = SubElement(robot, "joint", {"name": f"{child}_joint", "type": "fixed"})
    SubElement(joint, "parent", {"link": parent})
    SubElement(joint, "child", {"link": child})
    SubElement(joint, "origin", {"xyz": spaced(xyz), "rpy": spaced(rpy)})  # type: ignore[arg-type]


def _gazebo(robot: Element, each: CarriedSensor) -> None:
    block = SubElement(robot, "gazebo", {"reference": each.name})
    kind = GAZEBO_KINDS.get(each.kind or "")
    known = {"kind": each.kind or "", "model": each.model or "", "fusion": each.fusion or ""}
    known |= {k: "" if (v := getattr(each, k)) is None else plain_number(v) for k in RANGES}
    known = {k: v for k, v in known.items() if v or k in ("kind", "model")}
    SubElement(block, "perception_entropy", known)
    if kind is None:
        return
    sensor = SubElement(block, "sensor", {"name": each.name, "type": kind})
    if each.picture is not None and each.picture.size is not None:
        camera = SubElement(sensor, CAMERA)
        write_picture(camera, each.picture, each.picture.size)
        write_clip(camera, each.min_range, each.max_range)
    elif each.scan is not None:
        write_scan(SubElement(sensor, LIDAR), each.scan)


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the sensors of a robot, in the frame of its root.

    Sensors are the links that Gazebo's sensors refer to. Where there are none: links with an
    optical frame, and those that nothing hangs on and that have no body.

    Raises
    ------
    InputError
        When it is no URDF, has no root or two, goes in a circle, or has no sensor.
    """
    robot = parse_xml(str(path), read_bytes(path))
    if robot.tag != "robot":
        raise InputError(path, "file", "URDF, a <robot>", f"<{robot.tag}>")
    poses = _poses(path, robot)
    told = {each.get("reference", ""): each for each in robot.iter("gazebo") if _is_sensor(each)}
    names = [name for name in poses if name in told] or list(_bodiless(robot, poses))
    if not names:
        raise InputError(path, "link", "links of sensors", "none")
    return tuple(_sensor(path, name, poses, told.get(name)) for name in names)


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
        kind = next((k for word, k in KIND_WORDS.items() if word in words), kind)
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

"""URDF: links and fixed joints, an optical frame for each camera (REP 103).

Intrinsics stand in Gazebo's sensor elements, as far as these can say them; the model's name beside
them, where readers of URDF pass over what they do not know.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..errors import InputError, shown
from ..scene.geometry import Pose
from ..text.files import read_bytes
from ..text.xml_text import parse_xml
from .carried import CAMERA, LIDAR, CarriedSensor, Scan, uneven
from .files import Written, pose_from, spaced
from .frame_names import with_legal_frames
from .frames import OPTICAL_RPY, composed
from .gazebo_camera import numbers_in, picture_in, write_picture

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
    known = {"kind": each.kind or "", "model": each.model or ""}
    SubElement(block, "perception_entropy", known)
    if kind is None:
        return
    sensor = SubElement(block, "sensor", {"name": each.name, "type": kind})
    if each.picture is not None and each.picture.size is not None:
        write_picture(SubElement(sensor, CAMERA), each.picture, each.picture.size)
    elif each.scan is not None:
        _lidar(SubElement(sensor, LIDAR), each.scan)


def _lidar(element: Element, scan: Scan) -> None:
    block = SubElement(element, "scan")
    ranges = (
        ("horizontal", scan.azimuths, *scan.fov),
        ("vertical", scan.channels, scan.low, scan.high),
    )
    for name, samples, least, most in ranges:
        part = SubElement(block, name)
        for key, value in (("samples", samples), ("min_angle", least), ("max_angle", most)):
            SubElement(part, key).text = repr(value)
    SubElement(SubElement(element, "range"), "max").text = repr(scan.max_range)


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
    return tuple(_sensor(name, poses, told.get(name)) for name in names)


def _is_sensor(block: Element) -> bool:
    return block.find("sensor") is not None or block.find("perception_entropy") is not None


def _poses(path: Path, robot: Element) -> dict[str, Pose]:
    """Return where links are, by name, from the root outward."""
    links = [link.get("name", "") for link in robot.iter("link")]
    joints = {}
    for joint in robot.findall("joint"):
        child, parent = (_end(path, joint, end, links) for end in ("child", "parent"))
        if child in joints:
            raise InputError(path, f"link {child}", "one parent", "two")
        joints[child] = parent, _origin(path, joint)
    roots = [name for name in links if name not in joints]
    if len(roots) != 1:
        found = "none: joints go in a circle" if not roots else ", ".join(roots)
        raise InputError(path, "link", "one root", found)
    poses = {roots[0]: Pose((0.0, 0.0, 0.0))}
    left = dict(joints)
    while left:
        ready = [child for child, (parent, _) in left.items() if parent in poses]
        if not ready:
            raise InputError(path, f"link {next(iter(left))}", "a way to the root", "a circle")
        for child in ready:
            parent, origin = left.pop(child)
            poses[child] = composed(poses[parent], origin)
    return poses


def _end(path: Path, joint: Element, end: str, links: list[str]) -> str:
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
    numbers = []
    for key in ("xyz", "rpy"):
        try:
            numbers.append([float(word) for word in values.get(key, "0 0 0").split()])
        except ValueError:
            raise InputError(path, f"{field}, {key}", "three numbers", shown(values[key])) from None
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


def _sensor(name: str, poses: dict[str, Pose], block: Element | None) -> CarriedSensor:
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
    figures = (picture_in(sensor), _scan(sensor))
    return CarriedSensor(name, poses[name], kind, model or None, *figures)


def _scan(sensor: Element | None) -> Scan | None:
    keys = ("samples", "min_angle", "max_angle")
    across, up = ([f"{way}/{key}" for key in keys] for way in ("horizontal", "vertical"))
    numbers = numbers_in(sensor, (*across, *up, "range/max"))
    if numbers is None:
        return None
    azimuths, left, right, channels, low, high, max_range = numbers
    return Scan(int(channels), low, high, int(azimuths), (left, right), max_range)

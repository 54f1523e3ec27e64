"""URDF, read: links, joints and Gazebo's sensors; an SDF is handed on."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element

from pe_core.base.errors import InputError, plural, shown
from pe_core.base.files import decode_text, read_bytes
from pe_core.geometry.poses import Pose
from pe_tools.formats.xml_text import parse_xml, without_comments

from . import foreign_values as values
from . import frames
from .gazebo_sensors import OWN, LinkBlock, LinkEntry, read_sensors
from .portable import ForeignRig, PortableSensor
from .robot_links import LinkTree, SensorLink, has_mass, sensor_links, unread_lines
from .sdf import read_sdf

XACRO = re.compile(r"<xacro:|\$\{|\$\((find|arg|eval|env|optenv|dirname|anon)\b")
"""What only a file of xacro has."""
ON_GROUND = "base_footprint"  # The link on the ground under a robot (REP 120)
HEAD = re.compile(r"(?:\s*(?:<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>]*>))*\s*", re.DOTALL)
DECLARATION = re.compile(r"\s*<\?xml.*?\?>\s*", re.DOTALL)
"""What is before the root of a document, and its first part."""


@dataclass(frozen=True, slots=True)
class Robot:
    """The content of a URDF: the `head` before its root, without the XML declaration, the root, the
    parents and poses of links (`hung`), the poses of all links in the root link (`poses`), and the
    link that is the origin."""

    head: str
    root: Element
    hung: Mapping[str, tuple[str, Pose]]
    poses: Mapping[str, Pose]
    origin: str


def read(path: Path) -> ForeignRig:
    """Read the sensors of a robot, in the frame of its root, with messages on links that are left
    out, or taken without a name that says so. Sensors are Gazebo's. If there are none, names,
    joints and masses of links decide: see `robot_links`."""
    root, head = _description(path)
    if root.tag == "sdf":
        return ForeignRig(*read_sdf(path, root))
    hung, in_root = _poses(path, root)
    origin = ON_GROUND if ON_GROUND in in_root else next(iter(in_root))
    poses = {name: frames.seen_from(in_root[origin], pose) for name, pose in in_root.items()}
    blocks = sensor_blocks(root)
    tree = _tree(root, in_root)
    lines: list[str] = []
    if any(name in blocks for name in poses):
        at_links = [LinkBlock(name, poses[name], blocks[name]) for name in poses if name in blocks]
        sensors = [sensor for at in at_links for sensor in read_sensors(path, at, poses)]
        if next(root.iter(OWN), None) is None:
            lines = unread_lines(tree, blocks)
    else:
        links, lines = sensor_links(tree)
        sensors = [_sensor_of_link(link, poses) for link in links]
    if not sensors:
        raise InputError(path, "link", "links of sensors", "none")
    if strays := [name for name in blocks if name not in poses]:
        count = plural(sum(len(blocks[name]) for name in strays), "Gazebo element")
        listed = ", ".join(map(shown, strays))
        lines = [*lines, f"left out, {count} on links that the robot does not have: {listed}"]
    line = _origin_line(root, in_root, origin)
    noted = [replace(s, told="; ".join(filter(None, [s.told, line]))) for s in sensors]
    return ForeignRig(tuple(noted), lines, Robot(head, root, hung, in_root, origin=origin))


def sensor_blocks(robot: Element) -> dict[str, list[Element]]:
    """Return Gazebo's elements with sensors by their link."""
    blocks: dict[str, list[Element]] = {}
    for block in robot.findall("gazebo"):
        if any(block.find(tag) is not None for tag in ("sensor", OWN)):
            blocks.setdefault(block.get("reference", ""), []).append(block)
    return blocks


def _origin_line(robot: Element, in_root: Mapping[str, Pose], origin: str) -> str:
    """Return the message on the origin; empty for a robot of this program."""
    place = f"the robot's root, {next(iter(in_root))}"
    under = "on the ground under"
    if origin == ON_GROUND:
        place = f"{ON_GROUND}, which is on the ground"
        under = "under"
    middle = "the middle of the vehicle, --at says where it is"
    is_ours = next(robot.iter(OWN), None) is not None
    return "" if is_ours else f"taken in {place}; if that is not {under} {middle}"


def _tree(robot: Element, in_root: Mapping[str, Pose]) -> LinkTree:
    joints = robot.findall("joint")
    parents = {}
    moving = set()
    for joint in joints:
        parent, child = (joint.find(end) for end in ("parent", "child"))
        if parent is None or child is None:  # `_poses` has refused it
            continue
        parents[child.get("link", "")] = parent.get("link", "")
        if joint.get("type", "fixed") != "fixed":
            moving.add(child.get("link", ""))
    heavy = {link.get("name", "") for link in robot.findall("link") if has_mass(link)}
    return LinkTree(tuple(in_root), parents, frozenset(moving), frozenset(heavy))


def _sensor_of_link(link: SensorLink, poses: Mapping[str, Pose]) -> PortableSensor:
    sensor = PortableSensor(link.name, poses[link.frame], link.kind)
    if link.optical is not None and link.optical != link.frame:
        sensor = frames.as_camera(sensor, poses[link.optical])
    else:
        sensor = frames.with_body_axes(sensor, link.frame)
    return replace(sensor, entry=LinkEntry(link.frame, sensor.pose))


def _description(path: Path) -> tuple[Element, str]:
    """Return the root of a URDF or an SDF, and the text before it without the XML declaration. A
    file of xacro is not one yet."""
    data = read_bytes(path)
    text = decode_text(data)
    if XACRO.search(without_comments(text)):
        expected = f"URDF, as `xacro {path.name}` writes it to a file"
        raise InputError(path, "file", expected, "xacro, whose macros are not expanded")
    root = parse_xml(str(path), data, comments=True)
    if root.tag not in ("robot", "sdf"):
        raise InputError(path, "file", "URDF, a <robot>, or SDF", f"<{root.tag}>")
    head = HEAD.match(text)
    return root, "" if head is None else DECLARATION.sub("", head[0])


def _poses(path: Path, robot: Element) -> tuple[dict[str, tuple[str, Pose]], dict[str, Pose]]:
    """Return the parents of links and the poses in these, and the poses of links in the root frame,
    ordered by depth; both by name."""
    links = dict.fromkeys(link.get("name", "") for link in robot.findall("link"))
    values.require_at_most(path, "link", len(links), values.MAX_FRAMES, noun="links")
    joints = {}
    for joint in robot.findall("joint"):  # movable joints are at zero
        child, parent = (_end(path, joint, end, links) for end in ("child", "parent"))
        if child in joints:
            raise InputError(path, f"link {child}", "one parent", "two")
        origin = joint.find("origin")
        field = f"joint {joint.get('name', '')!r}"
        texts = {} if origin is None else origin.attrib
        position, rpy = (
            values.figures(path, f"{field}, {key}", texts.get(key, "0 0 0"), 3)
            for key in ("xyz", "rpy")
        )
        joints[child] = parent, values.pose_from(path, field, position, rpy)
    return joints, frames.poses_from_root(path, joints, links, "link")


def _end(path: Path, joint: Element, end: str, links: Collection[str]) -> str:
    element = joint.find(end)
    name = "" if element is None else element.get("link", "")
    if name not in links:
        field = f"joint {joint.get('name', '')!r}, {end}"
        raise InputError(path, field, "the name of a link", shown(name))
    return name

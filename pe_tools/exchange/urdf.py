"""URDF: links and fixed joints, an optical frame for each camera (REP 103). Intrinsics are in
Gazebo's sensor elements, as far as these can express them. The model name is in an element beside
them, which other readers of URDF ignore."""

import re
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from pe_core.base.errors import InputError, plural, shown
from pe_core.base.files import decode_text, read_bytes
from pe_core.geometry.poses import Pose
from pe_tools.formats.xml_text import parse_xml

from . import foreign_values as values
from . import frames
from .foreign_values import Export, FileTexts, spaced
from .gazebo import write_clip, write_picture, write_scan
from .gazebo_sensors import OWN, RANGES, LinkBlock, read_sensors
from .passthrough import entry_row
from .portable import PortableRig, PortableSensor, uneven
from .portable_kinds import CAMERA, LIDAR
from .robot_links import LinkTree, SensorLink, has_mass, sensor_links, unread_lines
from .ros import without_comments
from .sdf import read_sdf

FILE, ROOT, NAME = "rig.urdf", "base_link", "rig"
XACRO = re.compile(r"<xacro:|\$\{|\$\((find|arg|eval|env|optenv|dirname|anon)\b")
"""What only a file of xacro has."""
ON_GROUND = "base_footprint"  # The link on the ground under a robot (REP 120)
MASSES = (
    "Links have a mass and joints are preserved, so that Gazebo keeps each sensor's frame; gravity "
    "does not move them. "
)
GAZEBO_KINDS = {CAMERA: CAMERA, LIDAR: "gpu_lidar"}
INERTIA_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
MASS_KG, INERTIA = 0.01, 1e-5
"""Of every link [kg, kg m2]: Gazebo has none without (sdformat's issue 199), nor below 1e-5 kg."""


def write(sensors: PortableRig, texts: FileTexts) -> Export:
    """Return a robot that consists of the rig alone, and messages on losses. Its name and its root
    link are those of an imported one, if there is one."""
    name, root = NAME, ROOT
    if texts:
        imported = parse_xml("passthrough", texts.get(FILE, "").encode())
        link = imported.find("link")
        root = ROOT if link is None else link.get("name", ROOT)
        name = imported.get("name", NAME)
    robot = Element("robot", {"name": name})
    _link(robot, root)
    linked, lines = frames.linked(sensors, root)
    for sensor, links in linked:
        for link_and_pose in links:
            _joint(robot, *link_and_pose)
        if not sensor.is_left_out:
            _gazebo(robot, sensor)
            continue
        for block in entry_row(sensor, lambda _: {}, (), ()).get("gazebo", ()):  # as imported
            robot.append(parse_xml("passthrough", str(block).encode()))
    indent(robot)
    comment = f"{root}{frames.origin_text(texts)}{frames.AXES}{MASSES}"
    text = f'<?xml version="1.0"?>\n<!-- {comment}-->\n{tostring(robot, "unicode")}\n'
    return {FILE: text.encode()}, lines + uneven((sensor for sensor, _ in linked), "Gazebo")


def source(path: Path) -> dict[str, str]:
    """Return a robot of the same name with only the origin link, for `write`."""
    root = _description(path)
    name = root.get("name", NAME) if root.tag == "robot" else NAME
    skeleton = Element("robot", {"name": name})
    link = ROOT if root.tag == "sdf" else _origin_of(_poses(path, root))
    SubElement(skeleton, "link", {"name": link})
    return {FILE: tostring(skeleton, "unicode")}


def _link(robot: Element, name: str) -> None:
    """Add a link with a mass, which Gazebo requires, and without gravity."""
    inertial = SubElement(SubElement(robot, "link", {"name": name}), "inertial")
    SubElement(inertial, "mass", {"value": repr(MASS_KG)})
    moments = {key: repr(INERTIA if key[1] == key[2] else 0.0) for key in INERTIA_KEYS}
    SubElement(inertial, "inertia", moments)
    block = SubElement(robot, "gazebo", {"reference": name})
    SubElement(block, "turnGravityOff").text = "true"


def _joint(robot: Element, parent: str, child: str, pose: Pose) -> None:
    """Add a link on a fixed joint that Gazebo must not merge into the parent."""
    _link(robot, child)
    name = f"{child}_joint"
    joint = SubElement(robot, "joint", {"name": name, "type": "fixed"})
    SubElement(joint, "parent", {"link": parent})
    SubElement(joint, "child", {"link": child})
    SubElement(joint, "origin", {"xyz": spaced(pose.position), "rpy": spaced(pose.rpy)})
    block = SubElement(robot, "gazebo", {"reference": name})
    SubElement(block, "preserveFixedJoint").text = "true"


def _gazebo(robot: Element, sensor: PortableSensor) -> None:
    block = SubElement(robot, "gazebo", {"reference": sensor.name})
    kind = GAZEBO_KINDS.get(sensor.kind or "")
    ranges = {key: getattr(sensor, key) for key in RANGES}
    optional = {
        "fusion": sensor.fusion,
        **{k: None if v is None else values.plain_number(v) for k, v in ranges.items()},
        "parameters": sensor.parameters,
    }
    attributes = {"kind": sensor.kind or "", "model": sensor.known_model or ""}
    attributes |= {key: text for key, text in optional.items() if text}
    SubElement(block, OWN, attributes)
    if kind is None or (sensor.picture is None and sensor.scan is None):
        return
    element = SubElement(block, "sensor", {"name": sensor.name, "type": kind})
    if sensor.picture is not None and sensor.picture.size is not None:
        camera = SubElement(element, CAMERA)
        write_picture(camera, sensor.picture, sensor.picture.size)
        write_clip(camera, sensor.min_range, sensor.max_range)
    elif sensor.scan is not None:
        write_scan(SubElement(element, LIDAR), sensor.scan)


def read(path: Path) -> PortableRig:
    """Read the sensors of a robot, in the frame of its root. Sensors are Gazebo's. If there are
    none, names, joints and masses of links decide: see `robot_links`."""
    return _read(path)[0]


def remarks(path: Path) -> list[str]:
    """Return messages on links that are left out, or taken without a name that says so."""
    return _read(path)[1]


def _read(path: Path) -> tuple[PortableRig, list[str]]:
    root = _description(path)
    if root.tag == "sdf":
        return read_sdf(path, root)
    in_root = _poses(path, root)
    origin = _origin_of(in_root)
    poses = {name: frames.seen_from(in_root[origin], pose) for name, pose in in_root.items()}
    blocks = _sensor_blocks(root)
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
    return tuple(noted), lines


def _sensor_blocks(robot: Element) -> dict[str, list[Element]]:
    """Return Gazebo's elements with sensors by their link."""
    blocks: dict[str, list[Element]] = {}
    for block in robot.findall("gazebo"):
        if any(block.find(tag) is not None for tag in ("sensor", OWN)):
            blocks.setdefault(block.get("reference", ""), []).append(block)
    return blocks


def _origin_line(robot: Element, in_root: Mapping[str, Pose], origin: str) -> str:
    """Return the message on the origin; empty for a robot of this program."""
    place, under = f"the robot's root, {next(iter(in_root))}", "on the ground under"
    if origin == ON_GROUND:
        place, under = f"{ON_GROUND}, which is on the ground", "under"
    middle = "the middle of the vehicle, --at says where it is"
    is_ours = next(robot.iter(OWN), None) is not None
    return "" if is_ours else f"taken in {place}; if that is not {under} {middle}"


def _tree(robot: Element, in_root: Mapping[str, Pose]) -> LinkTree:
    joints = robot.findall("joint")
    parents, moving = {}, set()
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
        return frames.as_camera(sensor, poses[link.optical])
    return frames.with_body_axes(sensor, link.frame)


def _description(path: Path) -> Element:
    """Return the root of a URDF or an SDF. A file of xacro is not one yet."""
    data = read_bytes(path)
    if XACRO.search(without_comments(decode_text(data))):
        expected = f"URDF, as `xacro {path.name}` writes it to a file"
        raise InputError(path, "file", expected, "xacro, whose macros are not expanded")
    root = parse_xml(str(path), data)
    if root.tag not in ("robot", "sdf"):
        raise InputError(path, "file", "URDF, a <robot>, or SDF", f"<{root.tag}>")
    return root


def _origin_of(poses: dict[str, Pose]) -> str:
    """Return the origin link: the link on the ground (REP 120), or else the root."""
    return ON_GROUND if ON_GROUND in poses else next(iter(poses))


def _poses(path: Path, robot: Element) -> dict[str, Pose]:
    """Return the poses of links in the root frame, by name, ordered by depth."""
    links = dict.fromkeys(link.get("name", "") for link in robot.findall("link"))
    values.require_at_most(path, "link", len(links), values.MAX_FRAMES, "links")
    joints = {}
    for joint in robot.findall("joint"):  # movable joints are at zero
        child, parent = (_end(path, joint, end, links) for end in ("child", "parent"))
        if child in joints:
            raise InputError(path, f"link {child}", "one parent", "two")
        origin, field = joint.find("origin"), f"joint {joint.get('name', '')!r}"
        texts = {} if origin is None else origin.attrib
        numbers = [
            values.figures(path, f"{field}, {key}", texts.get(key, "0 0 0"), 3)
            for key in ("xyz", "rpy")
        ]
        joints[child] = parent, values.pose_from(path, field, *numbers)
    return frames.poses_from_root(path, joints, links, "link")


def _end(path: Path, joint: Element, end: str, links: Collection[str]) -> str:
    element = joint.find(end)
    name = "" if element is None else element.get("link", "")
    if name not in links:
        field = f"joint {joint.get('name', '')!r}, {end}"
        raise InputError(path, field, "the name of a link", shown(name))
    return name

"""URDF: links and fixed joints, an optical frame for each camera (REP 103). Intrinsics are in
Gazebo's sensor elements, as far as these can express them. The model name is in an element beside
them, which other readers of URDF ignore."""

from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from pe_core.base.errors import InputError, shown
from pe_core.base.files import read_bytes
from pe_core.geometry.poses import Pose
from pe_tools.formats.xml_text import parse_xml

from . import foreign_values as values
from . import frames
from .foreign_values import Export, Figures, FileTexts, spaced
from .frames import OPTICAL
from .gazebo import picture_in, scan_in, write_clip, write_picture, write_scan
from .passthrough import entry_row, pose_entry
from .portable import PortableRig, PortableSensor, uneven
from .portable_kinds import CAMERA, LIDAR, has_model

RANGES = {"min_range": values.MIN_RANGE, "max_range": values.FARTHEST}
FILE, ROOT, NAME = "rig.urdf", "base_link", "rig"
ON_GROUND = "base_footprint"  # The link on the ground under a robot (REP 120)
MASSES = (
    "Links have a mass and joints are preserved, so that Gazebo keeps each sensor's frame; gravity "
    "does not move them. "
)
GAZEBO_KINDS = {CAMERA: CAMERA, LIDAR: "gpu_lidar"}
KIND_BY_TEXT = {CAMERA: CAMERA, LIDAR: LIDAR, "ray": LIDAR, "depth": CAMERA}
"""What a word in a Gazebo sensor's type says of its kind."""
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
    robot = _robot(path)
    skeleton = Element("robot", {"name": robot.get("name", NAME)})
    SubElement(skeleton, "link", {"name": _origin_of(_poses(path, robot))})
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
    SubElement(block, "perception_entropy", attributes)
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
    """Read the sensors of a robot, in the frame of its root. Sensors are the links with a Gazebo
    sensor. If there are none, they are the links with an optical frame, and the links without
    children and without a mass."""
    robot = _robot(path)
    in_root = _poses(path, robot)
    blocks = {
        block.get("reference", ""): block
        for block in robot.iter("gazebo")
        if any(block.find(tag) is not None for tag in ("sensor", "perception_entropy"))
    }
    names = [name for name in in_root if name in blocks] or list(_bodiless(robot, in_root))
    if not names:
        raise InputError(path, "link", "links of sensors", "none")
    origin = _origin_of(in_root)
    poses = {name: frames.seen_from(in_root[origin], pose) for name, pose in in_root.items()}
    is_ours = next(robot.iter("perception_entropy"), None) is not None
    result = []
    place, under = f"the robot's root, {next(iter(in_root))}", "on the ground under"
    if origin == ON_GROUND:
        place, under = f"{ON_GROUND}, which is on the ground", "under"
    middle = "the middle of the vehicle, --at says where it is"
    line = "" if is_ours else f"taken in {place}; if that is not {under} {middle}"
    for name in names:
        sensor, entry = _sensor(path, name, poses, blocks.get(name)), ""
        if sensor.kind is not None and not has_model(sensor):  # of unknown kind
            own = [b for b in robot.iter("gazebo") if b.get("reference") == name]
            texts = [tostring(block, "unicode").strip() for block in own]
            entry = pose_entry(sensor, gazebo=texts)
        result.append(replace(sensor, told=line, entry=entry))
    return tuple(result)


def _robot(path: Path) -> Element:
    robot = parse_xml(str(path), read_bytes(path))
    if robot.tag != "robot":
        raise InputError(path, "file", "URDF, a <robot>", f"<{robot.tag}>")
    return robot


def _origin_of(poses: dict[str, Pose]) -> str:
    """Return the origin link: the link on the ground (REP 120), or else the root."""
    return ON_GROUND if ON_GROUND in poses else next(iter(poses))


def _poses(path: Path, robot: Element) -> dict[str, Pose]:
    """Return the poses of links in the root frame, by name, ordered by depth."""
    links = dict.fromkeys(link.get("name", "") for link in robot.iter("link"))
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


def _bodiless(robot: Element, poses: dict[str, Pose]) -> Iterator[str]:
    """Yield the links that may be sensors, in a robot without Gazebo sensors."""
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


def _sensor(path: Path, name: str, poses: dict[str, Pose], block: Element | None) -> PortableSensor:
    kind = CAMERA if _optical_of(name, poses) else None
    if block is None:
        return PortableSensor(name, poses[name], kind)
    project_element, sensor = block.find("perception_entropy"), block.find("sensor")
    model = project_element.get("model") if project_element is not None else None
    if sensor is not None:
        type_name = sensor.get("type", "")
        kind = next((k for word, k in KIND_BY_TEXT.items() if word in type_name), type_name or kind)
    if project_element is not None:
        kind = project_element.get("kind") or kind

    def field(key: str) -> str:
        return f"sensor of {name}, {key}"

    inside = Figures(path, lambda k: None if sensor is None else sensor.findtext(f".//{k}"), field)
    fields: dict[str, Any] = {}
    if project_element is not None:
        known = Figures(path, project_element.get, field)
        fields = {key: known.number(key, rule) for key, rule in RANGES.items()}
        fields["parameters"] = project_element.get("parameters", "")
        fields["fusion"] = project_element.get("fusion") or None
    picture_and_scan = picture_in(inside), scan_in(inside)
    return PortableSensor(name, poses[name], kind, model or None, *picture_and_scan, **fields)

"""URDF, written: links and fixed joints, an optical frame for each camera (REP 103). Intrinsics are
in Gazebo's sensor elements, as far as these can express them. The model name is in an element
beside them, which other readers of URDF ignore. A robot that is there keeps all that is not about
the rig's sensors."""

from collections.abc import Iterable, Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from pe_core.base.errors import InputError
from pe_core.geometry.poses import Pose

from . import foreign_values as values
from . import frames
from .foreign_values import Export, spaced
from .gazebo import write_clip, write_picture, write_scan
from .gazebo_sensors import OWN, RANGES, LinkEntry
from .merging import gone_lines, is_same_pose
from .portable import MergeTarget, PortableRig, PortableSensor, uneven
from .portable_kinds import CAMERA, LIDAR
from .urdf import Robot, sensor_blocks

FILE = "rig.urdf"
ROOT = "base_link"
NAME = "rig"
MASSES = (
    "Links have a mass and joints are preserved, so that Gazebo keeps each sensor's frame; gravity "
    "does not move them. "
)
GAZEBO_KINDS = {CAMERA: CAMERA, LIDAR: "gpu_lidar"}
FIGURES = {
    CAMERA: ("horizontal_fov", "image", "lens", "distortion", "clip"),
    LIDAR: ("scan", "range"),
}
"""Elements of a camera or a LiDAR in a Gazebo sensor that describe the model, by kind."""
HOLDERS = {CAMERA: (CAMERA,), LIDAR: (LIDAR, "ray")}  # Elements of a sensor that hold these
SENSOR_LEVEL = 2  # Depth of a sensor in a robot: it is in an element of Gazebo
INERTIA_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
MASS_KG = 0.01
INERTIA = 1e-5
"""Of every link [kg, kg m2]: Gazebo has none without (sdformat's issue 199), nor below 1e-5 kg."""


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return a robot that consists of the rig alone, or a robot with its sensors updated, and
    messages on losses."""
    robot = Element("robot", {"name": NAME})
    origin = ROOT
    taken = []
    head = f"<!-- {ROOT}{frames.AXES}{MASSES}-->\n"
    lines = []
    if into is None:
        _link(robot, origin)
    elif isinstance(into.document, Robot):
        document = into.document
        robot = document.root
        head = document.head
        origin = document.origin
        taken = list(document.poses)
        lines = _update(document, sensors, into.gone)
    else:
        raise InputError("into", "file", "a URDF, a <robot>", "an SDF, which is only read")
    before = len(robot)
    linked, name_lines = frames.linked(sensors, origin, taken)
    for sensor, links in linked:
        if sensor.entry is None:
            for parent, child, pose in links:
                _joint(robot, parent, child, pose)
            _gazebo(robot, sensor)
    if into is None:
        indent(robot)
    else:
        _indent_from(robot, before)
    text = f'<?xml version="1.0"?>\n{head}{tostring(robot, "unicode").rstrip()}\n'
    gazebo_lines = uneven((sensor for sensor, _ in linked), "Gazebo")
    return {FILE: text.encode()}, [*lines, *name_lines, *gazebo_lines]


def _indent_from(parent: Element, first: int, level: int = 0) -> None:
    """Indent the children of an element, which is `level` deep, from number `first` on."""
    outer = "\n" + "  " * level
    inner = f"{outer}  "
    if first == len(parent):
        return
    for element in parent[first:]:
        indent(element, level=level + 1)
        element.tail = inner
    if first:
        parent[first - 1].tail = inner
    else:
        parent.text = inner
    parent[-1].tail = outer


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
    _set_origin(joint, pose)
    block = SubElement(robot, "gazebo", {"reference": name})
    SubElement(block, "preserveFixedJoint").text = "true"


def _set_origin(joint: Element, pose: Pose) -> None:
    """Set the pose of a joint's child in the parent."""
    origin = joint.find("origin")
    origin = SubElement(joint, "origin") if origin is None else origin
    origin.attrib.update({"xyz": spaced(pose.position), "rpy": spaced(pose.rpy)})


def _gazebo(robot: Element, sensor: PortableSensor, link: str = "") -> None:
    """Add the elements of a sensor on its link, by default that of its name."""
    block = SubElement(robot, "gazebo", {"reference": link or sensor.name})
    SubElement(block, OWN, _own_attributes(sensor))
    if sensor.kind in GAZEBO_KINDS and (sensor.picture is not None or sensor.scan is not None):
        kind = GAZEBO_KINDS[sensor.kind]
        element = SubElement(block, "sensor", {"name": sensor.name, "type": kind})
        _write_figures(SubElement(element, sensor.kind), sensor)


def _own_attributes(sensor: PortableSensor) -> dict[str, str]:
    ranges = {key: getattr(sensor, key) for key in RANGES}
    optional = {
        "fusion": sensor.fusion,
        **{k: None if v is None else values.plain_number(v) for k, v in ranges.items()},
        "parameters": sensor.parameters,
    }
    attributes = {"kind": sensor.kind or "", "model": sensor.known_model or ""}
    return attributes | {key: text for key, text in optional.items() if text}


def _write_figures(holder: Element, sensor: PortableSensor) -> None:
    """Write a sensor's intrinsics or scan into a ``<camera>`` or ``<lidar>`` element."""
    if sensor.picture is not None and sensor.picture.size is not None:
        write_picture(holder, sensor.picture, sensor.picture.size)
        write_clip(holder, sensor.min_range, sensor.max_range)
    elif sensor.scan is not None:
        write_scan(holder, sensor.scan)


def _update(robot: Robot, sensors: PortableRig, gone: PortableRig) -> list[str]:
    """Change a robot's sensors to those of the rig with entries; return messages."""
    wanted = {}
    for sensor in sensors:
        entry: LinkEntry | None = sensor.entry
        if entry is not None and entry.element is None:
            origin = robot.poses[robot.origin]
            frame = frames.seen_from(origin, robot.poses[entry.link])
            moved = frames.carried_along(sensor, entry.pose, frame)
            wanted[entry.link] = frames.composed(origin, moved)
    places, poses = frames.new_places(robot.hung, robot.poses, wanted)
    for joint in robot.root.findall("joint"):
        child = joint.find("child")
        link = "" if child is None else child.get("link", "")
        if link in places:
            _set_origin(joint, places[link])
    for sensor in sensors:
        if sensor.entry is not None:
            link_pose = frames.seen_from(robot.poses[robot.origin], poses[sensor.entry.link])
            _update_element(robot, sensor, link_pose)
    blocks = sensor_blocks(robot.root)
    links = []
    for sensor in gone:
        if sensor.entry.element is not None:
            _remove(robot.root, [sensor.entry.element])
            continue
        links.append(sensor.entry.link)
        for block in blocks.get(sensor.entry.link, ()):
            _remove(block, [*block.findall("sensor"), *block.findall(OWN)])
    return gone_lines(links)


def _update_element(robot: Robot, sensor: PortableSensor, link: Pose) -> None:
    """Change the Gazebo elements of a sensor: the pose, if it is its own, and the figures. `link`
    is the new pose of its link in the origin."""
    entry: LinkEntry = sensor.entry
    element = entry.element
    blocks = sensor_blocks(robot.root).get(entry.link, [])
    inside = frames.seen_from(frames.composed(link, entry.outer), sensor.pose)
    if element is not None and not is_same_pose(inside, entry.inside):
        _remove(element, [*element.findall("pose"), *element.findall(f"{CAMERA}/pose")])
        pose = Element("pose")
        pose.text = spaced((*inside.position, *inside.rpy))
        element.insert(0, pose)
    if sensor.is_unchanged:
        return
    if element is None:
        owns = [own for block in blocks for own in block.findall(OWN)]
        found = [each for block in blocks for each in block.findall("sensor")]
        element = found[0] if found else None
        if element is None:
            for block in blocks:
                _remove(block, owns)
            _gazebo(robot.root, sensor, entry.link)
            return
        for own in owns:
            own.attrib.clear()
            own.attrib.update(_own_attributes(sensor))
    _replace_figures(element, sensor)


def _replace_figures(element: Element, sensor: PortableSensor) -> None:
    """Replace the figures in a Gazebo sensor, or in one of its cameras."""
    kind = sensor.kind or ""
    if kind not in GAZEBO_KINDS:
        return
    holder = element
    if element.tag == "sensor":
        found = [h for tag in HOLDERS[kind] if (h := element.find(tag)) is not None]
        if not found:
            element.set("type", GAZEBO_KINDS[kind])
            found = [SubElement(element, kind)]
            _indent_from(element, len(element) - 1, SENSOR_LEVEL)
        holder = found[0]
    _remove(holder, [part for part in holder if part.tag in FIGURES[kind]])
    first = len(holder)
    _write_figures(holder, sensor)
    _indent_from(holder, first, SENSOR_LEVEL + 1)


def _remove(tree: Element, elements: Iterable[Element]) -> None:
    """Remove elements from a tree, wherever they are."""
    gone: Sequence[Element] = list(elements)
    for parent in list(tree.iter()):
        for child in list(parent):
            if any(child is each for each in gone):
                parent.remove(child)

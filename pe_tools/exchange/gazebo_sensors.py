"""Sensors of Gazebo, in a URDF or an SDF: their kinds, their poses, several of a link."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element

from pe_core.base.errors import InputError, one_of, shown
from pe_core.geometry.poses import Pose
from pe_tools.formats.xml_text import text_in

from . import foreign_values as values
from . import frames
from .foreign_values import ForeignNumbers
from .gazebo import picture_in, scan_in
from .portable import ORIGIN, PortableSensor
from .portable_kinds import CAMERA, LIDAR
from .sensor_names import FRAME_NAMES

RANGES = ("min_range", "max_range")  # Attributes of the ranges in the own element
TAG = CAMERA  # Tag of a camera in a sensor
OWN = "perception_entropy"  # Tag of the element that an export adds
KIND_BY_TYPE = {
    **dict.fromkeys((LIDAR, "gpu_lidar", "ray", "gpu_ray"), LIDAR),
    **dict.fromkeys((CAMERA, "multicamera", "wideanglecamera", "wide_angle_camera"), CAMERA),
    **dict.fromkeys(("depth", "depth_camera", "rgbd", "rgbd_camera"), CAMERA),
    **dict.fromkeys(("thermal", "thermal_camera", "stereo"), CAMERA),
}
"""Kinds by the type of a Gazebo sensor. Others are left out: a segmentation, bounding box or
logical camera returns ground truth, not a measurement."""
UNTELLING = frozenset({"link", *FRAME_NAMES})
"""Names of links that do not tell what sensor is on them."""
ROTATIONS = ("euler_rpy", "quat_xyzw")


@dataclass(frozen=True, slots=True)
class LinkBlock:
    """The Gazebo sensors of a link: `link`, its name; `pose`, its pose; `blocks`, the elements that
    contain the sensors."""

    link: str
    pose: Pose
    blocks: Sequence[Element]


@dataclass(frozen=True, slots=True)
class LinkEntry:
    """Where a robot's file has a sensor: its link, and its pose there. If it is one of several of
    the link, `element` has its own pose, `inside` the pose `outer` on the link."""

    link: str
    pose: Pose
    element: Element | None = None
    outer: Pose = ORIGIN
    inside: Pose = ORIGIN


def sensor_elements(blocks: Iterable[Element]) -> list[tuple[Element, Element]]:
    """Return the sensors of blocks, each with its element: of a sensor with several cameras, which
    is one for each, the camera."""
    result = []
    for sensor in (each for block in blocks for each in block.findall("sensor")):
        cameras = sensor.findall(TAG)
        if len(cameras) < 2:
            result.append((sensor, sensor))
            continue
        for camera in cameras:
            name = f"{sensor.get('name', '')}_{camera.get('name', '')}".strip("_")
            single = Element("sensor", {**sensor.attrib, "name": name})
            single.extend(sensor.findall("pose"))
            single.append(camera)
            result.append((single, camera))
    return result


def read_sensors(path: Path, at: LinkBlock, poses: Mapping[str, Pose]) -> list[PortableSensor]:
    """Return the sensors of a link. A single one has the name of its link, if that is not one that
    any link may have; several have their own.
    `poses` are those of all frames that a pose can be relative to."""
    elements = sensor_elements(at.blocks)
    if len(elements) > 1:
        sensors = []
        for single, element in elements:
            name = single.get("name") or at.link
            sensor = _sensor(path, name, at=at, element=single, poses=poses)
            outer = ORIGIN
            if element is not single:
                outer = pose_in(path, _field(name)("pose"), single.find("pose"))
            inside = frames.seen_from(frames.composed(at.pose, outer), sensor.pose)
            entry = LinkEntry(at.link, sensor.pose, element, outer, inside=inside)
            sensors.append(replace(sensor, entry=entry))
        return sensors
    only = elements[0][0] if elements else None
    name = at.link
    if only is not None and at.link in UNTELLING:
        name = only.get("name") or at.link
    sensor = _sensor(path, name, at=at, element=only, poses=poses)
    sensor = replace(sensor, entry=LinkEntry(at.link, sensor.pose))
    own = next((e for block in at.blocks if (e := block.find(OWN)) is not None), None)
    return [sensor if own is None else _with_own(path, sensor, own)]


def _sensor(
    path: Path, name: str, *, at: LinkBlock, element: Element | None, poses: Mapping[str, Pose]
) -> PortableSensor:
    """Return the sensor of an element."""
    if element is None:
        return PortableSensor(name, at.pose)
    type_name = element.get("type", "")
    kind = KIND_BY_TYPE.get(type_name, type_name or None)
    pose = _pose_of(path, _field(name)("pose"), at.pose, element, poses=poses)
    figures = ForeignNumbers(path, lambda key: text_in(element.find(f".//{key}")), _field(name))
    picture = picture_in(figures)
    return PortableSensor(name, pose, kind, picture=picture, scan=scan_in(figures))


def _field(name: str) -> Callable[[str], str]:
    return lambda key: f"sensor of {name}, {key}"


def _with_own(path: Path, sensor: PortableSensor, own: Element) -> PortableSensor:
    """Return a sensor with what an export of this program adds."""
    known = ForeignNumbers(path, own.get, _field(sensor.name))
    return replace(
        sensor,
        kind=own.get("kind") or sensor.kind,
        model=own.get("model") or None,
        parameters=own.get("parameters", ""),
        fusion=own.get("fusion") or None,
        min_range=known.number("min_range", values.MIN_RANGE),
        max_range=known.number("max_range", values.FARTHEST),
    )


def _pose_of(
    path: Path, field: str, link: Pose, element: Element, poses: Mapping[str, Pose]
) -> Pose:
    """Return the pose of a sensor: its own on its link, then that of its camera on it."""
    camera = element.find(TAG)
    pose = link
    for holder in (element, camera):
        inner = None if holder is None else holder.find("pose")
        if inner is None:
            continue
        relative = inner.get("relative_to", "")
        if relative and relative not in poses:
            raise InputError(path, field, one_of(poses, relative), shown(relative))
        pose = frames.composed(poses[relative] if relative else pose, pose_in(path, field, inner))
    return pose


def pose_in(path: Path, field: str, element: Element | None) -> Pose:
    """Return the pose in a ``<pose>`` element; the origin where it is missing or empty."""
    text = (text_in(element) or "").strip()
    if element is None or not text:
        return ORIGIN
    rotation = element.get("rotation_format", ROTATIONS[0])
    if rotation not in ROTATIONS:
        raise InputError(path, field, one_of(ROTATIONS, rotation), shown(rotation))
    if rotation == ROTATIONS[1]:
        numbers = values.figures(path, field, text, 7)
        x, y, z, w = numbers[3:]
        return frames.pose_of(frames.from_quaternion(path, field, (w, x, y, z)), numbers[:3])
    numbers = values.figures(path, field, text, 6)
    in_degrees = element.get("degrees", "").lower() in ("true", "1")
    return values.pose_from(path, field, numbers[:3], numbers[3:], degrees=in_degrees)

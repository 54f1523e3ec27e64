"""Sensors of Gazebo, in a URDF or an SDF: their kinds, their poses, several of a link."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, tostring

from pe_core.base.errors import InputError, one_of, shown
from pe_core.geometry.poses import Pose

from . import foreign_values as values
from . import frames
from .foreign_values import Figures
from .gazebo import picture_in, scan_in
from .passthrough import pose_entry
from .portable import ORIGIN, PortableSensor
from .portable_kinds import CAMERA, LIDAR, has_model

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
ROTATIONS = ("euler_rpy", "quat_xyzw")


@dataclass(frozen=True, slots=True)
class LinkBlock:
    """The Gazebo sensors of a link: `link`, its name; `pose`, its pose; `blocks`, the elements that
    contain the sensors."""

    link: str
    pose: Pose
    blocks: Sequence[Element]


def sensor_elements(blocks: Iterable[Element]) -> list[Element]:
    """Return the sensors of blocks; a sensor with several cameras is one for each."""
    result = []
    for sensor in (each for block in blocks for each in block.findall("sensor")):
        cameras = sensor.findall(TAG)
        if len(cameras) < 2:
            result.append(sensor)
            continue
        for camera in cameras:
            name = f"{sensor.get('name', '')}_{camera.get('name', '')}".strip("_")
            single = Element("sensor", {**sensor.attrib, "name": name})
            single.extend(sensor.findall("pose"))
            single.append(camera)
            result.append(single)
    return result


def read_sensors(path: Path, at: LinkBlock, poses: Mapping[str, Pose]) -> list[PortableSensor]:
    """Return the sensors of a link. A single one has the name of its link, several have their own.
    `poses` are those of all frames that a pose can be relative to."""
    elements = sensor_elements(at.blocks)
    if len(elements) > 1:
        named = [(element.get("name") or at.link, element) for element in elements]
        return [_sensor(path, name, at=at, element=e, poses=poses) for name, e in named]
    element = elements[0] if elements else None
    sensor = _sensor(path, at.link, at=at, element=element, poses=poses)
    own = next((e for block in at.blocks if (e := block.find(OWN)) is not None), None)
    return [sensor if own is None else _with_own(path, sensor, at, own)]


def _sensor(
    path: Path, name: str, *, at: LinkBlock, element: Element | None, poses: Mapping[str, Pose]
) -> PortableSensor:
    """Return the sensor of an element. One of a kind that is left out has its element as entry."""
    if element is None:
        return PortableSensor(name, at.pose)
    type_name = element.get("type", "")
    kind = KIND_BY_TYPE.get(type_name, type_name or None)
    pose = _pose_of(path, _field(name)("pose"), at.pose, element, poses)
    figures = Figures(path, lambda key: element.findtext(f".//{key}"), _field(name))
    picture = picture_in(figures)
    scan = scan_in(figures)
    sensor = PortableSensor(name, pose, kind, picture=picture, scan=scan)
    if kind is None or has_model(sensor):
        return sensor
    return replace(sensor, entry=pose_entry(sensor, gazebo=_kept(at, name, element)))


def _field(name: str) -> Callable[[str], str]:
    return lambda key: f"sensor of {name}, {key}"


def _with_own(path: Path, sensor: PortableSensor, at: LinkBlock, own: Element) -> PortableSensor:
    """Return a sensor with what an export of this program adds."""
    known = Figures(path, own.get, _field(sensor.name))
    full = replace(
        sensor,
        kind=own.get("kind") or sensor.kind,
        model=own.get("model") or None,
        parameters=own.get("parameters", ""),
        fusion=own.get("fusion") or None,
        min_range=known.number("min_range", values.MIN_RANGE),
        max_range=known.number("max_range", values.FARTHEST),
    )
    if full.kind is None or has_model(full):
        return replace(full, entry="")
    return replace(full, entry=pose_entry(full, gazebo=_texts(at.blocks)))


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
    text = "" if element is None else (element.text or "").strip()
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


def _kept(at: LinkBlock, name: str, element: Element) -> list[str]:
    """Return the blocks of a sensor that is left out, for an export: as they are, or only its own
    element, whose pose the exported link has."""
    in_blocks = all(block.tag == "gazebo" for block in at.blocks)
    if in_blocks and name == at.link and element.find("pose") is None:
        return _texts(at.blocks)
    block = Element("gazebo", {"reference": name})
    kept = SubElement(block, "sensor", element.attrib)
    kept.extend(child for child in element if child.tag != "pose")
    return [tostring(block, "unicode")]


def _texts(blocks: Iterable[Element]) -> list[str]:
    return [tostring(block, "unicode").strip() for block in blocks]

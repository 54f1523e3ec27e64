"""Sensors of Gazebo, in a URDF or an SDF: their kinds, their poses, several of a link."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
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

RANGES = {"min_range": values.MIN_RANGE, "max_range": values.FARTHEST}
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
    own = next((e for block in at.blocks if (e := block.find(OWN)) is not None), None)
    if not elements or len(elements) == 1:
        element = elements[0] if elements else None
        return [_sensor(path, at.link, at, poses, element, own)]
    return [
        _sensor(path, element.get("name") or at.link, at, poses, element, None)
        for element in elements
    ]


def _sensor(
    path: Path,
    name: str,
    at: LinkBlock,
    poses: Mapping[str, Pose],
    element: Element | None,
    own: Element | None,
) -> PortableSensor:
    def field(key: str) -> str:
        return f"sensor of {name}, {key}"

    kind = None
    pose = at.pose
    if element is not None:
        type_name = element.get("type", "")
        kind = KIND_BY_TYPE.get(type_name, type_name or None)
        pose = _pose_of(path, field("pose"), at.pose, element, poses)
    fields: dict[str, Any] = {}
    if own is not None:
        kind = own.get("kind") or kind
        known = Figures(path, own.get, field)
        fields = {key: known.number(key, rule) for key, rule in RANGES.items()}
        fields["parameters"] = own.get("parameters", "")
        fields["fusion"] = own.get("fusion") or None
        fields["model"] = own.get("model") or None
    inside = Figures(
        path, lambda k: None if element is None else element.findtext(f".//{k}"), field
    )
    fields["picture"] = picture_in(inside)
    fields["scan"] = scan_in(inside)
    sensor = PortableSensor(name, pose, kind, **fields)
    if kind is None or has_model(sensor):
        return sensor
    return replace(sensor, entry=pose_entry(sensor, gazebo=_kept(at, name, element)))


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


def _kept(at: LinkBlock, name: str, element: Element | None) -> list[str]:
    """Return the blocks of a sensor that is left out, for an export: as they are, or only its own
    element, whose pose the exported link has."""
    if element is None or (name == at.link and element.find("pose") is None):
        return [tostring(block, "unicode").strip() for block in at.blocks]
    block = Element("gazebo", {"reference": name})
    kept = SubElement(block, "sensor", element.attrib)
    kept.extend(child for child in element if child.tag != "pose")
    return [tostring(block, "unicode")]

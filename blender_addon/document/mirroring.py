"""Copies of sensors: mirror images, linked pairs that stay so, and duplicates made in Blender."""

import contextlib
import math
import re
from collections.abc import Sequence

import bpy
from bpy.types import Depsgraph, Object, Scene

from ..engine import pe
from .rig import place_poses, pose_of

SIDES = (("left", "right"), ("l", "r"))
MIDDLE_M = 1e-4
MIDDLE_RAD = 1e-5
"""A sensor this near to the vehicle's middle plane is its own mirror image."""

_last_poses: dict[tuple[str, str], pe.Pose] = {}
"""Last poses of linked sensors by scene and name: they tell which of a pair has moved."""
SENSORS = "Sensors"  # The collection of a scene's sensors


def mirrored_pose(pose: pe.Pose) -> pe.Pose:
    """Return the mirror image of a pose across the x-z plane."""
    x, y, z = pose.position
    roll, pitch, yaw = pose.rotation_deg
    return pe.Pose.from_degrees((x, 0.0 - y, z), (0.0 - roll, pitch, 0.0 - yaw))


def mirrored_name(name: str, side: str) -> str:
    """Return the name of a mirrored sensor on a `side`: front_left gives front_right, A.L A.R."""
    for pair in SIDES:
        for one, other in (pair, pair[::-1]):
            match = re.search(rf"(?:(?<=^)|(?<=[^A-Za-z]))({one})(?=[^A-Za-z]|$)", name, re.I)
            if match:
                return name[: match.start()] + _cased(other, match[0]) + name[match.end() :]
    return f"{name} {side}"


def in_the_middle(pose: pe.Pose) -> bool:
    """Whether a sensor is its own mirror image."""
    roll, _, yaw = (math.remainder(angle, 2.0 * math.pi) for angle in pose.rpy)
    level = abs(roll) < MIDDLE_RAD and min(abs(yaw), math.pi - abs(yaw)) < MIDDLE_RAD
    return abs(pose.position[1]) < MIDDLE_M and level


def link_mirror(one: Object, other: Object) -> None:
    """Link two sensors, so that they stay mirror images of each other."""
    one.perception_entropy.mirror_of = other.name
    other.perception_entropy.mirror_of = one.name


def unlink_mirror(obj: Object) -> None:
    """Remove the link between a sensor and its mirror image."""
    other = bpy.data.objects.get(obj.perception_entropy.mirror_of)
    obj.perception_entropy.mirror_of = ""
    if other is not None and other.perception_entropy.mirror_of == obj.name:
        other.perception_entropy.mirror_of = ""


def mirror_of(obj: Object, scene: Scene) -> Object | None:
    """Return the sensor that is linked as a sensor's mirror image; None without a link."""
    other = scene.objects.get(obj.perception_entropy.mirror_of)
    if other is None or other == obj or not other.perception_entropy.is_sensor:
        return None
    return other if other.perception_entropy.mirror_of == obj.name else None


def follow_mirrors(scene: Scene, depsgraph: Depsgraph, sensors: Sequence[Object]) -> list[str]:
    """Move linked sensors whose mirror image has moved. If both have moved and are no longer mirror
    images, the first by name leads. Links of duplicates and links to deleted sensors are removed;
    so are those of pairs, whose names are returned, that would be two in one place."""
    _repair_links(scene, sensors)
    moved: dict[str, pe.Pose] = {}
    released: list[str] = []
    current_poses: dict[tuple[str, str], pe.Pose] = {}
    for obj in sensors:
        other = mirror_of(obj, scene)
        if other is None or other.name < obj.name:
            continue
        with contextlib.suppress(pe.InputError):  # a scaled sensor has no pose
            poses = pose_of(obj, depsgraph), pose_of(other, depsgraph)
            if any(map(in_the_middle, poses)):
                unlink_mirror(obj)
                released += [obj.name, other.name]
                continue
            poses = _mirror_images(scene, (obj.name, other.name), poses, moved)
            current_poses |= {
                (scene.name, o.name): p for o, p in zip((obj, other), poses, strict=True)
            }
    if moved:
        with contextlib.suppress(pe.InputError):  # a constraint holds it
            place_poses(scene, moved)
    for key in [key for key in _last_poses if key[0] == scene.name]:
        del _last_poses[key]
    _last_poses.update(current_poses)
    return released


def clear_mirrors() -> None:
    """Clear the last poses when another file is opened."""
    _last_poses.clear()


def _mirror_images(
    scene: Scene, names: tuple[str, str], poses: tuple[pe.Pose, pe.Pose], moved: dict[str, pe.Pose]
) -> tuple[pe.Pose, pe.Pose]:
    """Return poses that are mirror images of each other; add the one to be moved to `moved`."""
    first, second = poses
    if mirrored_pose(first) == second:
        return poses
    still_first = _last_poses.get((scene.name, names[0])) == first
    if still_first and _last_poses.get((scene.name, names[1])) != second:
        moved[names[0]] = mirrored_pose(second)
        return moved[names[0]], second
    moved[names[1]] = mirrored_pose(first)
    return first, moved[names[1]]


def _repair_links(scene: Scene, sensors: Sequence[Object]) -> None:
    """Update links to a renamed sensor; remove links that are not mutual."""
    for obj in sensors:
        wanted = obj.perception_entropy.mirror_of
        if not wanted or mirror_of(obj, scene) is not None:
            continue
        other = scene.objects.get(wanted)
        if other is None:  # it was renamed: the sensor that is still linked to this one
            (other,) = _pointing_at(obj, sensors) or (None,)
        elif other.perception_entropy.mirror_of in scene.objects or _pointing_at(
            other, sensors
        ) != (obj,):
            other = None  # it is linked to another sensor: this one is a duplicate
        if other is None:
            obj.perception_entropy.mirror_of = ""
        else:
            link_mirror(obj, other)


def _pointing_at(obj: Object, sensors: Sequence[Object]) -> tuple[Object, ...]:
    """Return the only other sensor that links to a sensor, as a tuple; empty if there are more."""
    linked = [o for o in sensors if o.perception_entropy.mirror_of == obj.name and o != obj]
    return tuple(linked) if len(linked) == 1 else ()


def _cased(word: str, like: str) -> str:
    """Return a word in upper, title or lower case, as the word `like`."""
    if like.isupper():
        return word.upper()
    return word.capitalize() if like[0].isupper() else word


def is_copy(whose: str, obj: Object, sensors: Sequence[Object]) -> bool:
    """Whether what a sensor stores under the name `whose` belongs to another sensor."""
    return whose not in ("", obj.name) and any(other.name == whose for other in sensors)

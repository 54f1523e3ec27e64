"""Sensors mirrored to the vehicle's other side, and pairs that stay each other's mirror image."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Sequence

import bpy

from ..engine import pe
from .rig import place_poses, pose_of

SIDES = (("left", "right"), ("l", "r"))
MIDDLE_M, MIDDLE_RAD = 1e-4, 1e-5
"""A sensor this near to the vehicle's middle plane is its own mirror image."""

_known: dict[tuple[str, str], pe.Pose] = {}
"""Where linked sensors stood when looked at last, by scene and name: which of a pair has moved."""


def mirrored_pose(pose: pe.Pose) -> pe.Pose:
    """Return a pose on the other side of the x-z plane."""
    (x, y, z), (roll, pitch, yaw) = pose.position, pose.rotation_deg
    return pe.Pose.from_degrees((x, 0.0 - y, z), (0.0 - roll, pitch, 0.0 - yaw))


def mirrored_name(name: str) -> str:
    """Return what a sensor is called on the other side: front_left and front_right, A.L and A.R."""
    for pair in SIDES:
        for one, other in (pair, pair[::-1]):
            found = re.search(rf"(?:(?<=^)|(?<=[^A-Za-z]))({one})(?=[^A-Za-z]|$)", name, re.I)
            if found:
                return name[: found.start()] + _cased(other, found[0]) + name[found.end() :]
    return f"{name} mirrored"


def in_the_middle(pose: pe.Pose) -> bool:
    """Whether a sensor is its own mirror image."""
    roll, _, yaw = (math.remainder(angle, 2.0 * math.pi) for angle in pose.rpy)
    level = abs(roll) < MIDDLE_RAD and min(abs(yaw), math.pi - abs(yaw)) < MIDDLE_RAD
    return abs(pose.position[1]) < MIDDLE_M and level


def link_mirror(one: bpy.types.Object, other: bpy.types.Object) -> None:
    """Have two sensors stay each other's mirror image."""
    one.perception_entropy.mirror_of = other.name
    other.perception_entropy.mirror_of = one.name


def unlink_mirror(obj: bpy.types.Object) -> None:
    """Let a sensor and its mirror image go their own ways."""
    other = bpy.data.objects.get(obj.perception_entropy.mirror_of)
    obj.perception_entropy.mirror_of = ""
    if other is not None and other.perception_entropy.mirror_of == obj.name:
        other.perception_entropy.mirror_of = ""


def mirror_of(obj: bpy.types.Object, scene: bpy.types.Scene) -> bpy.types.Object | None:
    """Return the sensor that is linked as a sensor's mirror image; None without."""
    other = scene.objects.get(obj.perception_entropy.mirror_of)
    if other is None or other == obj or not other.perception_entropy.is_sensor:
        return None
    return other if other.perception_entropy.mirror_of == obj.name else None


def follow_mirrors(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, sensors: Sequence[bpy.types.Object]
) -> list[str]:
    """Put those of linked sensors right whose mirror image has moved; return their names.

    Where both have moved, and are no longer mirror images, the first by name leads. Links of
    duplicates, and of sensors that are gone, are taken away.
    """
    _mend_links(scene, sensors)
    moved: dict[str, pe.Pose] = {}
    seen: dict[tuple[str, str], pe.Pose] = {}
    for obj in sensors:
        other = mirror_of(obj, scene)
        if other is None or other.name < obj.name:
            continue
        with contextlib.suppress(pe.InputError):  # a scaled one is told of where it is
            poses = pose_of(obj, depsgraph), pose_of(other, depsgraph)
            poses = _mirror_images(scene, (obj.name, other.name), poses, moved)
            seen |= {(scene.name, o.name): p for o, p in zip((obj, other), poses, strict=True)}
    if moved:
        with contextlib.suppress(pe.InputError):  # held by a constraint: it stays where it is
            place_poses(scene, moved)
    for key in [key for key in _known if key[0] == scene.name]:
        del _known[key]
    _known.update(seen)
    return list(moved)


def forget_mirrors() -> None:
    """Forget where sensors stood, as another file comes."""
    _known.clear()


def _mirror_images(
    scene: bpy.types.Scene,
    names: tuple[str, str],
    poses: tuple[pe.Pose, pe.Pose],
    moved: dict[str, pe.Pose],
) -> tuple[pe.Pose, pe.Pose]:
    """Return poses that are mirror images of each other; note which one has to be moved."""
    first, second = poses
    if mirrored_pose(first) == second:
        return poses
    still_first = _known.get((scene.name, names[0])) == first
    if still_first and _known.get((scene.name, names[1])) != second:
        moved[names[0]] = mirrored_pose(second)
        return moved[names[0]], second
    moved[names[1]] = mirrored_pose(first)
    return first, moved[names[1]]


def _mend_links(scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object]) -> None:
    """Have links follow a rename; take away those that are not mutual."""
    for obj in sensors:
        wanted = obj.perception_entropy.mirror_of
        if not wanted or mirror_of(obj, scene) is not None:
            continue
        other = scene.objects.get(wanted)
        if other is None:  # renamed: the one that still points here
            (other,) = _pointing_at(obj, sensors) or (None,)
        elif other.perception_entropy.mirror_of in scene.objects or _pointing_at(
            other, sensors
        ) != (obj,):
            other = None  # linked to another: this one is a copy
        if other is None:
            obj.perception_entropy.mirror_of = ""
        else:
            link_mirror(obj, other)


def _pointing_at(
    obj: bpy.types.Object, sensors: Sequence[bpy.types.Object]
) -> tuple[bpy.types.Object, ...]:
    """The one other sensor that is linked to a sensor, if it is one alone."""
    found = [o for o in sensors if o.perception_entropy.mirror_of == obj.name and o != obj]
    return tuple(found) if len(found) == 1 else ()


def _cased(word: str, like: str) -> str:
    """Return a word in the case of another one."""
    if like.isupper():
        return word.upper()
    return word.capitalize() if like[0].isupper() else word

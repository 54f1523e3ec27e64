"""Axes, origins, trees and names of other programs' frames; rotations and quaternions. Frames of
this project: x forward, y left, z up; a camera looks along its x axis; the origin is on the ground
under the vehicle's centre. Optical frames (ROS REP 103, nuScenes, Argoverse, KITTI): z forward, x
right, y down."""

import math
import re
import unicodedata
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError
from pe_core.base.values import vector
from pe_core.geometry.poses import METRES, PROPER_WITHIN, Pose, rpy_from_matrix
from pe_core.geometry.poses import checked_rotation as checked_rotation
from pe_core.geometry.poses import from_quaternion as from_quaternion
from pe_core.scene.vehicle_description import Reference

from .foreign_values import MAX_FRAMES, require_at_most
from .merging import is_same_pose
from .portable import ORIGIN, PortableSensor
from .portable_kinds import CAMERA
from .sensor_names import said_kind

Quaternion = tuple[float, float, float, float]

BODY_FROM_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""A camera's optical frame in the sensor frame: rpy (-90, 0, -90) degrees."""
OPTICAL_RPY = (-math.pi / 2.0, 0.0, -math.pi / 2.0)
BODY_FROM_RIGHT_FORWARD = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""A LiDAR's frame with x right, y forward, z up (nuScenes), in the sensor frame."""

GROUND = "ground"
REAR_AXLE_GROUND = "rear axle on the ground"
REAR_AXLE = "rear axle"
"""Origins: of the ground frame; the middle of the rear axle on the ground; the middle itself."""
ASKING = "calibration"  # Source of messages on poses that a program hands over
OPTICAL = "_optical"  # Suffix of the name of a camera's optical frame
OPTICAL_NAME = re.compile("[_/]?optical(_frame|_link)?$")  # End of such names in foreign files
OPTICAL_TILT = math.radians(45.0)
"""A camera has optical axes if its y axis is nearer than this to the vertical [rad].
If it looks ahead, its roll is then 45 to 135 degrees."""
UPSIDE_DOWN = math.radians(10.0)
"""A camera in body axes that is upside down has a z axis that points down, as has an optical frame
that looks down; its roll differs from 180 degrees by less than this [rad]."""
ILLEGAL, ILLEGAL_IN_TF = (re.compile(f"[^A-Za-z0-9_{more}]+") for more in ("", "/"))
AXES = (
    " is on the ground under the vehicle's centre: x forward, y left, z up; metres, radians. "
    "NAME_optical looks along z, x right, y down (REP 103). "
)
"""Comment in new files of ROS, after the name of the root."""
ParentFrames = Mapping[
    str, tuple[str, Pose]
]  # Parent frame and pose in the parent frame, by frame name
TURNED = (
    "a frame of this name, or whose y axis points up or down, is optical: z is taken as forward"
)
TURNED_APART = "its optical frame looks elsewhere than its link, by {:.3g} deg; it is followed"
NOT_TURNED = "its optical frame is turned as its own frame: x is taken as forward"
APART = math.radians(1.0)  # Optical axes nearer than this to the x axis of the link are along it


def product(a: Floats, b: Floats) -> Floats:
    """Return the product of two (3, 3) matrices, in plain sums."""
    rows = [[sum(a[i, k] * b[k, j] for k in range(3)) for j in range(3)] for i in range(3)]
    return np.array(rows, dtype=float)


def turned(rotation: Floats, vector: Sequence[float]) -> tuple[float, float, float]:
    """Return a vector turned by a (3, 3) rotation."""
    x, y, z = (float(sum(row[k] * vector[k] for k in range(3))) for row in rotation)
    return x, y, z


def quaternion(rotation: Floats) -> Quaternion:
    """Return the unit quaternion (w, x, y, z) of a (3, 3) rotation, w >= 0."""
    m = rotation.tolist()
    squares = (
        1.0 + m[0][0] + m[1][1] + m[2][2],
        1.0 + m[0][0] - m[1][1] - m[2][2],
        1.0 - m[0][0] + m[1][1] - m[2][2],
        1.0 - m[0][0] - m[1][1] + m[2][2],
    )
    largest = max(range(4), key=lambda k: squares[k])
    twice = math.sqrt(squares[largest])
    a = m[2][1] - m[1][2]
    b = m[0][2] - m[2][0]
    c = m[1][0] - m[0][1]
    d = m[1][0] + m[0][1]
    e = m[0][2] + m[2][0]
    f = m[2][1] + m[1][2]
    rows = ((0.0, a, b, c), (a, 0.0, d, e), (b, d, 0.0, f), (c, e, f, 0.0))
    halves = [value / (2.0 * twice) for value in rows[largest]]
    halves[largest] = twice / 2.0
    sign = -1.0 if halves[0] < 0.0 else 1.0
    w, x, y, z = (sign * value for value in halves)
    return w, x, y, z


def pose_of(rotation: Floats, position: Sequence[float]) -> Pose:
    """Return the pose with a (3, 3) rotation and a position."""
    x, y, z = (float(v) for v in position)
    return Pose((x, y, z), rpy_from_matrix(rotation))


def composed(outer: Pose, inner: Pose) -> Pose:
    """Return the pose of `inner` in the parent frame; `inner` is given in the frame `outer`."""
    rotation = outer.ground_from_sensor
    shift = turned(rotation, inner.position)
    position = [a + b for a, b in zip(outer.position, shift, strict=True)]
    return pose_of(product(rotation, inner.ground_from_sensor), position)


def seen_from(outer: Pose, inner: Pose) -> Pose:
    """Return the pose of `inner` in the frame `outer`; both are given in the same frame."""
    x, y, z = (a - b for a, b in zip(inner.position, outer.position, strict=True))
    if outer.rpy == (0.0, 0.0, 0.0):
        return Pose((x, y, z), inner.rpy)
    back = outer.ground_from_sensor.T
    return pose_of(product(back, inner.ground_from_sensor), turned(back, (x, y, z)))


def turn_between(a: Pose, b: Pose) -> float:
    """Return the angle by which two poses are turned against each other [rad]."""
    cosine = (float((a.ground_from_sensor * b.ground_from_sensor).sum()) - 1.0) / 2.0
    return math.acos(min(1.0, max(-1.0, cosine)))


def is_optical(name: str, pose: Pose) -> bool:
    """Whether a camera's frame has optical axes: its name says so, or y is the vertical axis, and
    not z, or y and z both point down. `pose` is that on the vehicle."""
    _, y_up, z_up = pose.ground_from_sensor[2].tolist()
    is_vertical = abs(y_up) > math.cos(OPTICAL_TILT)
    looks_down = z_up < 0.0 and y_up < -math.sin(UPSIDE_DOWN)
    return bool(OPTICAL_NAME.search(name)) or is_vertical or looks_down


def body_of_optical(pose: Pose) -> Pose:
    """Return the pose of a camera, which looks along x, from that of its optical frame."""
    return pose_of(product(pose.ground_from_sensor, BODY_FROM_OPTICAL.T), pose.position)


def with_body_axes(sensor: PortableSensor, frame: str = "") -> PortableSensor:
    """Return a sensor; a camera whose frame is an optical one is turned, and has a note on it.
    `frame` is the name of the frame, if it is not the sensor's."""
    kind = sensor.kind or said_kind(sensor.name)
    if kind != CAMERA or not is_optical(frame or sensor.name, sensor.pose):
        return sensor
    return turned_to_body(replace(sensor, kind=kind))


def turned_to_body(sensor: PortableSensor) -> PortableSensor:
    """Return the camera whose pose is that of its optical frame, with a note on it."""
    return replace(sensor, pose=body_of_optical(sensor.pose), told=TURNED)


def as_camera(sensor: PortableSensor, optical: Pose) -> PortableSensor:
    """Return the camera of an optical frame below its own: it is there and looks along its z axis.
    A note says so where its own frame looks elsewhere. An optical frame that is turned as its own
    frame is, is one only if the roll says so, too."""
    own_rotation = sensor.pose.ground_from_sensor
    camera = replace(sensor, kind=CAMERA, pose=Pose(optical.position, sensor.pose.rpy))
    if np.abs(optical.ground_from_sensor - own_rotation).max() < PROPER_WITHIN:
        turned_camera = with_body_axes(camera)
        return turned_camera if turned_camera.told else replace(camera, told=NOT_TURNED)
    pose = body_of_optical(optical)
    rotation = pose.ground_from_sensor
    if np.abs(rotation - own_rotation).max() < PROPER_WITHIN:  # but for the file's rounding
        return camera
    cosine = float(rotation[:, 0] @ own_rotation[:, 0])
    apart = math.acos(min(1.0, max(-1.0, cosine)))
    told = TURNED_APART.format(math.degrees(apart)) if apart > APART else ""
    return replace(camera, pose=pose, told=told)


def camera_frames(parents: Mapping[str, str]) -> dict[str, str]:
    """Return the name of the camera of each optical frame: that of its parent, if this is not the
    root, no frame of the vehicle, and has no other optical frame; else its own without the suffix.
    `parents` are names of parents by that of the frame."""
    optical = [name for name in parents if OPTICAL_NAME.search(name)]
    of_parent: dict[str, list[str]] = {}
    for name in optical:
        of_parent.setdefault(parents[name], []).append(name)
    result = {}
    for name in optical:
        parent = parents[name]
        is_link = parent in parents and said_kind(parent) in (CAMERA, None)
        stem = OPTICAL_NAME.sub("", name) or name
        result[name] = parent if is_link and len(of_parent[parent]) == 1 else stem
    return result


def optical_of_body(pose: Pose) -> Pose:
    """Return the pose of a camera's optical frame from that of the camera."""
    return pose_of(product(pose.ground_from_sensor, BODY_FROM_OPTICAL), pose.position)


def origin_in_ground(
    origin: str, reference: Reference | None, asking: str, source: object = "study"
) -> tuple[float, ...]:
    """Return the position of an origin in the ground frame, (3,) [m]. An origin at a rear axle
    whose position is not known raises `InputError`."""
    if origin == GROUND:
        return 0.0, 0.0, 0.0
    if reference is None:
        expected = f"the rear axle's place, which is the origin of {asking}"
        raise InputError(source, "reference", expected, "none")
    return reference.rear_axle_x, 0.0, reference.rear_axle_z if origin == REAR_AXLE else 0.0


def shifted(pose: Pose, by: Sequence[float]) -> Pose:
    """Return a pose with another position and the same rotation."""
    x, y, z = (a + b for a, b in zip(pose.position, by, strict=True))
    return Pose((x, y, z), pose.rpy)


def pose_from_quaternion(
    rotation: Sequence[float],
    translation: Sequence[float],
    *,
    optical: bool = False,
    inverse: bool = False,
    within: Pose | None = None,
) -> Pose:
    """Return a sensor's pose from a calibration. `InputError` when a number is missing, or the
    quaternion is not valid. `rotation` (4,): quaternion w, x, y, z: from the sensor's axes to its
    parent's. `translation` (3,): position of the sensor in its parent frame [m]. `optical`: whether
    the sensor's axes are a camera's optical ones: z forward, x right, y down. `inverse`: whether
    both are given in the other direction: from the parent to the sensor. `within`: pose of the
    parent; by default the parent is the ground frame."""
    position: Sequence[float] = vector(ASKING, "translation", translation, count=3, rule=METRES)
    matrix = from_quaternion(ASKING, "rotation", vector(ASKING, "rotation", rotation, 4))
    if inverse:
        matrix = matrix.T
        position = [-value for value in turned(matrix, position)]
    if optical:
        matrix = product(matrix, BODY_FROM_OPTICAL.T)
    pose = pose_of(matrix, position)
    return pose if within is None else composed(within, pose)


def poses_from_root(
    path: Path, hung: ParentFrames, frames: Collection[str], noun: str
) -> dict[str, Pose]:
    """Return the poses of all `frames` in the root frame, by name, ordered by depth. Frames of
    equal depth are in the order of `hung`. Each pose is computed once, from that of its parent, so
    the time is linear in the number of frames. `noun` is the word for a frame in this format. More
    than `MAX_FRAMES`, not exactly one root or a cycle raise `InputError`."""
    require_at_most(path, noun, len(frames), MAX_FRAMES, noun=f"{noun}s")
    roots = [name for name in frames if name not in hung]
    if len(roots) != 1:
        found = "none: they go in a circle" if not roots else ", ".join(roots)
        raise InputError(path, noun, "one root", found)
    order = {name: number for number, name in enumerate(hung)}
    children: dict[str, list[str]] = {}
    for name, (parent, _) in hung.items():
        children.setdefault(parent, []).append(name)
    poses = {roots[0]: ORIGIN}
    level = roots
    while level := [child for name in level for child in children.get(name, ())]:
        level.sort(key=order.__getitem__)
        for name in level:
            parent, pose = hung[name]
            poses[name] = composed(poses[parent], pose)
    if len(poses) < len(frames):
        field = f"{noun} {next(name for name in hung if name not in poses)}"
        raise InputError(path, field, "a chain of parents that ends at the root", "a circle")
    return poses


def legal_frame(name: str, *, slashes: bool = False) -> str:
    """Return a frame name of letters, digits and underscores that begins with a letter. With
    `slashes`, the name may also contain ``/``, as frame names of tf2 may."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    legal = (ILLEGAL_IN_TF if slashes else ILLEGAL).sub("_", plain).strip("_/")
    return legal if legal[:1].isalpha() else f"sensor_{legal}".rstrip("_")


def with_legal_frames(
    sensors: Sequence[PortableSensor],
    *,
    slashes: bool = False,
    frames: Callable[[PortableSensor], Collection[str]] = lambda sensor: (sensor.name,),
    taken: Collection[str] = (),
    not_ending: str = "",
) -> tuple[tuple[PortableSensor, ...], list[str]]:
    """Return sensors with legal names and unique frames, and a message for each renamed sensor. One
    that is in the file already keeps its name. `frames` returns the names of all frames of a
    sensor, `taken` are names in use. No name may have the suffix `not_ending`, which marks another
    sort of frame. For `slashes` see `legal_frame`."""
    used = set(taken)
    renamed = []
    lines = []
    used.update(frame for s in sensors if s.entry is not None for frame in frames(s))
    for sensor in sensors:
        if sensor.entry is not None:
            renamed.append(sensor)
            continue
        legal = legal_frame(sensor.name, slashes=slashes)
        if not_ending and legal.endswith(not_ending):
            legal += "_sensor"
        named = replace(sensor, name=legal)
        number = 2
        while used & set(frames(named)):
            named = replace(sensor, name=f"{legal}_{number}")
            number = number + 1
        used |= set(frames(named))
        renamed.append(named)
        if named.name != sensor.name:
            lines.append(f"{sensor.name}: called {named.name}, which is a legal frame of its own")
    return tuple(renamed), lines


def linked(
    sensors: Sequence[PortableSensor], root: str, taken: Collection[str] = ()
) -> tuple[list[tuple[PortableSensor, list[tuple[str, str, Pose]]]], list[str]]:
    """Return sensors with legal names, each with its frames below a root, and messages. A frame is
    its parent, its name and its pose in the parent. A camera also has an optical frame (REP 103).
    `taken` are names in use."""

    def names(sensor: PortableSensor) -> tuple[str, ...]:
        return (sensor.name, sensor.name + OPTICAL) if sensor.kind == CAMERA else (sensor.name,)

    named, lines = with_legal_frames(
        sensors, frames=names, taken=(root, *taken), not_ending=OPTICAL
    )
    result = []
    for sensor in named:
        links = [(root, sensor.name, sensor.pose)]
        if sensor.kind == CAMERA:
            links.append((sensor.name, sensor.name + OPTICAL, Pose(ORIGIN.position, OPTICAL_RPY)))
        result.append((sensor, links))
    return result, lines


def new_places(
    hung: ParentFrames, poses: Mapping[str, Pose], wanted: Mapping[str, Pose]
) -> tuple[dict[str, Pose], dict[str, Pose]]:
    """Return the poses in their parents of the frames that have to be changed, so that the frames
    of `wanted` have these poses in the root frame, and the new poses of all frames in it. Frames
    that are not wanted move with their parents. `poses` are those of all frames in the root frame,
    ordered by depth."""
    placed: dict[str, Pose] = {}
    changed = {}
    for name in poses:
        if name not in hung:
            placed[name] = poses[name]
            continue
        parent, pose = hung[name]
        inside = pose if name not in wanted else seen_from(placed[parent], wanted[name])
        if not is_same_pose(pose, inside):
            changed[name] = inside
            pose = inside
        placed[name] = composed(placed[parent], pose)
    return changed, placed


def carried_along(sensor: PortableSensor, before: Pose, frame: Pose) -> Pose:
    """Return the new pose of the frame that carries a sensor, which had the pose `before`; all are
    poses in one frame."""
    return composed(sensor.pose, seen_from(before, frame))

"""What the design variables of one sensor mean: a pose in a box, on a surface, or in a slot.

A domain has `variables`, its design variables, and `start`, their values where the search starts.
`placed` maps values to a pose. It also returns the values after rounding, or after projection onto
the surface: the search continues from these. `snap_to_mount` finds a pose on a mount to start from.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError
from ..geometry.poses import Pose, dot, rotate, rotation_matrix, rpy_from_matrix
from ..scene.housing import Housing
from ..scene.rig import Sensor
from ..scene.vehicle import Vehicle
from .design_variable import (
    AXES,
    POSITION_AXES,
    SHARE,
    DesignVariable,
    pose_from_values,
    pose_values,
    rounded,
    variable_of,
)
from .mount_surface import MountSurface
from .mounts import AnyMount, SlotMount, SurfaceMount

Bounds = tuple[float, float]

START_M, START_TURN = 0.003, 0.002
"""A start is on its mount if it is no farther away than a gasket is thick, and turned by at most
0.1 deg [m, rad]."""


class BoxDomain:
    """Free coordinates of a sensor, each in its bounds."""

    def __init__(self, pose: Pose, bounds: Mapping[str, Bounds]) -> None:
        values, self._pose = pose_values(pose), pose
        self._axes = tuple(axis for axis in AXES if axis in bounds)
        self.variables = tuple(variable_of(axis, bounds[axis]) for axis in self._axes)
        self.start = tuple(values[axis] for axis in self._axes)

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose at these coordinates, rounded."""
        if not self._axes:
            return self._pose, ()
        moved = pose_values(self._pose) | dict(zip(self._axes, values, strict=True))
        pose = pose_from_values(moved)
        rounded_values = pose_values(pose)
        return pose, tuple(rounded_values[axis] for axis in self._axes)


class SlotDomain:
    """One of a list of poses; its variable is a share from 0 to 1 of the list."""

    variables = (DesignVariable(0.0, 1.0, SHARE),)

    def __init__(self, who: str, mount: SlotMount, pose: Pose) -> None:
        self._slots = mount.slots
        taken = [k for k, slot in enumerate(self._slots) if is_same_pose(slot.pose, pose)]
        if not taken:
            expected = f"a start in a slot: {', '.join(slot.name for slot in self._slots)}"
            raise InputError(who, "position", expected, pose_text(pose))
        self.start = ((taken[0] + 0.5) / len(self._slots),)

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose of the slot at a share, and the middle of the slot's shares."""
        count = len(self._slots)
        number = min(int(values[0] * count), count - 1)
        return rounded(self._slots[number].pose), ((number + 0.5) / count,)


class SurfaceDomain:
    """A point of a surface, and the free angles of the sensor.

    The first three variables are a point near the surface [m]; the sensor is mounted at the closest
    point of the surface. So it moves on surfaces of any shape, and across their parts. Its start is
    checked to be on the surface, unless it may be `anywhere`.
    """

    def __init__(
        self,
        who: str,
        mount: SurfaceMount,
        surface: MountSurface,
        pose: Pose,
        housing: Housing | None,
        bounds: Mapping[str, Bounds],
        anywhere: bool = False,
    ) -> None:
        self.mount, self.surface = mount, surface
        self._standoff_point = standoff_point(mount, housing)
        self._axes = tuple(axis for axis in AXES[3:] if axis in bounds)
        sides = zip(*(corner.tolist() for corner in surface.bounds), strict=True)
        variables = [variable_of(axis, side) for axis, side in zip("xyz", sides, strict=True)]
        variables += [variable_of(axis, bounds[axis]) for axis in self._axes]
        self.variables = tuple(variables)
        foot, face = surface.closest(self.base(pose))
        normal = surface.outward(face)
        rpy: Sequence[float] = pose.rpy
        if mount.orientation != "upright":
            frame = frame_of(mount.orientation, normal)
            rpy = rpy_from_matrix(rotate(frame.T, pose.ground_from_sensor.T).T)
        self._angles = dict(zip(AXES[3:], rpy, strict=True))
        self.start = (*foot.tolist(), *(self._angles[axis] for axis in self._axes))
        if not anywhere:
            self._check_start(who, pose, bounds, foot, normal)

    def base(self, pose: Pose) -> Floats:
        """Return the point (3,) of a sensor at a pose from which the stand-off is measured [m]."""
        return np.array(pose.position) + rotate(pose.ground_from_sensor, self._standoff_point)

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose at the closest point of the surface, and that point."""
        foot, face = self.surface.closest(np.array(values[:3]))
        normal = self.surface.outward(face)
        angles = {**self._angles, **dict(zip(self._axes, values[3:], strict=True))}
        turn = rotation_matrix(*(angles[axis] for axis in AXES[3:]))
        rotation = rotate(frame_of(self.mount.orientation, normal), turn.T).T
        position = foot + self.mount.standoff * normal - rotate(rotation, self._standoff_point)
        if self.mount.orientation != "upright":
            angles = dict(zip(AXES[3:], rpy_from_matrix(rotation), strict=True))
        pose = pose_from_values(dict(zip(POSITION_AXES, position.tolist(), strict=True)) | angles)
        return pose, (*foot.tolist(), *values[3:])

    def _check_start(
        self, who: str, start: Pose, bounds: Mapping[str, Bounds], foot: Floats, normal: Floats
    ) -> None:
        """Raise `InputError` for a start that is not on the surface, with a pose that would be."""
        away = self.base(start) - foot
        off = float(np.sqrt(dot(away, away))) - self.mount.standoff
        below = float(dot(away, normal)) < self.mount.standoff / 2.0 - START_M
        if abs(off) > START_M or below:
            pose, _ = self.placed(self.start)
            expected = f"a start on its mount, such as {pose_text(pose)}"
            raise InputError(who, "position", expected, pose_text(start))
        for axis in self._axes:
            low, high = bounds[axis]
            if not low - START_TURN <= self._angles[axis] <= high + START_TURN:
                expected = f"bounds around the start, {degrees_text(self._angles[axis])}"
                found = f"{degrees_text(low)} to {degrees_text(high)}"
                raise InputError(who, f"bounds of {axis}", expected, found)


Domain = BoxDomain | SlotDomain | SurfaceDomain
"""The poses that one sensor may take, by values of design variables."""


def standoff_point(mount: SurfaceMount, housing: Housing | None) -> Floats:
    """Return the point (3,) of a sensor that a mount's stand-off is measured to, sensor frame [m].

    It is the middle of the base of the housing, or of its back on a mount that is facing; the
    sensor's origin where the housing is unknown.
    """
    if housing is None:
        return np.zeros(3)
    if mount.orientation == "facing":
        return housing.center - np.array([housing.size[0] / 2.0, 0.0, 0.0])
    return -np.array(housing.optical_center)


def frame_of(orientation: str, normal: Floats) -> Floats:
    """Return the rotation (3, 3), ground from mount, of a mount where the unit normal is (3,)."""
    x, y, z = normal.tolist()
    if orientation == "upright":
        return np.eye(3)
    if orientation == "facing":
        return rotation_matrix(0.0, -math.asin(min(max(z, -1.0), 1.0)), math.atan2(y, x))
    if z < -1.0 + 1e-9:
        return rotation_matrix(math.pi, 0.0, 0.0)
    share = 1.0 / (1.0 + z)  # the shortest turn that brings the z axis to the normal
    return np.array(
        [
            [1.0 - share * x * x, -share * x * y, x],
            [-share * x * y, 1.0 - share * y * y, y],
            [-x, -y, z],
        ]
    )


def is_same_pose(a: Pose, b: Pose) -> bool:
    """Whether two poses are equal within `START_M` and `START_TURN`."""
    away = np.array(a.position) - np.array(b.position)
    turned = np.abs(a.ground_from_sensor - b.ground_from_sensor).max()
    return bool(np.sqrt(dot(away, away)) <= START_M and turned <= START_TURN)


def pose_text(pose: Pose) -> str:
    """Return a pose as text for messages: position [m] and angles [deg]."""
    x, y, z = (round(w, 3) + 0.0 for w in pose.position)
    turn = ", ".join(f"{round(angle, 1) + 0.0:g}" for angle in pose.rotation_deg)
    return f"[{x:g}, {y:g}, {z:g}] turned [{turn}]"


def degrees_text(angle: float) -> str:
    """Return an angle [rad] as text for messages."""
    return f"{round(math.degrees(angle), 3) + 0.0:g} deg"


ANY_ANGLE = {axis: (-math.tau, math.tau) for axis in ("roll", "pitch", "yaw")}


def snap_to_mount(
    sensor: Sensor, mount: AnyMount, vehicle: Vehicle | None = None, housing: Housing | None = None
) -> Pose:
    """Return the pose on a mount that is nearest to the pose of a sensor, rounded.

    On a surface with orientation "upright" the sensor keeps its angles; with "normal" it is level
    with the surface and keeps its heading; with "facing" it looks along the normal. Of slots, the
    nearest is taken. `vehicle` is the body that the mount is a part of. `InputError` when the mount
    has no faces, or there is no vehicle.
    """
    if isinstance(mount, SlotMount):
        return rounded(mount.nearest(sensor.pose.position).pose)
    who = f"sensor {sensor.name!r}"
    surface = MountSurface(who, mount, vehicle)
    domain = SurfaceDomain(who, mount, surface, sensor.pose, housing, ANY_ANGLE, anywhere=True)
    *foot, roll, pitch, yaw = domain.start
    if mount.orientation == "normal":
        roll = pitch = 0.0
    elif mount.orientation == "facing":
        roll = pitch = yaw = 0.0
    return domain.placed((*foot, roll, pitch, yaw))[0]

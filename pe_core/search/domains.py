"""What one sensor's unknowns mean: a place in a box, on a surface, in a slot.

A domain has `unknowns`, the `start`'s values of them, and `placed`: values to a pose. With the pose
come the values as they are after rounding, or after the way down to the surface: from these the
search goes on.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..scene.geometry import Pose, dot, rotate, rotation_matrix, rpy_from_matrix
from ..scene.housing import Housing
from .axes import AXES, POSITION_AXES, pose_from_values, pose_values, rounded
from .mounts import SlotMount, SurfaceMount
from .surface import Skin
from .unknown import SHARE, Unknown, unknown_of

Floats = NDArray[np.float64]
Bounds = tuple[float, float]

START_M, START_TURN = 0.003, 0.002
"""A start that is no farther off its mount than a gasket, or turned by no more than 0.1 deg, is on
it [m, rad]."""


class Domain(Protocol):
    """Where one sensor may be."""

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """What the search may change."""

    @property
    def start(self) -> tuple[float, ...]:
        """Values of the unknowns where the search starts."""

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose at values of the unknowns, and the values as they then are."""


@dataclass(frozen=True)
class InBox:
    """Free coordinates of a sensor, each in its bounds."""

    pose: Pose
    bounds: Mapping[str, Bounds]
    axes: tuple[str, ...] = field(init=False)
    unknowns: tuple[Unknown, ...] = field(init=False)
    start: tuple[float, ...] = field(init=False)

    def __post_init__(self) -> None:
        values, put = pose_values(self.pose), object.__setattr__
        put(self, "axes", tuple(axis for axis in AXES if axis in self.bounds))
        put(self, "unknowns", tuple(unknown_of(axis, self.bounds[axis]) for axis in self.axes))
        put(self, "start", tuple(values[axis] for axis in self.axes))

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose at these coordinates, rounded."""
        if not self.axes:
            return self.pose, ()
        moved = pose_values(self.pose) | dict(zip(self.axes, values, strict=True))
        pose = pose_from_values(moved)
        held = pose_values(pose)
        return pose, tuple(held[axis] for axis in self.axes)


@dataclass(frozen=True)
class InSlots:
    """One of a list of poses."""

    who: str
    mount: SlotMount
    pose: Pose
    unknowns: tuple[Unknown, ...] = (Unknown(0.0, 1.0, SHARE),)
    start: tuple[float, ...] = field(init=False)

    def __post_init__(self) -> None:
        slots = self.mount.slots
        taken = [k for k, slot in enumerate(slots) if same_pose(slot.pose, self.pose)]
        if not taken:
            expected = f"a start in a slot: {', '.join(slot.name for slot in slots)}"
            raise InputError(self.who, "position", expected, told(self.pose))
        object.__setattr__(self, "start", ((taken[0] + 0.5) / len(slots),))

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose of the slot that a share falls into, and the middle of its shares."""
        slots = self.mount.slots
        number = min(int(values[0] * len(slots)), len(slots) - 1)
        return rounded(slots[number].pose), ((number + 0.5) / len(slots),)


@dataclass(frozen=True)
class OnSurface:
    """A point of a surface, and the free ones of the sensor's angles.

    The first three unknowns are a point near the surface [m]; the sensor stands at the surface's
    point that is closest to it. So it moves in surfaces of any shape, and across their parts. Its
    start is checked to be on it, unless it may be `anywhere`.
    """

    who: str
    mount: SurfaceMount
    skin: Skin
    pose: Pose
    housing: Housing | None
    bounds: Mapping[str, Bounds]
    anywhere: bool = False
    axes: tuple[str, ...] = field(init=False)
    unknowns: tuple[Unknown, ...] = field(init=False)
    start: tuple[float, ...] = field(init=False)
    angles: Mapping[str, float] = field(init=False)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "axes", tuple(axis for axis in AXES[3:] if axis in self.bounds))
        sides = zip(*(corner.tolist() for corner in self.skin.bounds), strict=True)
        unknowns = [unknown_of(axis, side) for axis, side in zip("xyz", sides, strict=True)]
        unknowns += [unknown_of(axis, self.bounds[axis]) for axis in self.axes]
        put(self, "unknowns", tuple(unknowns))
        foot, face = self.skin.closest(self.base(self.pose))
        angles = self._angles(self.skin.outward(face))
        put(self, "angles", angles)
        put(self, "start", (*foot.tolist(), *(angles[axis] for axis in self.axes)))
        if not self.anywhere:
            self._check_start(foot, self.skin.outward(face))

    def base(self, pose: Pose) -> Floats:
        """Return the point (3,) of a sensor at a pose from which the stand-off is measured [m]."""
        return np.array(pose.position) + rotate(pose.ground_from_sensor, self._seat)

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose at the closest point of the surface, and that point."""
        foot, face = self.skin.closest(np.array(values[:3]))
        normal = self.skin.outward(face)
        angles = {**self.angles, **dict(zip(self.axes, values[3:], strict=True))}
        rotation = rotate(frame_of(self.mount.orientation, normal), _turned(angles).T).T
        position = foot + self.mount.standoff * normal - rotate(rotation, self._seat)
        if self.mount.orientation != "upright":
            angles = dict(zip(AXES[3:], rpy_from_matrix(rotation), strict=True))
        pose = pose_from_values(dict(zip(POSITION_AXES, position.tolist(), strict=True)) | angles)
        return pose, (*foot.tolist(), *values[3:])

    @property
    def _seat(self) -> Floats:
        """Middle (3,) of the housing's base, or of its back, in the sensor frame [m]."""
        return seat_of(self.mount, self.housing)

    def _angles(self, normal: Floats) -> dict[str, float]:
        if self.mount.orientation == "upright":
            return dict(zip(AXES[3:], self.pose.rpy, strict=True))
        frame = frame_of(self.mount.orientation, normal)
        own = rotate(frame.T, self.pose.ground_from_sensor.T).T
        return dict(zip(AXES[3:], rpy_from_matrix(own), strict=True))

    def _check_start(self, foot: Floats, normal: Floats) -> None:
        """Complain of a start that is not on the surface, and say where on it it could be."""
        away = self.base(self.pose) - foot
        off = float(np.sqrt(dot(away, away))) - self.mount.standoff
        below = float(dot(away, normal)) < self.mount.standoff / 2.0 - START_M
        if abs(off) > START_M or below:
            pose, _ = self.placed(self.start)
            expected = f"a start on its mount, such as {told(pose)}"
            raise InputError(self.who, "position", expected, told(self.pose))
        for axis in self.axes:
            low, high = self.bounds[axis]
            if not low - START_TURN <= self.angles[axis] <= high + START_TURN:
                expected = f"bounds around the start, {degrees(self.angles[axis])}"
                found = f"{degrees(low)} to {degrees(high)}"
                raise InputError(self.who, f"bounds of {axis}", expected, found)


def seat_of(mount: SurfaceMount, housing: Housing | None) -> Floats:
    """Return the point (3,) of a sensor, in its frame, that a mount's stand-off ends at [m]."""
    if housing is None:
        return np.zeros(3)
    if mount.orientation == "facing":
        return housing.center - np.array([housing.size[0] / 2.0, 0.0, 0.0])
    return -np.array(housing.optical_center)


def frame_of(orientation: str, normal: Floats) -> Floats:
    """Return the frame (3, 3) of a mount, ground from mount, at a unit normal (3,)."""
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


def same_pose(a: Pose, b: Pose) -> bool:
    """Whether two poses are the same but for what a start may be off."""
    away = np.array(a.position) - np.array(b.position)
    turned = np.abs(a.ground_from_sensor - b.ground_from_sensor).max()
    return bool(np.sqrt(dot(away, away)) <= START_M and turned <= START_TURN)


def told(pose: Pose) -> str:
    """Return a pose as messages tell it."""
    x, y, z = (round(w, 3) + 0.0 for w in pose.position)
    turn = ", ".join(f"{round(angle, 1) + 0.0:g}" for angle in pose.rotation_deg)
    return f"[{x:g}, {y:g}, {z:g}] turned [{turn}]"


def degrees(angle: float) -> str:
    """Return an angle [rad] as messages tell it."""
    return f"{round(math.degrees(angle), 3) + 0.0:g} deg"


def _turned(angles: Mapping[str, float]) -> Floats:
    return rotation_matrix(*(angles[axis] for axis in AXES[3:]))

"""States of a vehicle: rigid motions of named parts, and of the body on its springs.

A part is a door, a boot, a trailer, a wheel, a wiper, a cab. Sensors that stand on a moved part
move with it. All products are written out, so that a state has the same bits in all front ends.
"""

import fnmatch
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, NamedTuple

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError, require_name
from ..base.setting import (
    NAMES,
    Named,
    Panel,
    Part,
    Triple,
    check_settings,
    required_setting,
    setting,
)
from ..base.values import A_NAME, WEIGHT, Angle, Number, Whole
from ..geometry.poses import Pose, rotate, rotation_matrix, rpy_from_matrix
from .rig import Rig, Sensor
from .vehicle import Vehicle, closest_points

Vector3 = tuple[float, float, float]

METRES = Triple(Number(-100.0, 100.0, unit="m"))
TURN = Triple(Angle(-360.0, 360.0))
WEIGHED = "Part in the weighted mean of all conditions"
ZERO: Vector3 = (0.0, 0.0, 0.0)
ATTACHED_M = 0.15
"""A sensor stands on the part whose surface is nearest to it, at most this far away [m]."""
GROUND_M = 0.01
"""A part that a state drives deeper into the ground than this is warned of [m]."""


@dataclass(frozen=True)
class Motion:
    """A rigid motion of parts: ``p' = R (p - about) + about + move``, lengths in metres.

    R is ``Rz(yaw) Ry(pitch) Rx(roll)``, of `rotation` [rad]; `about` is a hinge, or the hitch.

    `InputError` when there is no part, or a number is out of its range.
    """

    parts: Sequence[str] = required_setting(
        NAMES, "Names of the vehicle's parts that move; `*` stands for any letters"
    )
    rotation: Vector3 = setting(ZERO, TURN, "Roll, pitch and yaw, about the axes of the ground")
    about: Vector3 = setting(ZERO, METRES, "A point that the rotation leaves where it is: a hinge")
    move: Vector3 = setting(ZERO, METRES, "A translation, after the rotation")
    sensors: Sequence[str] | None = setting(
        None, NAMES, "Sensors that move with the parts; by default those that stand on them"
    )

    def __post_init__(self) -> None:
        check_settings(self, "state", "move.")
        if not self.parts and not self.sensors:
            raise InputError("state", "move.parts", "at least one part of the vehicle", "none")

    @property
    def matrix(self) -> Floats:
        """(3, 3) rotation."""
        return rotation_matrix(*self.rotation)

    def points(self, points: Floats) -> Floats:
        """Return points (..., 3) moved [m]."""
        about = np.asarray(self.about)
        return rotate(self.matrix, points - about) + (about + np.asarray(self.move))

    def points_before(self, points: Floats) -> Floats:
        """Return points (..., 3) as they were before the motion [m]."""
        about = np.asarray(self.about)
        return rotate(self.matrix.T, points - (about + np.asarray(self.move))) + about

    def pose(self, pose: Pose) -> Pose:
        """Return a sensor's pose moved."""
        position = self.points(np.asarray(pose.position, dtype=float)).tolist()
        columns = rotate(self.matrix, pose.ground_from_sensor.T).T  # column by column
        return Pose(tuple(position), rpy_from_matrix(columns))


@dataclass(frozen=True)
class State:
    """A state of the vehicle, with a name that is unique in a study, and how much it counts.

    The motions are in this order; without any, the vehicle is as it is drawn. After them the
    body on its springs is raised [m], leans to the right and goes nose down [rad].

    `InputError` when a value is out of its range.
    """

    name: Named
    motions: Annotated[Sequence[Motion], Part(key="move")] = ()
    weight: float = setting(1.0, WEIGHT, WEIGHED, Panel("weight", "Weight"), scored=True)
    heave: float = setting(0.0, Number(-1.0, 1.0, unit="m"), "How far the body is raised [m]")
    roll_rad: float = setting(0.0, Angle(-45.0, 45.0), "How far the body leans to the right")
    pitch_rad: float = setting(0.0, Angle(-45.0, 45.0), "How far the body's nose is down")
    frame: int | None = setting(None, Whole(0, 1_048_574), "Frame of the scene with this state")
    about: Vector3 = setting(ZERO, METRES, "A point that roll and pitch leave where it is")
    unsprung: Sequence[str] = setting(
        (), NAMES, "Parts that stay on the ground: wheels, axles, a trailer"
    )

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "name", A_NAME.checked("state", "name", self.name))
        who = f"state {self.name!r}"
        check_settings(self, who)
        put(self, "motions", tuple(self.motions))

    @property
    def is_as_drawn(self) -> bool:
        """Whether it moves nothing."""
        return not self.motions and not self._leans

    @property
    def _leans(self) -> bool:
        return any((self.heave, self.roll_rad, self.pitch_rad))

    def moves(self, vehicle: Vehicle | None, rig: Rig | None = None) -> "list[_Moved]":
        """Return what moves, in order, with its parts and those of its sensors that a rig has.

        `InputError` for a part that there is not, with the nearest names.
        """
        if self.is_as_drawn:
            return []
        who = f"state {self.name!r}"
        if vehicle is None:
            raise InputError(who, "move", "a [vehicle] whose parts move", "none")
        carriers = {} if rig is None else {s.name: carrier(vehicle, s) for s in rig}
        moved = [_Moved(m, *_named(who, m, vehicle, carriers)) for m in self.motions]
        if self._leans:
            still = _parts(who, "body.unsprung", self.unsprung, vehicle)
            parts = frozenset(range(len(vehicle.part_names))) - still
            sensors = frozenset(n for n, part in carriers.items() if part not in still)
            everything = Motion(
                ("*",), (self.roll_rad, self.pitch_rad, 0.0), self.about, (0.0, 0.0, self.heave)
            )
            moved.append(_Moved(everything, parts, sensors))
        return moved

    def __call__(self, rig: Rig, vehicle: Vehicle | None) -> tuple[Rig, Vehicle | None]:
        """Return a rig and a vehicle, which are as they are drawn, in this state."""
        return self.rig(rig, vehicle), self.vehicle(vehicle)

    def vehicle(self, vehicle: Vehicle | None) -> Vehicle | None:
        """Return the vehicle in this state; the same object where nothing moves."""
        moves = self.moves(vehicle)
        if vehicle is None or not moves:
            return vehicle
        triangles = np.array(vehicle.triangles)
        for motion, parts, _ in moves:
            inside = np.isin(vehicle.parts, list(parts))
            triangles[inside] = motion.points(triangles[inside])
        return replace(vehicle, triangles=triangles, drawn=vehicle.as_drawn)

    def undone(self, vehicle: Vehicle) -> Vehicle:
        """Return the vehicle as it is drawn, of the vehicle in this state."""
        triangles = np.array(vehicle.triangles)
        for motion, parts, _ in reversed(self.moves(vehicle)):
            inside = np.isin(vehicle.parts, list(parts))
            triangles[inside] = motion.points_before(triangles[inside])
        return replace(vehicle, triangles=triangles, drawn=None)

    def rig(self, rig: Rig, vehicle: Vehicle | None) -> Rig:
        """Return a rig in this state; `vehicle` is as it is drawn."""
        poses = {s.name: s.pose for s in rig}
        for motion, _, sensors in self.moves(vehicle, rig):
            for name in sensors:
                poses[name] = motion.pose(poses[name])
        return rig.with_poses([poses[s.name] for s in rig])

    def below_ground(self, vehicle: Vehicle | None) -> dict[str, float]:
        """Return how far parts are driven into the ground, by name, deepest first [m]."""
        moved = self.vehicle(vehicle)
        if vehicle is None or moved is None or moved is vehicle:
            return {}
        depths = {}
        for number, name in enumerate(vehicle.part_names):
            inside = vehicle.parts == number
            if inside.any():
                before, after = (v.triangles[inside][..., 2].min() for v in (vehicle, moved))
                if after < min(before, 0.0) - GROUND_M:
                    depths[name] = float(-after)
        return dict(sorted(depths.items(), key=lambda each: -each[1]))


class _Moved(NamedTuple):
    """A motion, indices of the parts it moves, and names of the sensors."""

    motion: Motion
    parts: frozenset[int]
    sensors: frozenset[str]


def carrier(vehicle: Vehicle, sensor: Sensor) -> int:
    """Return the part that a sensor stands on, an index; -1 for none: see `ATTACHED_M`."""
    position = np.asarray(sensor.pose.position, dtype=float)
    faces = vehicle.faces_near(position, ATTACHED_M)
    if not len(faces):
        return -1
    offset = closest_points(position, vehicle.triangles[faces]) - position
    square = offset[:, 0] ** 2 + offset[:, 1] ** 2 + offset[:, 2] ** 2
    nearest = int(np.argmin(square))
    return int(vehicle.parts[faces[nearest]]) if square[nearest] <= ATTACHED_M**2 else -1


def _named(
    who: str, motion: Motion, vehicle: Vehicle, carriers: dict[str, int]
) -> tuple[frozenset[int], frozenset[str]]:
    parts = _parts(who, "move.parts", motion.parts, vehicle)
    if motion.sensors is None:
        return parts, frozenset(name for name, part in carriers.items() if part in parts)
    return parts, frozenset(name for name in motion.sensors if name in carriers)


def _parts(who: str, key: str, names: Iterable[str], vehicle: Vehicle) -> frozenset[int]:
    """Return the indices of named parts, or raise `InputError`."""
    found = set[int]()
    for name in names:
        fitting = [k for k, n in enumerate(vehicle.part_names) if fnmatch.fnmatchcase(n, name)]
        if name in vehicle.part_names:
            fitting = [list(vehicle.part_names).index(name)]
        if not fitting:
            require_name(who, key, name, vehicle.part_names)
        found.update(fitting)
    return frozenset(found)

"""Sensors that follow others: mirror images, and groups that move as one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import InputError, shown
from ..scene.geometry import Pose, rotate, rpy_from_matrix
from ..scene.sensors import Rig
from ..scene.vehicle import Vehicle
from .axes import AXES, pose_from_values, rounded
from .domains import same_pose, told
from .mounts import Mounting

LOPSIDED = 0.05
"""A body whose sides are at distances from y = 0 that differ by more than this share of its width
is no mirror image of itself."""


@dataclass(frozen=True, slots=True)
class Follower:
    """A sensor whose pose follows from another's.

    Attributes
    ----------
    name, leader : str
    relative : (3, 3) float and (3,) float, optional
        Rotation and place [m] in the leader's frame; None: its mirror image across y = 0.
    """

    name: str
    leader: str
    relative: tuple[np.ndarray, np.ndarray] | None = None

    def pose(self, leader: Pose) -> Pose:
        """Return the follower's pose, rounded."""
        if self.relative is None:
            return mirrored(leader)
        turn, place = self.relative
        rotation = leader.ground_from_sensor
        position = np.array(leader.position) + rotate(rotation, place)
        rpy = rpy_from_matrix(rotate(rotation, turn.T).T)
        values = zip(AXES, (*position.tolist(), *rpy), strict=True)
        return pose_from_values(dict(values))


def mirrored(pose: Pose) -> Pose:
    """Return the mirror image of a pose across y = 0, rounded."""
    (x, y, z), (roll, pitch, yaw) = pose.position, pose.rpy
    return rounded(Pose((x, -y, z), (-roll, pitch, -yaw)))


def followers(rig: Rig, mounting: Mounting, vehicle: Vehicle | None) -> tuple[Follower, ...]:
    """Return the sensors that follow others, each after the one it follows.

    Raises
    ------
    InputError
        When there is no such sensor, one follows two others or in a ring, a pair is of different
        kinds of model, or does not start as mirror images, or the vehicle is not symmetric.
    """
    _check_names(rig, mounting)
    ties = {tie.name: tie for tie in _ties(rig, mounting)}
    if mounting.pairs:
        _check_symmetry(vehicle)
    ordered: list[Follower] = []
    while ties:
        ready = [tie for tie in ties.values() if tie.leader not in ties]
        if not ready:
            raise InputError("optimize", "pair, group", "a sensor that leads", "a ring of sensors")
        ordered += ready
        ties = {name: tie for name, tie in ties.items() if tie not in ready}
    return tuple(ordered)


def _ties(rig: Rig, mounting: Mounting) -> Iterator[Follower]:
    for first, second in mounting.pairs:
        _check_pair(rig, first, second)
        yield Follower(second, first)
    for leader, *others in mounting.groups:
        lead = rig[leader].pose
        back = lead.ground_from_sensor.T
        for name in others:
            own = rig[name].pose
            turn = rotate(back, own.ground_from_sensor.T).T
            away = np.array(own.position) - np.array(lead.position)
            yield Follower(name, leader, (turn, rotate(back, away)))


def _check_names(rig: Rig, mounting: Mounting) -> None:
    names = [sensor.name for sensor in rig]
    for field, ties in (("pair", mounting.pairs), ("group", mounting.groups)):
        for name in (name for tie in ties for name in tie if name not in names):
            raise InputError("optimize", field, f"sensors of {', '.join(names)}", shown(name))
    follow = [pair[1] for pair in mounting.pairs]
    follow += [name for group in mounting.groups for name in group[1:]]
    for name in follow:
        if follow.count(name) > 1:
            expected = "a sensor that follows one other"
            raise InputError("optimize", "pair, group", expected, f"{name!r} follows two")
        if name in mounting.on:
            expected = "none of a sensor that follows another"
            raise InputError(f"sensor {name!r}", "mount", expected, shown(mounting.on[name]))


def _check_pair(rig: Rig, first: str, second: str) -> None:
    one, other = rig[first], rig[second]
    image = mirrored(one.pose)
    if not same_pose(image, other.pose):
        expected = f"the mirror image of {first!r} across y = 0, {told(image)}"
        raise InputError(f"sensor {second!r}", "position", expected, told(other.pose))


def _check_symmetry(vehicle: Vehicle | None) -> None:
    if vehicle is None:
        return
    low, high = (float(corner[1]) for corner in vehicle.bounds)
    if abs(low + high) > LOPSIDED * (high - low):
        expected = "a vehicle that is its own mirror image across y = 0"
        raise InputError("optimize", "pair", expected, f"one from y = {low:.2f} to {high:.2f} m")

"""Linked sensors: mirror images, and groups that move as one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..base.errors import InputError, shown
from ..geometry.poses import Pose, rotate, rpy_from_matrix
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from .design_variable import AXES, pose_from_values, rounded
from .domains import is_same_pose, pose_text
from .mounts import Mounting

MAX_ASYMMETRY = 0.05
"""A body is not symmetric if the distances of its sides from y = 0 differ by more than this share
of its width."""


@dataclass(frozen=True, slots=True)
class Follower:
    """A sensor whose pose is determined by that of another sensor, its leader.

    `relative` is its rotation (3, 3) and position (3,) [m] in the leader's frame; None: it is the
    leader's mirror image across y = 0.
    """

    name: str
    leader: str
    relative: tuple[np.ndarray, np.ndarray] | None = None

    def pose(self, leader: Pose) -> Pose:
        """Return the follower's pose, rounded."""
        if self.relative is None:
            return mirrored(leader)
        turn, offset = self.relative
        rotation = leader.ground_from_sensor
        position = np.array(leader.position) + rotate(rotation, offset)
        rpy = rpy_from_matrix(rotate(rotation, turn.T).T)
        values = zip(AXES, (*position.tolist(), *rpy), strict=True)
        return pose_from_values(dict(values))


def mirrored(pose: Pose) -> Pose:
    """Return the mirror image of a pose across y = 0, rounded."""
    (x, y, z), (roll, pitch, yaw) = pose.position, pose.rpy
    return rounded(Pose((x, -y, z), (-roll, pitch, -yaw)))


def followers(rig: Rig, mounting: Mounting, vehicle: Vehicle | None) -> tuple[Follower, ...]:
    """Return the sensors that follow others, each after its leader.

    `InputError` when a sensor does not exist, follows two others or follows itself through others,
    a pair does not start as mirror images, or the vehicle is not symmetric.
    """
    _check_names(rig, mounting)
    waiting = {link.name: link for link in _links(rig, mounting)}
    if mounting.pairs and vehicle is not None:
        low, high = (float(corner[1]) for corner in vehicle.bounds)
        if abs(low + high) > MAX_ASYMMETRY * (high - low):
            expected = "a vehicle that is its own mirror image across y = 0"
            found = f"one from y = {low:.2f} to {high:.2f} m"
            raise InputError("optimize", "pair", expected, found)
    ordered: list[Follower] = []
    while waiting:
        ready = [link for link in waiting.values() if link.leader not in waiting]
        if not ready:
            raise InputError("optimize", "pair, group", "a sensor that leads", "a ring of sensors")
        ordered += ready
        waiting = {name: link for name, link in waiting.items() if link not in ready}
    return tuple(ordered)


def _links(rig: Rig, mounting: Mounting) -> Iterator[Follower]:
    for first, second in mounting.pairs:
        image, pose = mirrored(rig[first].pose), rig[second].pose
        if not is_same_pose(image, pose):
            expected = f"the mirror image of {first!r} across y = 0, {pose_text(image)}"
            raise InputError(f"sensor {second!r}", "position", expected, pose_text(pose))
        yield Follower(second, first)
    for leader, *follower_names in mounting.groups:
        leader_pose = rig[leader].pose
        leader_from_ground = leader_pose.ground_from_sensor.T
        for name in follower_names:
            pose = rig[name].pose
            turn = rotate(leader_from_ground, pose.ground_from_sensor.T).T
            offset = np.array(pose.position) - np.array(leader_pose.position)
            yield Follower(name, leader, (turn, rotate(leader_from_ground, offset)))


def _check_names(rig: Rig, mounting: Mounting) -> None:
    names = [sensor.name for sensor in rig]
    for field, links in (("pair", mounting.pairs), ("group", mounting.groups)):
        for name in (name for link in links for name in link if name not in names):
            raise InputError("optimize", field, f"sensors of {', '.join(names)}", shown(name))
    following = [pair[1] for pair in mounting.pairs]
    following += [name for group in mounting.groups for name in group[1:]]
    for name in following:
        if following.count(name) > 1:
            expected = "a sensor that follows one other"
            raise InputError("optimize", "pair, group", expected, f"{name!r} follows two")
        if name in mounting.on:
            expected = "no mount for a sensor that follows another"
            raise InputError(f"sensor {name!r}", "mount", expected, shown(mounting.on[name]))

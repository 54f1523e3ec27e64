"""Random rigs for tests of properties: by number, so that a failure can be had again.

Most stand at round places: on voxels' corners, edges, faces and centres, turned by round angles, in
and on vehicles of round measures. There ties are.
"""

import math
import os
from dataclasses import dataclass, replace

import numpy as np

import pe_core as pe
from tests.engine import shapes
from tests.thorough import tries

RIGS = int(os.environ.get("PE_PROPERTY_RIGS") or tries(15, 60))
"""How many rigs each property is tried on; `make properties` takes more."""

INTERVALS = (0.1, 0.2, 0.25, 0.5)
HALF_SHAPE = (12, 9, 7)
"""Of a space in voxels, but for its height, which is no more: areas are found in both ways."""
NUDGE_Y = 3.02e-8
"""Of LiDARs, to the left, in voxels."""
ROUND = "round"
"""Name of LiDARs with round channels."""
QUARTERS_DEG = (0.0, 90.0, 180.0, -90.0)
ROUND_CHANNELS_DEG = (-60.0, -45.0, -30.0, -15.0, 0.0, 15.0, 30.0, 45.0, 60.0)
ROUND_DEG = (0.0, 0.0, 30.0, 45.0, 90.0, -60.0, 135.0, 180.0, -90.0, 12.5)


@dataclass(frozen=True)
class Scene:
    """A rig, the space it is evaluated in, and perhaps a vehicle."""

    space: pe.PerceptionSpace
    vehicle: pe.Vehicle | None
    rig: pe.Rig

    def moved(self, voxels):
        """All of it, moved by so many voxels along each axis."""
        by = np.asarray(voxels) * self.space.interval
        bounds = zip((self.space.x, self.space.y, self.space.z), by.tolist(), strict=True)
        x, y, z = ((low + d, high + d) for (low, high), d in bounds)
        space = replace(self.space, x=x, y=y, z=z)
        vehicle = self.vehicle and replace(self.vehicle, triangles=self.vehicle.triangles + by)
        poses = [pe.Pose(tuple(s.pose.position + by), s.pose.rpy) for s in self.rig]
        return Scene(space, vehicle, self.rig.with_poses(poses))

    def turned(self, turns):
        """The same, its sensors' yaws so many full turns more."""
        poses = [
            pe.Pose.from_degrees(s.pose.position, s.pose.rotation_deg + np.array([0, 0, 360 * n]))
            for s, n in zip(self.rig, turns, strict=True)
        ]
        return replace(self, rig=self.rig.with_poses(poses))

    def mirrored(self, nudge_too=False):
        """Left and right exchanged. A LiDAR's nudge is not, unless the caller mirrors that too."""
        flip = np.array([1.0, -1.0, 1.0])
        vehicle = self.vehicle and replace(self.vehicle, triangles=self.vehicle.triangles * flip)
        poses = [pe.Pose(self._across(s, nudge_too), s.pose.rpy * -flip) for s in self.rig]
        low, high = self.space.y
        space = replace(self.space, y=(-high, -low))
        return Scene(space, vehicle, self.rig.with_poses(poses))

    def _across(self, sensor, nudge_too):
        """Where the mirrored sensor is; two nudges are taken off a LiDAR that is nudged as ever."""
        x, y, z = sensor.pose.position
        off = sensor.kind == "lidar" and not nudge_too
        return x, -y - off * 2.0 * NUDGE_Y * self.space.interval, z

    def quarter_turned(self):
        """All of it turned to the left by 90 degrees; the caller turns the nudges."""
        left = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        vehicle = self.vehicle and replace(self.vehicle, triangles=self.vehicle.triangles @ left.T)
        poses = [
            pe.Pose.from_degrees(left @ s.pose.position, s.pose.rotation_deg + np.array([0, 0, 90]))
            for s in self.rig
        ]
        low, high = self.space.y
        x = self.space.x
        space = replace(self.space, x=(-high, -low), y=x)
        return Scene(space, vehicle, self.rig.with_poses(poses))


def round_scene(number):
    """A rig at round places."""
    rng = np.random.default_rng([14, number])
    return _scene(rng, lambda space: _round_pose(rng, space))


def free_scene(number):
    """A rig anywhere: no ties but by chance."""
    rng = np.random.default_rng([41, number])
    return _scene(rng, lambda space: _free_pose(rng, space))


def _scene(rng, pose):
    interval = float(rng.choice(INTERVALS))
    ends = [round(n * interval, 9) for n in HALF_SHAPE]
    space = pe.PerceptionSpace((-ends[0], ends[0]), (-ends[1], ends[1]), (0.0, ends[2]), interval)
    lidar = pe.Sensor("lidar", _lidar(rng), pose(space))
    cameras = [pe.Sensor(name, _camera(rng), pose(space)) for name in ("camera", "other")]
    vehicle = _vehicle(rng, ends)
    if lidar.model.name == ROUND and rng.random() < 0.6:  # beams through edges of voxels
        vehicle = None
        turn = tuple(rng.choice(QUARTERS_DEG, 3))
        lidar = lidar.moved(pe.Pose.from_degrees(lidar.pose.position, turn))
    if vehicle is not None:
        lidar = lidar.moved(_off_edges(lidar.pose))
    return Scene(space, vehicle, pe.Rig([lidar, *cameras]))


def _off_edges(pose):
    """Turned by a little: rounding decides whether a beam exactly along a vehicle's edge ends."""
    return pe.Pose.from_degrees(pose.position, pose.rotation_deg + np.array([0.0, 0.0, 0.3]))


def _lidar(rng):
    """Channels at odd angles, or at round ones: those run through edges of voxels when turned."""
    if rng.random() < 0.4:
        elevations = np.radians(rng.permutation(ROUND_CHANNELS_DEG)[: rng.integers(1, 5)])
        return pe.Lidar(ROUND, np.sort(elevations), int(rng.choice([12, 24, 72])), 60.0)
    channels = int(rng.choice([1, 5, 16]))
    azimuths = int(rng.choice([60, 90, 120]))
    return shapes.small_lidar(channels, azimuths, max_range=float(rng.choice([2.0, 60.0])))


def _camera(rng):
    width, height = (int(n) for n in rng.choice([480, 640, 1080], 2))
    return pe.Camera("camera", width, height, math.radians(float(rng.choice([40, 60, 90, 120]))))


def _round_pose(rng, space):
    halves = [rng.integers(-2 * n, 2 * n + 1) / 2.0 for n in HALF_SHAPE]
    halves[2] = abs(halves[2])
    position = np.round(np.array(halves) * space.interval, 9)
    if rng.random() < 0.3:  # on an edge or a face
        position[rng.integers(3)] += round(rng.uniform(0.0, space.interval), 5)
    yaw, pitch, roll = rng.choice(ROUND_DEG, 3) * (1, rng.random() < 0.5, rng.random() < 0.3)
    return pe.Pose.from_degrees(position, (roll, pitch, yaw))


def _free_pose(rng, space):
    reach = np.array(HALF_SHAPE) * space.interval
    position = rng.uniform(-reach, reach)
    position[2] = abs(position[2])
    return pe.Pose.from_degrees(position, rng.uniform(-180.0, 180.0, 3))


def _vehicle(rng, ends):
    """None, or a body and a cabin of round measures."""
    if rng.random() < 0.3:
        return None
    half = np.round(np.array(ends) * rng.choice([0.2, 0.25, 0.3, 0.4]), 2)
    body = shapes.box((-half[0], -half[1], 0.0), half)
    top = half[2] + round(0.2 * ends[2], 2)
    cabin = shapes.box((-half[0] / 2, -half[1], half[2]), (half[0] / 4, half[1] / 2, top))
    return pe.Vehicle(np.concatenate([body, cabin]))

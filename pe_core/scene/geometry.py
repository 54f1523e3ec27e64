"""Poses and rotations.

Everything here is written out in plain products, never as a matrix product: BLAS builds differ in
the last bit, and a study must score the same in Blender's Python and in everybody else's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..text.degrees import degrees_in_file
from ..text.values import Angle, Number, vector

Floats = NDArray[np.float64]

FARTHEST_M = 1e4
"""No sensor of a vehicle is farther from it than this; kernels count on it."""
TURNS_DEG = 3600.0
"""Ten turns: an angle beyond is taken for a slip of the pen."""
METRES = Number(-FARTHEST_M, FARTHEST_M, unit="m")
ROTATION = Angle(-TURNS_DEG, TURNS_DEG)
ROTATION_DEG = Number(-TURNS_DEG, TURNS_DEG, unit="degrees")


@dataclass(frozen=True, slots=True)
class Pose:
    """Where a sensor sits: its extrinsics in the ground frame.

    Parameters
    ----------
    position : (3,) float
        x forward, y left, z up, from the ground under the vehicle's centre [m].
    rpy : (3,) float
        Roll, pitch, yaw [rad]; ``ground_from_sensor = Rz(yaw) Ry(pitch) Rx(roll)``.
        Positive pitch is nose down.

    Angles are kept as a file's degrees give them back: one that is the `math.radians` of no float
    moves by a unit in its last place.

    Raises
    ------
    InputError
        When a number is missing, NaN or infinite, a position beyond 10 km or an angle beyond ten
        turns.
    """

    position: tuple[float, float, float]
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        position = vector("pose", "position", self.position, 3, METRES)
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rpy", vector("pose", "rpy", self.rpy, 3, ROTATION))

    @classmethod
    def from_degrees(cls, position: ArrayLike, rotation_deg: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Pose from roll, pitch and yaw in degrees, as files and the user interface hold them."""
        degrees = vector("pose", "rotation", rotation_deg, 3, ROTATION_DEG)
        roll, pitch, yaw = (math.radians(d) for d in degrees)
        return cls(position, (roll, pitch, yaw))  # type: ignore[arg-type]  # checked when made

    @property
    def rotation_deg(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw [deg], rounded so that `from_degrees` gives the same bits again."""
        roll, pitch, yaw = (degrees_in_file(a) for a in self.rpy)
        return roll, pitch, yaw

    @property
    def ground_from_sensor(self) -> Floats:
        """(3, 3) rotation from the sensor frame to the ground frame (G of eq. 1)."""
        return rotation_matrix(*self.rpy)


def rotation_matrix(roll: float, pitch: float, yaw: float) -> Floats:
    """``Rz(yaw) Ry(pitch) Rx(roll)``: Blender's XYZ Euler, URDF's rpy. Angles in radians."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_matrix(rotation: Floats) -> tuple[float, float, float]:
    """Roll, pitch, yaw [rad] of a (3, 3) rotation; roll is 0 where pitch is +-90 degrees."""
    forward_xy = math.hypot(rotation[0, 0], rotation[1, 0])
    pitch = math.atan2(-rotation[2, 0], forward_xy)
    if forward_xy < 1e-6:  # gimbal lock: roll and yaw turn about the same axis
        return 0.0, pitch, math.atan2(-rotation[0, 1], rotation[1, 1])
    roll = math.atan2(rotation[2, 1], rotation[2, 2])
    return roll, pitch, math.atan2(rotation[1, 0], rotation[0, 0])


def rotate(rotation: Floats, points: Floats) -> Floats:
    """Rotate (..., 3) points by a (3, 3) matrix."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in rotation], axis=-1)


def dot(a: Floats, b: Floats) -> Floats:
    """Row-wise scalar product of (..., 3) vectors."""
    product = a * b
    return product[..., 0] + product[..., 1] + product[..., 2]


def cross(a: Floats, b: Floats) -> Floats:
    """Row-wise vector product of (..., 3) vectors; ``cross(b, a) == -cross(a, b)`` to the bit."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)

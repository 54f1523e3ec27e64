"""Poses and rotations.

Everything here is written out in plain products, never as a matrix product: BLAS builds differ in
the last bit, and a study must score the same in Blender's Python and in everybody else's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

Floats = NDArray[np.float64]

FARTHEST_M = 1e4
"""No sensor of a vehicle is farther from it than this; kernels count on it."""
ROUND_TRIP_DECIMALS_DEG = 9
"""Degrees are written with this many decimals: what a file says is then exactly what was scored."""


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

    Raises
    ------
    InputError
        When a number is missing, NaN or infinite, or a position beyond 10 km.
    """

    position: tuple[float, float, float]
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        position = three_numbers("pose", "position", self.position)
        if max(map(abs, position)) > FARTHEST_M:
            expected = f"three numbers within +-{FARTHEST_M:g} m"
            raise InputError("pose", "position", expected, position)
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rpy", three_numbers("pose", "rpy", self.rpy))

    @classmethod
    def from_degrees(cls, position: ArrayLike, rotation_deg: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Pose from roll, pitch and yaw in degrees, as files and the user interface hold them."""
        degrees = three_numbers("pose", "rotation", rotation_deg)
        radians = (math.radians(degrees[0]), math.radians(degrees[1]), math.radians(degrees[2]))
        return cls(three_numbers("pose", "position", position), radians)

    @property
    def rotation_deg(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw [deg], rounded so that `from_degrees` gives the same bits again."""
        roll, pitch, yaw = (round(math.degrees(a), ROUND_TRIP_DECIMALS_DEG) + 0.0 for a in self.rpy)
        return roll, pitch, yaw

    @property
    def ground_from_sensor(self) -> Floats:
        """(3, 3) rotation from the sensor frame to the ground frame (inverse of R in eq. 1)."""
        return rotation_matrix(*self.rpy)


def three_numbers(source: str, field: str, values: ArrayLike) -> tuple[float, float, float]:
    """Return three finite floats, or raise `InputError`."""
    try:
        numbers = tuple(float(v) for v in values)  # type: ignore[union-attr, arg-type]
    except (TypeError, ValueError):
        numbers = ()
    if len(numbers) != 3 or not all(math.isfinite(v) for v in numbers):
        raise InputError(source, field, "three finite numbers", repr(values))
    return numbers


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

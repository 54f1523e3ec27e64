"""Poses and rotations.

All products are written out. Matrix products are not used: BLAS builds differ in the last bit, and
a study must have the same score in every Python, including Blender's.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.errors import InputError
from ..base.setting import Part, Triple
from ..base.values import Angle, Number, degrees_in_file, numbers, vector

FARTHEST_M = 1e4  # Maximum magnitude of a coordinate; kernels rely on it
TURNS_DEG = 3600.0
"""Maximum magnitude of an angle, ten turns: more is probably a mistake."""
METRES = Number(-FARTHEST_M, FARTHEST_M, unit="m")
ROTATION = Angle(-TURNS_DEG, TURNS_DEG)
ROTATION_DEG = Number(-TURNS_DEG, TURNS_DEG, unit="degrees")
PROPER_WITHIN = 1e-4
"""Maximum deviation of a matrix from a rotation: files and single precision round."""
UPRIGHT = (0.0, 0.0, 0.0)
LAST_ROW = (0.0, 0.0, 0.0, 1.0)
"""Of a homogeneous matrix that moves columns."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Position and rotation of a sensor in the ground frame: its extrinsics.

    `InputError` when a number is missing, NaN or infinite, a position beyond 10 km or an angle
    beyond ten turns.

    Parameters
    ----------
    position : (3,) float
        x forward, y left, z up, from the ground under the vehicle's centre [m].
    rpy : (3,) float
        Roll, pitch, yaw [rad]; ``ground_from_sensor = Rz(yaw) Ry(pitch) Rx(roll)``.
        Positive pitch is nose down.

    Angles are rounded so that a file, which has degrees, restores the same bits: an angle that is
    not `math.radians` of any float changes by one unit in the last place.
    """

    position: Annotated[tuple[float, float, float], Part(rule=Triple(METRES))]
    rpy: Annotated[tuple[float, float, float], Part(key="rotation", rule=Triple(ROTATION))] = (
        UPRIGHT
    )

    def __post_init__(self) -> None:
        position = vector("pose", "position", self.position, count=3, rule=METRES)
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rpy", vector("pose", "rpy", self.rpy, count=3, rule=ROTATION))

    @classmethod
    def from_degrees(cls, position: ArrayLike, rotation_deg: ArrayLike = (0.0, 0.0, 0.0)) -> "Pose":
        """Return a pose with roll, pitch and yaw in degrees, as in files and the user interface."""
        degrees = vector("pose", "rotation", rotation_deg, count=3, rule=ROTATION_DEG)
        roll, pitch, yaw = (math.radians(d) for d in degrees)
        return cls(position, (roll, pitch, yaw))  # type: ignore[arg-type]  # checked when made

    @classmethod
    def from_matrix(cls, ground_from_sensor: ArrayLike) -> "Pose":
        """Return the pose of a homogeneous matrix, ``ground = matrix @ sensor`` on columns.

        `InputError` when the shape is another, the last row is not 0, 0, 0, 1 (as of the transposed
        matrix), or the rotation scales, shears or mirrors.

        Parameters
        ----------
        ground_from_sensor : (4, 4) or (3, 4) float
            Rotation and position [m] of the sensor's frame: x forward, y left, z up.
        """
        matrix = numbers(ground_from_sensor)
        if matrix is None or matrix.shape not in ((4, 4), (3, 4)):
            found = "no array of numbers" if matrix is None else f"shape {matrix.shape}"
            raise InputError("pose", "matrix", "shape (4, 4) or (3, 4)", found)
        if not np.isfinite(matrix).all():
            raise InputError("pose", "matrix", "finite numbers", "others")
        if not (np.abs(matrix[3:] - LAST_ROW) <= PROPER_WITHIN).all():
            raise InputError("pose", "matrix", "a last row 0, 0, 0, 1", str(matrix[3].tolist()))
        rotation = checked_rotation("pose", "matrix", matrix[:3, :3])
        return cls(matrix[:3, 3], rpy_from_matrix(rotation))  # type: ignore[arg-type]

    @classmethod
    def from_quaternion(cls, position: ArrayLike, wxyz: ArrayLike) -> "Pose":
        """Return a pose with the rotation of a quaternion.

        `InputError` when a number is missing, or the quaternion is not of length 1.

        Parameters
        ----------
        position : (3,) float
            As of a pose [m].
        wxyz : (4,) float
            Unit quaternion, the real part first, from the sensor frame to the ground frame.
        """
        rotation = from_quaternion("pose", "wxyz", vector("pose", "wxyz", wxyz, 4))
        return cls(position, rpy_from_matrix(rotation))  # type: ignore[arg-type]

    @property
    def matrix(self) -> Floats:
        """(4, 4) homogeneous matrix from the sensor frame to the ground frame [m]."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.ground_from_sensor
        matrix[:3, 3] = self.position
        return matrix

    @property
    def rotation_deg(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw [deg], rounded so that `from_degrees` restores the same bits."""
        roll, pitch, yaw = (degrees_in_file(a) for a in self.rpy)
        return roll, pitch, yaw

    @property
    def ground_from_sensor(self) -> Floats:
        """(3, 3) rotation from the sensor frame to the ground frame (G of eq. 1)."""
        return rotation_matrix(*self.rpy)


def rotation_matrix(roll: float, pitch: float, yaw: float) -> Floats:
    """Return ``Rz(yaw) Ry(pitch) Rx(roll)``, (3, 3): Blender's XYZ Euler, URDF's rpy [rad]."""
    cr = math.cos(roll)
    sr = math.sin(roll)
    cp = math.cos(pitch)
    sp = math.sin(pitch)
    cy = math.cos(yaw)
    sy = math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_matrix(rotation: Floats) -> tuple[float, float, float]:
    """Return roll, pitch, yaw [rad] of a (3, 3) rotation; roll is 0 if pitch is +-90 degrees."""
    forward_xy = math.hypot(rotation[0, 0], rotation[1, 0])
    pitch = math.atan2(-rotation[2, 0], forward_xy)
    if forward_xy < 1e-6:  # gimbal lock: roll and yaw turn about the same axis
        return 0.0, pitch, math.atan2(-rotation[0, 1], rotation[1, 1])
    roll = math.atan2(rotation[2, 1], rotation[2, 2])
    return roll, pitch, math.atan2(rotation[1, 0], rotation[0, 0])


def from_quaternion(source: object, field: str, values: Sequence[float]) -> Floats:
    """Return the (3, 3) rotation of a quaternion (w, x, y, z), or raise `InputError`."""
    norm = math.sqrt(sum(v * v for v in values))
    if not 0.5 < norm < 2.0:
        raise InputError(source, field, "a quaternion of length 1", f"one of length {norm:g}")
    w, x, y, z = (v / norm for v in values)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def checked_rotation(source: object, field: str, rotation: Floats) -> Floats:
    """Return a (3, 3) rotation; raise `InputError` if it is not a rotation, or if it mirrors."""
    off = np.abs(rotate(rotation, rotation) - np.eye(3)).max()
    if not off < PROPER_WITHIN:
        raise InputError(source, field, "a rotation", f"rows off by {off:.2g} from right angles")
    if dot(cross(rotation[0], rotation[1]), rotation[2]) < 0.0:
        raise InputError(source, field, "a right-handed rotation", "a rotation that mirrors")
    return rotation


def rotate(rotation: Floats, points: Floats) -> Floats:
    """Return points (..., 3) rotated by a matrix (3, 3)."""
    x = points[..., 0]
    y = points[..., 1]
    z = points[..., 2]
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in rotation], axis=-1)


def dot(a: Floats, b: Floats) -> Floats:
    """Return the row-wise scalar product (...,) of vectors (..., 3)."""
    product = a * b
    return product[..., 0] + product[..., 1] + product[..., 2]


def cross(a: Floats, b: Floats) -> Floats:
    """Return the row-wise cross product of (..., 3); ``cross(b, a)`` is bitwise the negative."""
    ax = a[..., 0]
    ay = a[..., 1]
    az = a[..., 2]
    bx = b[..., 0]
    by = b[..., 1]
    bz = b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)

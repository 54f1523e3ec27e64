"""A pose from a quaternion and a place, as data sets publish their calibrations."""

from __future__ import annotations

from collections.abc import Sequence

from ..scene.geometry import METRES, Pose
from ..text.values import vector
from .frames import BODY_FROM_OPTICAL, composed, from_quaternion, pose_of, product, turned

ASKING = "calibration"


def pose_from_quaternion(
    rotation: Sequence[float],
    translation: Sequence[float],
    *,
    optical: bool = False,
    inverse: bool = False,
    within: Pose | None = None,
) -> Pose:
    """Return a sensor's pose from a calibration.

    Parameters
    ----------
    rotation : (4,) float
        Quaternion w, x, y, z: from the sensor's axes to its parent's.
    translation : (3,) float
        Where the sensor is in its parent [m].
    optical : bool
        Whether the sensor's axes are a camera's optical ones: z forward, x right, y down.
    inverse : bool
        Whether both are given the other way round: from the parent to the sensor.
    within : Pose, optional
        Where the parent is; else it is the ground frame.

    Raises
    ------
    InputError
        When a number is missing, or the quaternion is none.
    """
    place: Sequence[float] = vector(ASKING, "translation", translation, 3, METRES)
    turn = from_quaternion(ASKING, "rotation", vector(ASKING, "rotation", rotation, 4))
    if inverse:
        turn = turn.T
        place = [-value for value in turned(turn, place)]
    if optical:
        turn = product(turn, BODY_FROM_OPTICAL.T)
    pose = pose_of(turn, place)
    return pose if within is None else composed(within, pose)

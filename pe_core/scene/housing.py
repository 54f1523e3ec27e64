"""A sensor's housing: its size as a data sheet gives it, and where it cuts into the body.

A housing is shown and checked; it never changes a score.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats
from ..base.values import A_TEXT, LENGTH, Number, choice, vector
from ..geometry.overlap import Hull, meets_box, meets_cylinder, upright_hull
from ..geometry.poses import Pose, dot, rotate
from .vehicle import Vehicle

SHAPES = ("cylinder", "box")
SEAT_M = 0.003
"""An overlap with the body up to this depth is a seat: a gasket, or a roof that is not flat."""
NEAR = Number(-10.0, 10.0, unit="m")


@dataclass(frozen=True, slots=True)
class Housing:
    """A sensor's outer shape, upright in the sensor frame.

    Parameters
    ----------
    shape : str
        ``"cylinder"``, its axis along z, or ``"box"``.
    size : (3,) float
        Along x, y and z [m]; for a cylinder: diameter, diameter, height.
    optical_center : (3,) float
        Origin of the sensor frame, relative to the middle of the housing's base [m].
    source : str
        Source of the figures, and assumptions.

    Raises
    ------
    InputError
        When the shape is unknown, or a size is not above 0.
    """

    shape: str
    size: tuple[float, float, float]
    optical_center: tuple[float, float, float]
    source: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "shape", choice("housing", "shape", self.shape, SHAPES))
        put(self, "size", vector("housing", "size", self.size, 3, LENGTH))
        center = vector("housing", "optical_center", self.optical_center, 3, NEAR)
        put(self, "optical_center", center)
        if self.source:
            put(self, "source", A_TEXT.checked("housing", "source", self.source))

    @property
    def center(self) -> Floats:
        """(3,) middle of the housing in the sensor frame [m]."""
        return np.array([0.0, 0.0, self.size[2] / 2.0]) - np.array(self.optical_center)


def cuts_body(
    pose: Pose, housing: Housing, vehicle: Vehicle, seat: float = SEAT_M
) -> tuple[str, ...]:
    """Return the parts of the vehicle that intersect a sensor's housing.

    Parameters
    ----------
    pose : Pose
        Pose of the sensor, ground frame.
    housing : Housing
    vehicle : Vehicle
    seat : float
        Overlap up to this depth, from any side, that is allowed [m].

    Returns
    -------
    tuple of str
        Names of the parts, in the vehicle's order; empty if nothing intersects. A housing that is
        completely inside a closed body intersects no triangle, so this is not detected.
    """
    half = np.array(housing.size) / 2.0 - seat
    if half.min() <= 0.0:
        return ()
    rotation = pose.ground_from_sensor
    middle = np.array(pose.position) + rotate(rotation, housing.center)
    reach = float(np.sqrt(dot(np.array(housing.size), np.array(housing.size)))) / 2.0
    faces = vehicle.faces_near(middle, reach)
    near = rotate(rotation.T, vehicle.triangles[faces] - middle)  # along the housing's axes
    overlapping = ((near.min(axis=1) <= half) & (near.max(axis=1) >= -half)).all(axis=1)
    near, faces = near[overlapping], faces[overlapping]
    if not len(faces):
        return ()
    inside = (meets_box if housing.shape == "box" else meets_cylinder)(near, half)
    part_indices = np.unique(np.asarray(vehicle.parts)[faces[inside]])
    return tuple(vehicle.part_names[part] for part in part_indices)


def hull_of(pose: Pose, housing: Housing | None) -> Hull:
    """Return the convex hull of a housing at a pose; without a housing only the position."""
    if housing is None:
        return Hull(np.array(pose.position)[None], np.zeros((0, 3)), np.zeros((0, 3)))
    return upright_hull(housing.shape, pose, housing.center, np.array(housing.size))

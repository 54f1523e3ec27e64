"""A sensor's housing: its size as a data sheet gives it, and where it cuts into the body.

It is told, and drawn; it is never part of a score.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..text.values import A_TEXT, LENGTH, Number, choice, vector
from .geometry import Floats, Pose, cross, dot, rotate
from .vehicle import Vehicle

SHAPES = ("cylinder", "box")
SEAT_M = 0.003
"""What touches the body no deeper than this stands on it: a gasket, or a roof that is not flat."""
NEAR = Number(-10.0, 10.0, unit="m")


@dataclass(frozen=True, slots=True)
class Housing:
    """A sensor's outer shape, upright in the sensor frame.

    Parameters
    ----------
    shape : str
        ``"cylinder"``, its axis along z, or ``"box"``.
    size : (3,) float
        Along x, y and z [m]; a cylinder's diameter twice and its height.
    optical_center : (3,) float
        Where the sensor frame's origin is, from the middle of the housing's base [m].
    source : str
        Where the figures come from, and what is assumed.

    Raises
    ------
    InputError
        When the shape is none of the two, or a size is not above 0.
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
    """Parts of the vehicle that reach into a sensor's housing.

    Parameters
    ----------
    pose : Pose
        Of the sensor, ground frame.
    housing : Housing
    vehicle : Vehicle
    seat : float
        A part that reaches in no deeper than this from any side does not count [m].

    Returns
    -------
    tuple of str
        Their names, in the vehicle's order; empty when the housing stands free. A housing that is
        wholly inside a closed body meets none of its triangles, and is not told.
    """
    half = np.array(housing.size) / 2.0 - seat
    if half.min() <= 0.0:
        return ()
    near, faces = _triangles_near(pose, housing, vehicle, half)
    if not len(faces):
        return ()
    inside = (_meets_box if housing.shape == "box" else _meets_cylinder)(near, half)
    found = np.unique(np.asarray(vehicle.parts)[faces[inside]])
    return tuple(vehicle.part_names[part] for part in found)


def _triangles_near(
    pose: Pose, housing: Housing, vehicle: Vehicle, half: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """Triangles (N, 3, 3) round a housing in its own frame, its middle the origin; which they are.

    Only what comes near its box of half sizes (3,) is told; shapes are exact further on.
    """
    rotation = pose.ground_from_sensor
    middle = np.array(pose.position) + rotate(rotation, housing.center)
    reach = float(np.sqrt(dot(np.array(housing.size), np.array(housing.size)))) / 2.0
    faces = vehicle.faces_near(middle, reach)
    near = rotate(rotation.T, vehicle.triangles[faces] - middle)
    least, most = near.min(axis=1), near.max(axis=1)
    some = ((least <= half) & (most >= -half)).all(axis=1)
    return near[some], faces[some]


def _meets_box(triangles: Floats, half: Floats) -> NDArray[np.bool_]:
    """Whether triangles (N, 3, 3) meet the box of half sizes (3,) round the origin.

    By separating axes: the box's, the triangle's normal, and edges crossed with the box's axes
    (Akenine-Moller, Fast 3D Triangle-Box Overlap Testing, 2001).
    """
    edges = np.roll(triangles, -1, axis=1) - triangles
    axes = [np.broadcast_to(axis, (len(triangles), 3)) for axis in np.eye(3)]
    axes += [cross(edges[:, 0], edges[:, 1])]
    axes += [cross(edges[:, k], axis) for k in range(3) for axis in axes[:3]]
    meets = np.ones(len(triangles), bool)
    for axis in axes:
        along = dot(triangles, axis[:, None])
        reach = dot(np.abs(axis), half)
        meets &= (along.min(axis=1) <= reach) & (along.max(axis=1) >= -reach)
    return meets


def _meets_cylinder(triangles: Floats, half: Floats) -> NDArray[np.bool_]:
    """Whether triangles (N, 3, 3) meet the upright cylinder round the origin.

    A triangle between the two end planes is a polygon: its edges there and its sections with the
    planes. It meets the cylinder when one of them comes near the axis, or the axis goes through it.
    """
    radius, top = half[0], half[2]
    meets = _axis_goes_through(triangles, top)
    for start in range(3):
        ends = triangles[:, start], triangles[:, (start + 1) % 3]
        meets |= _nearest_on_edge(*ends, top) <= radius
    for height in (-top, top):
        meets |= _nearest_on_section(triangles, height) <= radius
    return meets


def _axis_goes_through(triangles: Floats, top: float) -> NDArray[np.bool_]:
    """Whether the z axis between -top and top goes through triangles."""
    flat = triangles[..., :2]
    a, b, c = (flat[:, k] for k in range(3))
    weights = np.stack([_turn(b, c), _turn(c, a), _turn(a, b)], axis=1)
    area = weights.sum(axis=1)
    around = ((weights >= 0.0).all(axis=1) | (weights <= 0.0).all(axis=1)) & (area != 0.0)
    height = dot(weights, triangles[..., 2]) / np.where(area == 0.0, 1.0, area)
    return around & (np.abs(height) <= top)


def _nearest_on_edge(start: Floats, end: Floats, top: float) -> Floats:
    """How near the parts of edges (N, 3) between heights -top and top come to the axis, or inf."""
    rise = end[:, 2] - start[:, 2]
    level = rise == 0.0
    steps = [(height - start[:, 2]) / np.where(level, 1.0, rise) for height in (-top, top)]
    first = np.where(level, 0.0, np.maximum(np.minimum(*steps), 0.0))
    last = np.where(level, 1.0, np.minimum(np.maximum(*steps), 1.0))
    outside = (first > last) | (level & (np.abs(start[:, 2]) > top))
    along = end - start
    ends = (start + t[:, None] * along for t in (first, last))
    return np.where(outside, np.inf, _nearest(*(each[:, :2] for each in ends)))


def _nearest_on_section(triangles: Floats, height: float) -> Floats:
    """How near the sections (N,) of triangles with a level plane come to the axis, or inf."""
    over = triangles[..., 2] > height
    lonely = np.argmax(over == (over.sum(axis=1) == 1)[:, None], axis=1)
    row = np.arange(len(triangles))
    one = triangles[row, lonely]
    ends = []
    for step in (1, 2):
        other = triangles[row, (lonely + step) % 3]
        rise = other[:, 2] - one[:, 2]
        t = (height - one[:, 2]) / np.where(rise == 0.0, 1.0, rise)
        ends.append((one + t[:, None] * (other - one))[:, :2])
    cut = over.any(axis=1) & ~over.all(axis=1)
    return np.where(cut, _nearest(*ends), np.inf)


def _nearest(start: Floats, end: Floats) -> Floats:
    """Distance (N,) from the origin to segments of the plane, ends (N, 2)."""
    along = end - start
    size = (along**2).sum(axis=1)
    t = np.clip(-(start * along).sum(axis=1) / np.where(size == 0.0, 1.0, size), 0.0, 1.0)
    point = start + t[:, None] * along
    return np.sqrt((point**2).sum(axis=1))


def _turn(a: Floats, b: Floats) -> Floats:
    """Twice the signed area of the triangle that the origin forms with points (N, 2)."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]

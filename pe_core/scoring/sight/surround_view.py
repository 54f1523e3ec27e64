"""Surround view: which camera shows each square of the ground round the vehicle.

Surround-view systems stitch the pictures of their cameras on flat ground. A square belongs to the
camera with the most pixels per metre there, of those that see it: among equal ones the nearest.
Ground that no camera sees is blind.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import Flags, Floats, Ints, read_only
from ...base.errors import InputError
from ...base.notebook import ShortRepr
from ...geometry.poses import dot
from ...scene.rig import Rig, Sensor
from ...sensors import kind_of
from .blind_ground import BlindSearch, area_of

NO_CAMERA = -1
VEHICLE = -2


@dataclass(frozen=True, slots=True, eq=False)
class SurroundView(ShortRepr):
    """Flat ground as the cameras of a rig show it, in squares.

    Attributes
    ----------
    x : (NX,) float
    y : (NY,) float
        Middles of the squares [m].
    step : float
        Side of a square [m].
    cameras : tuple of str
        Names of the cameras.
    camera : (NX, NY) int
        Number of the camera with the most pixels per metre there, of those to which the square is
        not blind; `NO_CAMERA`, or `VEHICLE` with the vehicle over the middle.
    blind : (NX, NY) bool
        Squares that are blind to all cameras together: those of `Sight.blind`.
    area : float
        Area of the blind squares [m2].
    """

    x: Floats
    y: Floats
    step: float
    cameras: tuple[str, ...]
    camera: Ints
    blind: Flags
    area: float


def surround_view(search: BlindSearch, rig: Rig) -> SurroundView:
    """Return what the sensors of a rig that have a picture show of the squares of a search for
    bodies that lie flat; `InputError` when there is none."""
    pictured = [sensor for sensor in rig if kind_of(sensor).pixels_per_radian(sensor.model)]
    if not pictured:
        raise InputError("sight", "surround view", "a rig with a camera", "none")
    cameras = Rig(pictured)
    cells = search.cells
    blind = search.blind(cameras)
    blind_alone = search.by_sensor()
    covered = search.covered
    camera = np.where(covered, VEHICLE, NO_CAMERA)
    most = np.zeros(cells.shape)
    for number, sensor in enumerate(cameras):
        i, j = np.nonzero(~blind_alone[sensor.name] & ~covered)
        pixels = pixels_per_m(sensor, np.column_stack([cells.x[i], cells.y[j]]))
        more = pixels > most[i, j]
        most[i[more], j[more]] = pixels[more]
        camera[i[more], j[more]] = number
    names = tuple(sensor.name for sensor in cameras)
    return SurroundView(
        read_only(cells.x),
        read_only(cells.y),
        cells.step,
        names,
        camera=read_only(camera),
        blind=read_only(blind),
        area=area_of(cells, blind),
    )


def pixels_per_m(sensor: Sensor, points: Floats) -> Floats:
    """Return a camera's pixels per metre (N,) of what stands at points (N, 2) of the ground, as if
    it were in the middle of the picture: edges of wide lenses have more, but blurred, ones."""
    x, y, height = sensor.pose.position
    offsets = np.column_stack([points - (x, y), np.full(len(points), height)])
    return kind_of(sensor).pixels_per_radian(sensor.model) / np.sqrt(dot(offsets, offsets))

"""The still: vehicle, ground and sensors from a point of view, where nothing else draws them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, pe
from .drawing import drawn
from .housings import sensor_solids
from .painted import painted_vehicle
from .shading import Surroundings, from_srgb
from .tableau import Tableau
from .viewpoint import Viewpoint

Floats = NDArray[np.float64]

SIZE = (960, 540)
FOV_DEG = 26.0
FROM = np.array([0.80, -0.58, 0.29])
"""Where the usual point of view is: ahead, on the right, a little above."""
PAPER = from_srgb(np.array([0.965, 0.97, 0.975]))
FLOOR = from_srgb(np.array([0.905, 0.912, 0.92]))
SUN = np.array([0.45, -0.62, 1.05])
NO_BODY = (np.array([-2.0, -1.0, 0.0]), np.array([2.0, 1.0, 1.5]))


def still(
    vehicle: pe.Vehicle | None,
    rig: pe.Rig,
    size: tuple[int, int] = SIZE,
    view: Viewpoint | None = None,
) -> bytes:
    """Return a picture of a rig on its vehicle as a PNG file.

    Parameters
    ----------
    vehicle : Vehicle or None
    rig : Rig
        Sensors are drawn in their housings, or as small boxes where these are not known.
    size : (width, height) int
        [px]
    view : Viewpoint, optional
        From ahead and the right by default, all of the vehicle in the picture.
    """
    width, height = size
    view = view or usual_view(vehicle, rig, size)
    shot = view.shot(width, height)
    solids = [] if vehicle is None else [painted_vehicle(vehicle)]
    stage = Tableau([*solids, *sensor_solids(rig)], vehicle is not None)
    picture = drawn(shot, stage, _studio(_bounds(vehicle, rig)))
    return graphics.png_bytes(graphics.as_bytes(picture))


def usual_view(vehicle: pe.Vehicle | None, rig: pe.Rig, size: tuple[int, int] = SIZE) -> Viewpoint:
    """Return the point of view from which all of a vehicle fits into a picture."""
    low, high = _bounds(vehicle, rig)
    target = (low + high) / 2.0
    corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, 8).T
    way = FROM / math.sqrt(float(FROM @ FROM))
    far = 2.0 * float(np.abs(high - low).max())
    for _ in range(4):  # each comes nearer to filling the picture
        view = _view(target + way * far, target)
        right, down = view.project(corners, *size)
        spans = (right.max() - right.min()) / size[0], (down.max() - down.min()) / size[1]
        far *= max(spans) / 0.84
    right, down = view.project(corners, *size)
    return _view(target + way * far, target)


def _view(eye: Floats, target: Floats) -> Viewpoint:
    return Viewpoint(tuple(eye.tolist()), tuple(target.tolist()), FOV_DEG)


def _bounds(vehicle: pe.Vehicle | None, rig: pe.Rig) -> tuple[Floats, Floats]:
    places = np.array([sensor.pose.position for sensor in rig])
    low, high = NO_BODY if vehicle is None else vehicle.bounds
    return np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))


def _studio(bounds: tuple[Floats, Floats]) -> Surroundings:
    """A bright room without walls: the floor fades into the paper."""
    low, high = bounds
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    reach = float(np.hypot(half[0], half[1]))

    def ground(points: Floats, _: Floats) -> Floats:
        return np.tile(FLOOR, (len(points), 1))

    def haze(points: Floats) -> Floats:
        away = np.hypot(points[:, 0] - middle[0], points[:, 1] - middle[1]) / reach
        part = np.clip((away - 1.0) / 1.6, 0.0, 1.0)
        return part * part * (3.0 - 2.0 * part)

    return Surroundings(ground, lambda rays: np.tile(PAPER, (len(rays), 1)), SUN, haze)

"""What a camera sees, through its own lens: its vehicle, the ground in rings, people and cars."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, kinds, pe, scene
from .company import DISTANCES, Companion, company
from .drawing import drawn
from .marked import MarkedPicture
from .painted import painted_vehicle
from .shading import Surroundings, from_srgb
from .tableau import Tableau
from .viewpoint import Viewshot

Floats = NDArray[np.float64]

MOST_WIDE, MOST_HIGH = 640, 480
ROAD, RING = from_srgb(np.array([0.50, 0.51, 0.52])), from_srgb(np.array([0.93, 0.94, 0.95]))
ZENITH, HORIZON = from_srgb(np.array([0.62, 0.74, 0.86])), from_srgb(np.array([0.90, 0.92, 0.93]))
SUN = np.array([-0.35, 0.5, 1.0])
"""In the sensor's heading: from behind, on the left."""
RING_M = 0.05
"""Half the width of a ring's line."""
THINNEST_PX = 0.6
FADED_M = (30.0, 160.0)
"""From where to where the ground fades into the horizon."""


def camera_picture(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> MarkedPicture:
    """Return what a camera on a vehicle sees, people and cars of known size before it.

    Parameters
    ----------
    sensor : Sensor
        A camera.
    vehicle : Vehicle or None
    """
    shot, scale = camera_shot(sensor)
    others = company(sensor, _camera_of(sensor).hfov / 2.0, vehicle)
    solids = [] if vehicle is None else [painted_vehicle(vehicle)]
    tableau = Tableau([*solids, *(each.body for each in others)], vehicle is not None)
    picture = drawn(shot, tableau, _road(sensor))
    png = graphics.png_bytes(graphics.as_bytes(picture))
    return MarkedPicture(png, shot.width, shot.height, _marks(sensor, others, shot, scale))


def camera_shot(sensor: pe.Sensor) -> tuple[Viewshot, float]:
    """Return a camera's own picture to be taken, no larger than a page has room for; its scale."""
    camera = _camera_of(sensor)
    scale = min(1.0, MOST_WIDE / camera.width, MOST_HIGH / camera.height)
    width, height = (max(1, round(n * scale)) for n in (camera.width, camera.height))
    across, down = camera.width / width, camera.height / height
    lens, turned = camera.projection, sensor.pose.ground_from_sensor

    def look(x: Floats, y: Floats) -> Floats:
        return scene.rotate(turned, lens.unproject(x * across, y * down))

    middle = np.array([width / 2.0, width / 2.0 + 1.0])
    one, two = look(middle, np.full(2, height / 2.0))
    pixel_rad = math.sqrt(float(((two - one) ** 2).sum()))
    eye = np.array(sensor.pose.position)
    return Viewshot(eye, width, height, look, pixel_rad, True), 1.0 / across


def _marks(
    sensor: pe.Sensor, others: list[Companion], shot: Viewshot, scale: float
) -> tuple[tuple[float, float, str], ...]:
    """Distances above heads and roofs, where these are in the picture."""
    camera, found = _camera_of(sensor), []
    for each in others:
        way = scene.rotate(
            sensor.pose.ground_from_sensor.T, np.subtract(each.top, sensor.pose.position)[None]
        )
        theta = math.atan2(math.hypot(way[0, 1], way[0, 2]), way[0, 0])
        if theta < camera.projection.edge:
            x, y = (float(v[0]) * scale for v in camera.projection.project(*way.T))
            if 0.0 <= x <= shot.width and 0.0 <= y <= shot.height:
                found.append((round(x, 1), round(y, 1), each.label))
    return tuple(found)


def _camera_of(sensor: pe.Sensor) -> kinds.Camera:
    assert isinstance(sensor.model, kinds.Camera)
    return sensor.model


def _road(sensor: pe.Sensor) -> Surroundings:
    """A road with rings round the sensor's foot, under a clear sky."""
    foot = np.array(sensor.pose.position[:2])
    turned = sensor.pose.ground_from_sensor[:2, 0]
    heading = math.atan2(float(turned[1]), float(turned[0]))
    c, s = math.cos(heading), math.sin(heading)
    sun = np.array([c * SUN[0] - s * SUN[1], s * SUN[0] + c * SUN[1], SUN[2]])

    def ground(points: Floats, pixel_m: Floats) -> Floats:
        away = np.hypot(points[:, 0] - foot[0], points[:, 1] - foot[1])
        half, line = np.maximum(RING_M, THINNEST_PX / 2.0 * pixel_m), np.zeros(len(points))
        for radius in DISTANCES:
            inside = half + pixel_m / 2.0 - np.abs(away - radius)
            line = np.maximum(line, np.clip(inside / np.maximum(pixel_m, 1e-6), 0.0, 1.0))
        return np.asarray(ROAD + 0.75 * line[:, None] * (RING - ROAD))

    def sky(rays: Floats) -> Floats:
        up = np.clip(rays[:, 2], 0.0, 1.0)[:, None] ** 0.6
        return np.asarray(HORIZON * (1.0 - up) + ZENITH * up)

    def haze(points: Floats) -> Floats:
        away = np.hypot(points[:, 0] - foot[0], points[:, 1] - foot[1])
        part = np.clip((away - FADED_M[0]) / (FADED_M[1] - FADED_M[0]), 0.0, 1.0)
        return np.asarray(part**0.7)

    return Surroundings(ground, sky, sun, haze)

"""Sensors as solids: their housings' sizes as data sheets give them, in a colour of their own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..engine import catalog, graphics, pe, scene
from .painted import Paint, PaintedBody
from .shading import from_srgb
from .shapes import lathe, rounded_box

Floats = NDArray[np.float64]

SMALL = scene.Housing("box", (0.05, 0.06, 0.05), (0.025, 0.0, 0.025))
"""Of a camera whose size is not known, about that of a module."""
ROUND = scene.Housing("cylinder", (0.11, 0.11, 0.08), (0.0, 0.0, 0.04))
"""Of a LiDAR."""
PROUD_M = 0.0005
"""How far a window stands out."""
WINDOW = Paint((0.02, 0.022, 0.025), 0.9)


def sensor_solids(rig: pe.Rig) -> list[PaintedBody]:
    """Return a solid for each sensor, in its colour."""
    return [_solid(sensor, sensor_rgb(number)) for number, sensor in enumerate(rig)]


def sensor_rgb(number: int) -> tuple[float, float, float]:
    """Return the colour of a rig's sensor by its place; sRGB."""
    return graphics.sensor_color_on_paper(number)


def housing_of(sensor: pe.Sensor) -> scene.Housing:
    """Return a sensor's housing, or a small one that stands for it."""
    known = catalog.housing(sensor.model.name)
    if known is not None:
        return known
    return ROUND if sensor.kind == "lidar" else SMALL


def _solid(sensor: pe.Sensor, rgb: tuple[float, float, float]) -> PaintedBody:
    housing = housing_of(sensor)
    own = Paint(tuple(from_srgb(np.array(rgb)).tolist()), 0.25)
    shape = _can if housing.shape == "cylinder" else _box
    parts = shape(np.array(housing.size))
    triangles = np.concatenate(parts) + housing.center
    placed = scene.rotate(sensor.pose.ground_from_sensor, triangles.reshape(-1, 3))
    placed = placed + np.array(sensor.pose.position)
    numbers = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    body = pe.Vehicle(placed.reshape(-1, 3, 3), numbers, [f"part {k}" for k in range(len(parts))])
    return PaintedBody(body, (own, WINDOW)[: len(parts)])


def _can(size: Floats) -> list[Floats]:
    """A can round the origin, and the window round it."""
    r, h = size[0] / 2.0, size[2] / 2.0
    body = [(0.0, -h), (r, -h), (r, -0.35 * h), (0.94 * r, -0.35 * h)]
    upper = [(0.94 * r, 0.55 * h), (r, 0.55 * h), (r, 0.9 * h), (0.9 * r, h), (0.0, h)]
    window = [(0.94 * r, -0.35 * h), (0.94 * r, 0.55 * h)]
    return [np.concatenate([lathe(body), lathe(upper)]), lathe(window)]


def _box(size: Floats) -> list[Floats]:
    """A box round the origin, and a round window at its front."""
    box = rounded_box(size / 2.0)
    radius = 0.36 * float(min(size[1], size[2]))
    disc = lathe([(radius, 0.0), (0.8 * radius, 0.004), (0.0, 0.004)])
    front = np.stack([disc[..., 2], disc[..., 0], disc[..., 1]], axis=-1)
    return [box, front + np.array([size[0] / 2.0 + PROUD_M, 0.0, 0.0])]

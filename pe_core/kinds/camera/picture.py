"""Rays through a picture: what a camera looks along."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot, rotate
from ...scene.sensors import Sensor
from .model import Camera

Floats = NDArray[np.float64]


def picture_rays(sensor: Sensor, most: int) -> Floats:
    """(R, 3) unit directions, ground frame, through an even raster of at most `most` pixels."""
    camera = cast(Camera, sensor.model)
    across, down = _raster(camera, most)
    u = (np.arange(across) + 0.5) / across - 0.5
    v = (np.arange(down) + 0.5) / down - 0.5
    if camera.lens is not None:
        places = np.meshgrid((u + 0.5) * camera.width, (v + 0.5) * camera.height, indexing="ij")
        bent = camera.lens.unproject(places[0].ravel(), places[1].ravel())
        return rotate(sensor.pose.ground_from_sensor, bent[~np.isnan(bent[:, 0])])
    left, up = np.meshgrid(-u * camera.width, -v * camera.height, indexing="ij")
    rays = np.stack([np.full(left.size, camera.focal_px), left.ravel(), up.ravel()], axis=1)
    return rotate(sensor.pose.ground_from_sensor, rays / np.sqrt(dot(rays, rays))[:, None])


def _raster(camera: Camera, most: int) -> tuple[int, int]:
    """Columns and rows of squares, so many at most and never more than pixels."""
    size = max(1.0, math.sqrt(camera.width * camera.height / most))
    across = min(max(1, math.floor(camera.width / size)), most)
    return across, max(1, min(math.floor(camera.height / size), most // across))

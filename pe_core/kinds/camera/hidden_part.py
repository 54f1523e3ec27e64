"""How much of a camera's picture the vehicle hides, and which part of it."""

from __future__ import annotations

import numpy as np

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import Stopped
from .picture import picture_rays

PICTURE_RAYS = 16_384
"""Places of the picture that are looked at: a share is good to about a thousandth."""


def hidden_places(sensor: Sensor, vehicle: Vehicle | None) -> Stopped:
    """Count places spread evenly over a picture, those that show the vehicle, and those by part."""
    rays = picture_rays(sensor, PICTURE_RAYS)
    if vehicle is None:
        return Stopped(len(rays))
    hits = vehicle.first_hit(sensor.pose.position, rays, sensor.model.sees_through_glass)
    met = np.isfinite(hits.distance)
    parts = np.asarray(vehicle.parts)[hits.face[met]]
    counts = np.bincount(parts, minlength=len(vehicle.part_names))
    order = np.argsort(-counts, kind="stable")
    by_part = {vehicle.part_names[i]: int(counts[i]) for i in order if counts[i]}
    return Stopped(len(rays), int(np.count_nonzero(met)), by_part)

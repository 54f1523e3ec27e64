"""The measurement of objects by a camera as it is defined: the seen area of each box's image."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.objects import Objects
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..placed_boxes import PlacedBoxes
from .box_area import box_images
from .box_rays import BoxRays, rays_to_boxes, seen_share
from .model import Camera
from .ranged import out_of_range
from .ties import axes_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


def count_object_pixels(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
) -> Floats:
    """(N,) pixels of each object's image that are in the picture and hidden by nothing."""
    camera, axes = cast(Camera, sensor.model), axes_of(sensor.pose)
    boxes = PlacedBoxes.of(objects, sensor.pose.position)
    images = box_images(camera, axes, boxes)
    area = images.area
    area[out_of_range(camera, objects.centers - np.asarray(sensor.pose.position))] = 0.0
    if vehicle is None and not traffic:
        return area
    rays = rays_to_boxes(camera, axes, boxes, images, np.flatnonzero(area))
    hidden = np.zeros(len(rays.item), bool)
    if vehicle is not None:
        seen = vehicle.seen_from(sensor.pose.position, camera.sees_through_glass)
        hidden |= seen.first_hit(rays.directions).distance < rays.distance
    if traffic:
        hidden |= behind_others(boxes, objects.scenes, rays)
    return area * seen_share(rays, hidden, len(area))


def behind_others(boxes: PlacedBoxes, scenes: Ints, rays: BoxRays) -> Flags:
    """Whether rays enter another box of the scene before their own."""
    hidden = np.zeros(len(rays.item), bool)
    others = np.argsort(scenes, kind="stable")
    first = np.searchsorted(scenes[others], scenes[rays.item], "left")
    count = np.searchsorted(scenes[others], scenes[rays.item], "right") - first
    for rank in range(int(count.max(initial=0))):
        some = np.flatnonzero((count > rank) & ~hidden)
        box = others[first[some] + rank]
        enter, leave = boxes.crossing(box, rays.directions[some])
        before = (enter < leave) & (enter < rays.distance[some])
        hidden[some] = before & (box != rays.item[some])
    return hidden

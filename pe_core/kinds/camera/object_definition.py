"""The measurement of objects by a camera as it is defined: the seen area of each box's image."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot
from ...scene.objects import Objects
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..placed_boxes import PlacedBoxes
from .box_area import box_area
from .box_points import BoxPoints, box_points, seen_share
from .model import Camera
from .ranged import out_of_range
from .ties import axes_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

JUST_BEFORE = 1.0 - 1e-9
"""Rays come so far towards their points: what touches a point does not hide it."""


def count_object_pixels(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
) -> Floats:
    """(N,) pixels of each object's image that are in the picture and hidden by nothing."""
    camera, axes = cast(Camera, sensor.model), axes_of(sensor.pose)
    boxes = PlacedBoxes.of(objects, sensor.pose.position)
    area = box_area(camera, axes, boxes)
    area[out_of_range(camera, objects.centers - np.asarray(sensor.pose.position))] = 0.0
    if vehicle is None and not traffic:
        return area
    points = box_points(camera, axes, boxes, np.flatnonzero(area))
    hidden = np.zeros(len(points.item), bool)
    if vehicle is not None:
        hidden |= behind_vehicle(sensor, vehicle, points.aims)
    if traffic:
        hidden |= behind_others(boxes, objects.scenes, points)
    return area * seen_share(points, hidden, len(area))


def behind_vehicle(sensor: Sensor, vehicle: Vehicle, aims: Floats) -> Flags:
    """Whether the vehicle stands before points (P, 3), from the camera [m]."""
    if not len(aims):
        return np.zeros(0, bool)
    distance = np.sqrt(dot(aims, aims))
    glass = sensor.model.sees_through_glass
    hits = vehicle.first_hit(sensor.pose.position, aims / distance[:, None], glass)
    return hits.distance < distance * JUST_BEFORE


def behind_others(boxes: PlacedBoxes, scenes: Ints, points: BoxPoints) -> Flags:
    """Whether another box of its scene stands before each point."""
    hidden = np.zeros(len(points.item), bool)
    others = np.argsort(scenes, kind="stable")
    first = np.searchsorted(scenes[others], scenes[points.item], "left")
    count = np.searchsorted(scenes[others], scenes[points.item], "right") - first
    distance = np.sqrt(dot(points.aims, points.aims))
    directions = points.aims / distance[:, None]
    for rank in range(int(count.max(initial=0))):
        some = np.flatnonzero((count > rank) & ~hidden)
        box = others[first[some] + rank]
        some, box = (w[box != points.item[some]] for w in (some, box))
        enter, leave = boxes.crossing(box, directions[some])
        hidden[some] = (enter < leave) & (enter < distance[some] * JUST_BEFORE)
    return hidden

"""The measurement of objects by a camera as it is defined: the seen area of each box's image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.numbering import count_up
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
    shown = np.flatnonzero(area)
    rays = rays_to_boxes(camera, axes, boxes, images, shown)
    hidden = np.zeros(len(rays.item), bool)
    if vehicle is not None:
        seen = vehicle.seen_from(sensor.pose.position, camera.sees_through_glass)
        hidden |= seen.first_hit(rays.directions).distance < rays.distance
    if traffic:
        hidden |= behind_others(boxes, Rivals.of(objects.scenes, shown), rays)
    area[shown] *= seen_share(rays, hidden, len(shown))
    return area


@dataclass(frozen=True, slots=True)
class Rivals:
    """Boxes that may stand before some boxes (P,): box k's are `count[k]` from `first[k]` on."""

    first: Ints
    count: Ints
    other: Ints

    @classmethod
    def of(cls, scenes: Ints, which: Ints) -> Rivals:
        """Take all others of their scenes."""
        order = np.argsort(scenes, kind="stable")
        first = np.searchsorted(scenes[order], scenes[which], "left")
        count = np.searchsorted(scenes[order], scenes[which], "right") - first
        other = order[np.repeat(first, count) + count_up(count)]
        rivals = cls(np.cumsum(count) - count, count, other)
        return rivals.some(other != which[rivals.ranks()])

    def ranks(self) -> Ints:
        """(R,) whose rival each is."""
        return np.repeat(np.arange(len(self.count)), self.count)

    def some(self, kept: Flags) -> Rivals:
        """Return those of flags (R,)."""
        count = np.bincount(self.ranks()[kept], minlength=len(self.count))
        return Rivals(np.cumsum(count) - count, count, self.other[kept])


def behind_others(boxes: PlacedBoxes, rivals: Rivals, rays: BoxRays) -> Flags:
    """Whether rays enter a rival of their box before it; both count the boxes alike."""
    hidden = np.zeros(len(rays.item), bool)
    first, count = rivals.first[rays.item], rivals.count[rays.item]
    for rank in range(int(count.max(initial=0))):
        some = np.flatnonzero((count > rank) & ~hidden)
        box = rivals.other[first[some] + rank]
        enter, leave = boxes.crossing(box, rays.directions[some])
        hidden[some] = (enter < leave) & (enter < rays.distance[some])
    return hidden

"""The measurement of objects by a camera, by definition: the visible area of each box's image.

Rays through a fixed lattice over the image give the visible share. The bounding rectangle of a
box's image has RAYS points in a Fibonacci lattice. No two of them have the same height or the same
horizontal position. So an edge that cuts the image at any angle has the right share of the points
on each side, within one or two hundredths. The rays through these points that hit the box decide.
Sometimes no ray hits: the box is as thin as a wire, or only a sliver of it is in a fisheye's field.
Then rays to points on the box's sides decide, if these are in the picture and in the field.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...geometry.indexing import blocks
from ...geometry.poses import dot, rotate
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..box_rays import BoxRays, Rivals, behind_others
from ..object_kernel import PlacedBoxes
from .box_area import BoxImages, along_camera, box_images, face_points
from .definition import out_of_range
from .model import Camera
from .tie_rules import axes_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

RAYS, TURN = 144, 89
"""Neighbouring Fibonacci numbers: point i is at i / RAYS across, and at i * TURN / RAYS down."""
BOXES_AT_ONCE = 512
SIDE_PLACES = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 15)] * 2), axis=-1).reshape(-1, 2)
"""Points on a side of a box, in half sides, that rays aim at if no lattice ray hits the box."""


def rays_to_boxes(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, images: BoxImages, which: Ints
) -> BoxRays:
    """Return the rays through the images of boxes `which` (P,) that hit them; `item` is the box."""
    found = list(_met(camera, axes, boxes, images, which))
    if not found:
        return BoxRays(np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0))
    rank, directions, distance = (np.concatenate(w) for w in zip(*found, strict=True))
    return BoxRays(which[rank], directions, distance)


def visible_share(rays: BoxRays, hidden: Flags, count: int) -> Floats:
    """(P,) visible share of each box's rays; 1 for a box that no ray hits."""
    whole = np.bincount(rays.item, minlength=count)
    unseen = np.bincount(rays.item[hidden], minlength=count)
    return np.asarray((whole - unseen + (whole == 0)) / np.maximum(whole, 1))


def _met(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, images: BoxImages, which: Ints
) -> Iterator[tuple[Ints, Floats, Floats]]:
    step = np.arange(RAYS) + 0.5
    lattice = np.stack([step / RAYS, (step * TURN / RAYS) % 1.0], axis=1)
    for some in blocks(len(which), BOXES_AT_ONCE):
        own = which[some]
        low, high = images.low[own, None], images.high[own, None]
        places = (low + (high - low) * lattice).reshape(-1, 2)
        directions, exists = _through(camera, axes, places)
        rank = np.repeat(np.arange(some.start, some.stop), RAYS)[exists]
        enter, leave = boxes.crossing(which[rank], directions)
        met = np.flatnonzero((enter < leave) & (enter > 0.0))
        yield rank[met], directions[met], enter[met]
        missed = np.setdiff1d(np.arange(some.start, some.stop), rank[met], assume_unique=False)
        if len(missed):
            yield _to_sides(camera, axes, boxes, which[missed], missed)


def _to_sides(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, rank: Ints
) -> tuple[Ints, Floats, Floats]:
    """Rays to points on the sides that face the camera; if none is in view, to the nearest one."""
    sides, towards = [], []
    for axis in range(3):
        places = face_points(boxes, which, axis, SIDE_PLACES)
        sides.append(along_camera(axes, boxes, which, places))
        looks = np.abs(boxes.offsets[which, axis]) > boxes.halves[which, axis]
        towards.append(np.broadcast_to(looks[:, None], places.shape[:2]))
    points = np.concatenate(sides, axis=1)
    beyond = np.where(np.concatenate(towards, axis=1), _beyond_view(camera, points), np.inf)
    box, place = np.nonzero(beyond <= np.maximum(beyond.min(axis=1), 0.0)[:, None])
    rays = points[box, place]
    distance = np.sqrt(dot(rays, rays))
    return rank[box], rotate(axes, rays / distance[:, None]), distance


def _beyond_view(camera: Camera, points: Floats) -> Floats:
    """Distance of points (..., 3), camera's axes, from the camera's view [px]; 0 inside."""
    lens, (depth, left, up) = camera.projection, np.moveaxis(points, -1, 0)
    theta = np.arctan2(np.hypot(left, up), depth)
    inside = theta < (np.pi / 2.0 if lens.is_straight else lens.edge)
    safe = np.where(inside, depth, 1.0) if lens.is_straight else depth
    x, y = lens.project(safe, left, up)
    out = np.maximum(np.abs(x - camera.width / 2.0) - camera.width / 2.0, 0.0)
    out += np.maximum(np.abs(y - camera.height / 2.0) - camera.height / 2.0, 0.0)
    return np.asarray(np.where(inside, out, out + np.maximum(lens.fx, lens.fy) * theta))


def _through(camera: Camera, axes: Floats, places: Floats) -> tuple[Floats, Ints]:
    """Unit directions, ground frame, through positions (P, 2) in the picture, and their indices."""
    lens, (x, y) = camera.projection, places.T
    if not lens.is_straight:
        rays = lens.unproject(x, y)
        exists = np.flatnonzero(~np.isnan(rays[:, 0]))
        return rotate(axes, rays[exists]), exists
    rays = np.stack([np.ones(len(x)), (lens.cx - x) / lens.fx, (lens.cy - y) / lens.fy], axis=1)
    return rotate(axes, rays / np.sqrt(dot(rays, rays))[:, None]), np.arange(len(x))


def count_object_pixels(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
) -> Floats:
    """(N,) pixels of each object's image that are in the picture and not occluded."""
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
        hidden |= behind_others(boxes, Rivals.of(objects.scenes, np.arange(len(area))), rays)
    area *= visible_share(rays, hidden, len(area))
    return area

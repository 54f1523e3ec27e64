"""The measurement of objects by a camera, by definition: the visible area of each box's image.

Rays through a lattice over the image give the visible share. The bounding rectangle of a box's
image has the points of a Fibonacci lattice. No two of them have the same height or the same
horizontal position. So an edge that cuts the image at any angle has the right share of the points
on each side. The rays through these points that hit the box decide. The image may fill little of
its rectangle, as near the edge of a fisheye's field: the lattice is so fine that at least HITS rays
are expected to hit. If the box is partly visible, a finer one, with PARTLY_HITS, replaces it.
Sometimes no ray hits: the box is as thin as a wire, or only a sliver of it is in a fisheye's field.
Then rays to points on the box's sides decide, if these are in the picture and in the field.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import cast

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...geometry.indexing import blocks
from ...geometry.poses import dot, rotate
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..boxes import BoxRays, PlacedBoxes, Rivals, behind_others
from .box_area import BoxImages, along_camera, box_images, face_points
from .definition import out_of_range
from .model import Camera
from .tie_rules import axes_of

FIBONACCI = np.array(
    [55, 89, 144, 233, 377, 610, 987, 1597, 2584, 4181, 6765, 10946, 17711, 28657, 46368, 75025]
)
"""Point i of a lattice of FIBONACCI[k] is at i / FIBONACCI[k] across, and at
i * FIBONACCI[k - 1] / FIBONACCI[k] down."""
HITS, PARTLY_HITS = 89, 144
RAYS_AT_ONCE = 73_728
SIDE_PLACES = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 15)] * 2), axis=-1).reshape(-1, 2)
"""Points on a side of a box, in half sides, that rays aim at if no lattice ray hits the box."""


def visible_share(
    camera: Camera,
    axes: Floats,
    boxes: PlacedBoxes,
    images: BoxImages,
    which: Ints,
    is_hidden: Callable[[BoxRays], Flags],
) -> Floats:
    """Return the visible share (P,) of the images of boxes `which` (P,).

    `is_hidden` says of rays to boxes whether something is before their box; `item` is the box.
    """
    share = np.ones(len(which))
    some = np.arange(len(which))
    for hits in (HITS, PARTLY_HITS):
        found = list(_met(camera, axes, boxes, images, which[some], hits))
        if not found:
            break
        rank, directions, distance = (np.concatenate(w) for w in zip(*found, strict=True))
        hidden = is_hidden(BoxRays(which[some[rank]], directions, distance))
        whole, unseen = (np.bincount(w, minlength=len(some)) for w in (rank, rank[hidden]))
        share[some] = (whole - unseen) / whole
        some = some[(share[some] > 0.0) & (share[some] < 1.0)]
    return share


def _met(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, images: BoxImages, which: Ints, hits: int
) -> Iterator[tuple[Ints, Floats, Floats]]:
    """Ranks, directions and distances of rays that hit boxes; each box has at least one."""
    extent = images.high[which] - images.low[which]
    wanted = hits * extent[:, 0] * extent[:, 1] / images.area[which]
    level = np.clip(np.searchsorted(FIBONACCI, wanted), 1, len(FIBONACCI) - 1)
    for k in np.unique(level).tolist():
        of_level = np.flatnonzero(level == k)
        for some in blocks(len(of_level), max(1, RAYS_AT_ONCE // int(FIBONACCI[k]))):
            yield from _met_by_lattice(camera, axes, boxes, images, which, of_level[some], k)


def _met_by_lattice(
    camera: Camera,
    axes: Floats,
    boxes: PlacedBoxes,
    images: BoxImages,
    which: Ints,
    ranks: Ints,
    level: int,
) -> Iterator[tuple[Ints, Floats, Floats]]:
    turn, count = FIBONACCI[level - 1 : level + 1].tolist()
    step = np.arange(count) + 0.5
    lattice = np.stack([step / count, (step * turn / count) % 1.0], axis=1)
    low, high = images.low[which[ranks], None], images.high[which[ranks], None]
    places = (low + (high - low) * lattice).reshape(-1, 2)
    directions, exists = _through(camera, axes, places)
    rank = np.repeat(ranks, count)[exists]
    enter, leave = boxes.crossing(which[rank], directions)
    met = np.flatnonzero((enter < leave) & (enter > 0.0))
    yield (hit := rank[met]), directions[met], enter[met]
    missed = ranks[np.bincount(hit, minlength=len(which))[ranks] == 0]
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

    def is_hidden(rays: BoxRays) -> Flags:
        hidden = np.zeros(len(rays.item), bool)
        if vehicle is not None:
            seen = vehicle.seen_from(sensor.pose.position, camera.sees_through_glass)
            hidden |= seen.first_hit(rays.directions).distance < rays.distance
        if traffic:
            hidden |= behind_others(boxes, Rivals.of(objects.scenes, np.arange(len(area))), rays)
        return hidden

    shown = np.flatnonzero(area)
    area[shown] *= visible_share(camera, axes, boxes, images, shown, is_hidden)
    return area

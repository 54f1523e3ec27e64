"""The measurement of objects by a camera, by definition: the visible area of each box's image.

As for a cube (`kind`), the image is the union of the faces that face the camera. The part of
a face inside the picture follows from Green's theorem, edge by edge. A face that reaches behind a
pinhole camera is cut at the camera's plane. Through a lens with distortion, edges are split into
straight pieces. If a face contains the direction opposite to the view, the outline is that of the
complement of its image.

Rays through a lattice over the image give the visible share. The bounding rectangle of a box's
image has the points of a Fibonacci lattice. No two of them have the same height or the same
horizontal position. So an edge that cuts the image at any angle has the right share of the points
on each side. The rays through these points that hit the box decide. The image may fill little of
its rectangle, as near the edge of a fisheye's field: the lattice is so fine that at least HITS rays
are expected to hit. If the box is partly visible, a finer one, with PARTLY_HITS, replaces it.
Sometimes no ray hits: the box is as thin as a wire, or only a sliver of it is in a fisheye's field.
Then rays to points on the box's sides decide, if these are in the picture and in the field.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints, join_columns
from ...geometry.bins import blocks
from ...geometry.poses import dot, rotate
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..boxes import BoxRays, PlacedBoxes, Rivals, behind_others
from .definition import (
    QUAD,
    RIGHT_BEHIND,
    ROUNDING_PX,
    ImagePoints,
    aperture_of,
    axes_of,
    clamped_integral,
    out_of_range,
    round_a_face,
)
from .model import Camera, camera_of

ImagedFaces = tuple[Ints, Floats, ImagePoints]
"""Boxes (P,), the area (P,) of a face of each, and points (P, K) that bound its image [px]."""
NEAREST_M = 1e-3  # Distance in front of the camera's plane at which a face is cut [m]
PIECES = ((3.0, 32), (12.0, 8), (np.inf, 3))
"""Straight pieces of an edge through a lens with distortion: up to a distance in half
diagonals, and farther away."""
FIBONACCI = np.array(
    [55, 89, 144, 233, 377, 610, 987, 1597, 2584, 4181, 6765, 10946, 17711, 28657, 46368, 75025]
)
"""Point i of a lattice of FIBONACCI[k] is at i / FIBONACCI[k] across, and at
i * FIBONACCI[k - 1] / FIBONACCI[k] down."""
HITS = 89
PARTLY_HITS = 144
RAYS_AT_ONCE = 73_728
SIDE_PLACES = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 15)] * 2), axis=-1).reshape(-1, 2)
"""Points on a side of a box, in half sides, that rays aim at if no lattice ray hits the box."""


@dataclass(frozen=True, slots=True)
class BoxImages:
    """Images of boxes: `area` (N,) inside the picture [px], and bounding rectangles. `low` and
    `high` (N, 2) are the rectangles' corners, right and down [px]."""

    area: Floats
    low: Floats
    high: Floats

    def some(self, which: Ints) -> "BoxImages":
        """Return the images with these indices or flags."""
        return BoxImages(self.area[which], self.low[which], self.high[which])


def box_images(camera: Camera, axes: Floats, boxes: PlacedBoxes) -> BoxImages:
    """Return the images of boxes; a box that contains the camera has no area. `axes` (3, 3) rotate
    from the camera's frame to the ground frame (`definition.axes_of`)."""
    faces = _straight_faces if camera.projection.is_straight else _bent_faces
    count = len(boxes.offsets)
    size = np.array([camera.width, camera.height], dtype=float)
    images = BoxImages(np.zeros(count), np.full((count, 2), np.inf), np.full((count, 2), -np.inf))
    for axis in range(3):
        toward = np.flatnonzero(np.abs(boxes.offsets[:, axis]) > boxes.halves[:, axis])
        for which, area, places in faces(camera, axes, boxes, toward, axis):
            images.area[which] += area
            held = [np.clip(w, 0.0, most) for w, most in zip(places, size, strict=True)]
            low, high = (np.stack([f(w, axis=1) for w in held], 1) for f in (np.min, np.max))
            images.low[which] = np.minimum(images.low[which], low)
            images.high[which] = np.maximum(images.high[which], high)
    images.area[images.area <= ROUNDING_PX] = 0.0
    return images


def along_camera(axes: Floats, boxes: PlacedBoxes, which: Ints, points: Floats) -> Floats:
    """Convert points (P, ..., 3) from the axes of their boxes `which` (P,) to the camera's axes."""
    wide = (len(which), *(1,) * (points.ndim - 2))
    c, s = (w[which].reshape(wide) for w in boxes.headings.T)
    x = points[..., 0]
    y = points[..., 1]
    z = points[..., 2]
    x, y = c * x - s * y, s * x + c * y
    return np.stack([a[0] * x + a[1] * y + a[2] * z for a in axes.T], axis=-1)


def face_points(boxes: PlacedBoxes, which: Ints, axis: int, places: Floats) -> Floats:
    """(P, K, 3) points of the faces that face the sensor, along the boxes' own axes. The faces'
    normals are along `axis`; `places` (K, 2) are in half sides along the other two axes."""
    i = (axis + 1) % 3
    j = (axis + 2) % 3
    offsets = boxes.offsets[which]
    halves = boxes.halves[which]
    points = np.repeat(offsets[:, None, :], len(places), axis=1)
    points[..., i] += halves[:, i, None] * places[:, 0]
    points[..., j] += halves[:, j, None] * places[:, 1]
    points[..., axis] -= (np.sign(offsets[:, axis]) * halves[:, axis])[:, None]
    return points


def _straight_faces(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int
) -> Iterator[ImagedFaces]:
    """Images of faces through a pinhole: faces in front of it, and faces that its plane cuts."""
    corners = face_points(boxes, which, axis, np.array(QUAD))
    corners = along_camera(axes, boxes, which, corners)
    front = corners[..., 0] > NEAREST_M
    whole, cut = (np.flatnonzero(w) for w in (front.all(axis=1), front.any(axis=1)))
    cut = np.setdiff1d(cut, whole, assume_unique=True)
    if len(whole):
        yield which[whole], *_between(camera, corners[whole], np.roll(corners[whole], -1, axis=1))
    if len(cut):
        yield which[cut], *_between(camera, *_in_front(corners[cut], front[cut]))


def _in_front(corners: Floats, front: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Starts and ends (P, 5, 3) of the edges of quadrilaterals, cut at depth `NEAREST_M`. Edges
    behind the cut become points. The last edge joins the two points where the outline crosses the
    cut."""
    ends = np.roll(corners, -1, axis=1)
    front_too = np.roll(front, -1, axis=1)
    run = ends[..., :1] - corners[..., :1]
    share = (NEAREST_M - corners[..., :1]) / np.where(run == 0.0, 1.0, run)
    cut = corners + share * (ends - corners)
    leaves = front & ~front_too
    comes = ~front & front_too
    exit_, entry = ((cut * w[..., None]).sum(axis=1, keepdims=True) for w in (leaves, comes))
    starts = np.where(front[..., None], corners, np.where(comes[..., None], cut, exit_))
    ends = np.where(front_too[..., None], ends, np.where(leaves[..., None], cut, exit_))
    return np.concatenate([starts, exit_], axis=1), np.concatenate([ends, entry], axis=1)


def _between(camera: Camera, starts: Floats, ends: Floats) -> tuple[Floats, ImagePoints]:
    """Area (P,) inside the picture of outlines of edges (P, K, 3), and images of their starts."""
    lens = camera.projection
    (x0, y0), (x1, y1) = (
        (lens.cx - p[..., 1] * lens.fx / p[..., 0], lens.cy - p[..., 2] * lens.fy / p[..., 0])
        for p in (starts, ends)
    )
    parts = clamped_integral(x0, y0, x1, y1, width=float(camera.width), height=float(camera.height))
    return np.asarray(np.abs(parts.sum(axis=1))), (x0, y0)


def _bent_faces(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int
) -> Iterator[ImagedFaces]:
    """Images of faces through a lens with distortion; edges of near faces have more pieces."""
    offsets = boxes.offsets[which]
    halves = boxes.halves[which]
    ratio = np.sqrt(dot(offsets, offsets) / dot(halves, halves))
    nearer = 0.0
    for farther, pieces in PIECES:
        some = which[(ratio >= nearer) & (ratio < farther)]
        if len(some):
            yield some, *_outlined(camera, axes, boxes, some, axis=axis, pieces=pieces)
        nearer = farther


def _outlined(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int, pieces: int
) -> tuple[Floats, ImagePoints]:
    """Area of faces in the picture and the field, with so many pieces an edge; their outlines.
    Positions beyond the edge of the field are moved outwards. So a straight piece between two of
    them does not cross the picture, even if the edge of the face passes right behind the camera."""
    aperture = aperture_of(camera)
    lens = camera.projection
    outline = face_points(boxes, which, axis, round_a_face(pieces))
    depth, left, up = np.moveaxis(along_camera(axes, boxes, which, outline), -1, 0)
    theta = np.arctan2(np.hypot(left, up), depth)
    most = np.minimum(theta, RIGHT_BEHIND) / 2.0
    farther = np.maximum(np.tan(most) / math.tan(min(lens.edge, RIGHT_BEHIND) / 2.0), 1.0)
    x, y = lens.project(depth, left, up)
    places = lens.cx + (x - lens.cx) * farther, lens.cy + (y - lens.cy) * farther
    area = aperture.area(places)
    behind = _holds_behind(axes, boxes, which, axis)
    if behind.any():
        wide = float(camera.width)
        high = float(camera.height)
        shape = (1, x.shape[1])
        picture = np.zeros(shape), np.full(shape, high)  # its last corner is repeated
        picture[0][0, 1:3] = wide
        picture[1][0, :2] = 0.0
        area[behind] = aperture.area(picture)[0] - area[behind]
        for own, all_ in zip(places, picture, strict=True):
            own[behind] = all_
    return area, places


def _holds_behind(axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int) -> NDArray[np.bool_]:
    """Whether the direction opposite to the view meets faces."""
    back = np.broadcast_to(-axes[:, 0], (len(which), 3))
    speed = np.stack(boxes.along(which, back), axis=1)
    offsets = boxes.offsets[which]
    halves = boxes.halves[which]
    plane = offsets[:, axis] - np.sign(offsets[:, axis]) * halves[:, axis]
    runs = speed[:, axis] * plane > 0.0
    distance = plane / np.where(runs, speed[:, axis], 1.0)
    aside = np.abs(offsets - distance[:, None] * speed) < halves
    aside[:, axis] = True
    return runs & aside.all(axis=1)


def visible_share(
    camera: Camera,
    axes: Floats,
    boxes: PlacedBoxes,
    images: BoxImages,
    which: Ints,
    is_hidden: Callable[[BoxRays], Flags],
) -> Floats:
    """Return the visible share (P,) of the images of boxes `which` (P,). `is_hidden` says of rays
    to boxes whether something is before their box; `item` is the box."""
    share = np.ones(len(which))
    some = np.arange(len(which))
    for hits in (HITS, PARTLY_HITS):
        found = list(_met(camera, axes, boxes, images, which=which[some], hits=hits))
        if not found:
            break
        rank, directions, distance = join_columns(found)
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
        turn, count = FIBONACCI[k - 1 : k + 1].tolist()
        step = np.arange(count) + 0.5
        lattice = np.stack([step / count, (step * turn / count) % 1.0], axis=1)
        for some in blocks(len(of_level), max(1, RAYS_AT_ONCE // count)):
            ranks = of_level[some]
            low = images.low[which[ranks], None]
            high = images.high[which[ranks], None]
            places = (low + (high - low) * lattice).reshape(-1, 2)
            directions, exists = _through(camera, axes, places)
            rank = np.repeat(ranks, count)[exists]
            enter, leave = boxes.crossing(which[rank], directions)
            met = np.flatnonzero((enter < leave) & (enter > 0.0))
            yield (hit := rank[met]), directions[met], enter[met]
            missed = ranks[np.bincount(hit, minlength=len(which))[ranks] == 0]
            if len(missed):
                yield _to_sides(camera, axes, boxes, which[missed], rank=missed)


def _to_sides(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, rank: Ints
) -> tuple[Ints, Floats, Floats]:
    """Rays to points on the sides that face the camera; if none is in view, to the nearest one."""
    sides = []
    towards = []
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
    lens = camera.projection
    depth, left, up = np.moveaxis(points, -1, 0)
    theta = np.arctan2(np.hypot(left, up), depth)
    inside = theta < (np.pi / 2.0 if lens.is_straight else lens.edge)
    safe = np.where(inside, depth, 1.0) if lens.is_straight else depth
    x, y = lens.project(safe, left, up)
    out = np.maximum(np.abs(x - camera.width / 2.0) - camera.width / 2.0, 0.0)
    out += np.maximum(np.abs(y - camera.height / 2.0) - camera.height / 2.0, 0.0)
    return np.asarray(np.where(inside, out, out + np.maximum(lens.fx, lens.fy) * theta))


def _through(camera: Camera, axes: Floats, places: Floats) -> tuple[Floats, Ints]:
    """Unit directions, ground frame, through positions (P, 2) in the picture, and their indices."""
    lens = camera.projection
    x, y = places.T
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
    camera = camera_of(sensor)
    axes = axes_of(sensor.pose)
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
    area[shown] *= visible_share(camera, axes, boxes, images, which=shown, is_hidden=is_hidden)
    return area

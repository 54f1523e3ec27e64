"""Images of boxes: their pixel area, clipped to the picture, and their bounding rectangle.

As for a cube (`pixel_area`), the image is the union of the faces that face the camera. The part of
a face inside the picture follows from Green's theorem, edge by edge. A face that reaches behind a
pinhole camera is cut at the camera's plane. Through a lens with distortion, edges are split into
straight pieces. If a face contains the direction opposite to the view, the outline is that of the
complement of its image.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints
from ...geometry.poses import dot
from ..boxes import PlacedBoxes
from .bent_area import RIGHT_BEHIND, ImagePoints, aperture_of
from .lens import Lens
from .model import Camera
from .pixel_area import QUAD, ROUNDING_PX, clamped_integral

ImagedFaces = tuple[Ints, Floats, ImagePoints]
"""Boxes (P,), the area (P,) of a face of each, and points (P, K) that bound its image [px]."""

NEAREST_M = 1e-3
"""Distance in front of the camera's plane at which a face is cut [m]."""
PIECES = ((3.0, 32), (12.0, 8), (np.inf, 3))
"""Straight pieces of an edge through a lens with distortion: up to a distance in half
diagonals, and farther away."""


@dataclass(frozen=True, slots=True)
class BoxImages:
    """Images of boxes: `area` (N,) inside the picture [px], and bounding rectangles.

    `low` and `high` (N, 2) are the rectangles' corners, right and down [px].
    """

    area: Floats
    low: Floats
    high: Floats

    def some(self, which: Ints) -> BoxImages:
        """Return the images with these indices or flags."""
        return BoxImages(self.area[which], self.low[which], self.high[which])


def box_images(camera: Camera, axes: Floats, boxes: PlacedBoxes) -> BoxImages:
    """Return the images of boxes; a box that contains the camera has no area.

    Parameters
    ----------
    camera : Camera
    axes : (3, 3) float
        Rotation from the camera's frame to the ground frame (`tie_rules.axes_of`).
    boxes : PlacedBoxes
    """
    faces = _straight_faces if camera.projection.is_straight else _bent_faces
    count, size = len(boxes.offsets), np.array([camera.width, camera.height], dtype=float)
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
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    x, y = c * x - s * y, s * x + c * y
    return np.stack([a[0] * x + a[1] * y + a[2] * z for a in axes.T], axis=-1)


def face_points(boxes: PlacedBoxes, which: Ints, axis: int, places: Floats) -> Floats:
    """(P, K, 3) points of the faces that face the sensor, along the boxes' own axes.

    The faces' normals are along `axis`; `places` (K, 2) are in half sides along the other two axes.
    """
    i, j = (axis + 1) % 3, (axis + 2) % 3
    offsets, halves = boxes.offsets[which], boxes.halves[which]
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
    """Starts and ends (P, 5, 3) of the edges of quadrilaterals, cut at depth `NEAREST_M`.

    Edges behind the cut become points. The last edge joins the two points where the outline
    crosses the cut.
    """
    ends, front_too = np.roll(corners, -1, axis=1), np.roll(front, -1, axis=1)
    run = ends[..., :1] - corners[..., :1]
    share = (NEAREST_M - corners[..., :1]) / np.where(run == 0.0, 1.0, run)
    cut = corners + share * (ends - corners)
    leaves, comes = front & ~front_too, ~front & front_too
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
    parts = clamped_integral(x0, y0, x1, y1, float(camera.width), float(camera.height))
    return np.asarray(np.abs(parts.sum(axis=1))), (x0, y0)


def _bent_faces(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int
) -> Iterator[ImagedFaces]:
    """Images of faces through a lens with distortion; edges of near faces have more pieces."""
    offsets, halves = boxes.offsets[which], boxes.halves[which]
    ratio = np.sqrt(dot(offsets, offsets) / dot(halves, halves))
    nearer = 0.0
    for farther, pieces in PIECES:
        some = which[(ratio >= nearer) & (ratio < farther)]
        if len(some):
            yield some, *_outlined(camera, axes, boxes, some, axis, pieces)
        nearer = farther


def _outlined(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int, pieces: int
) -> tuple[Floats, ImagePoints]:
    """Area of faces in the picture and the field, with so many pieces an edge; their outlines."""
    aperture = aperture_of(camera)
    outline = face_points(boxes, which, axis, _round_a_face(pieces))
    depth, left, up = np.moveaxis(along_camera(axes, boxes, which, outline), -1, 0)
    places = _projected(camera.projection, depth, left, up)
    area = aperture.area(places)
    behind = _holds_behind(axes, boxes, which, axis)
    if behind.any():
        picture = _picture(camera, places[0].shape[1])
        area[behind] = aperture.area(picture)[0] - area[behind]
        for own, all_ in zip(places, picture, strict=True):
            own[behind] = all_
    return area, places


def _projected(lens: Lens, depth: Floats, left: Floats, up: Floats) -> ImagePoints:
    """Image positions of directions [px]; those beyond the edge of the field are moved outwards.

    So a straight piece between two such positions does not cross the picture, even if the edge
    of the face passes right behind the camera.
    """
    theta = np.arctan2(np.hypot(left, up), depth)
    most = np.minimum(theta, RIGHT_BEHIND) / 2.0
    farther = np.maximum(np.tan(most) / math.tan(min(lens.edge, RIGHT_BEHIND) / 2.0), 1.0)
    x, y = lens.project(depth, left, up)
    return lens.cx + (x - lens.cx) * farther, lens.cy + (y - lens.cy) * farther


def _round_a_face(pieces: int) -> Floats:
    """(4 pieces, 2) points on the border of a face, in half sides."""
    corners = np.array(QUAD)
    share = (np.arange(pieces) / pieces)[None, :, None]
    steps = np.roll(corners, -1, axis=0) - corners
    return (corners[:, None] + steps[:, None] * share).reshape(-1, 2)


def _holds_behind(axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int) -> NDArray[np.bool_]:
    """Whether the direction opposite to the view meets faces."""
    back = np.broadcast_to(-axes[:, 0], (len(which), 3))
    speed = np.stack(boxes.along(which, back), axis=1)
    offsets, halves = boxes.offsets[which], boxes.halves[which]
    plane = offsets[:, axis] - np.sign(offsets[:, axis]) * halves[:, axis]
    runs = speed[:, axis] * plane > 0.0
    distance = plane / np.where(runs, speed[:, axis], 1.0)
    aside = np.abs(offsets - distance[:, None] * speed) < halves
    aside[:, axis] = True
    return runs & aside.all(axis=1)


def _picture(camera: Camera, count: int) -> ImagePoints:
    """Outline (1, count) of the picture [px]; the last corner is repeated to fill it."""
    wide, high = float(camera.width), float(camera.height)
    x, y = np.zeros((1, count)), np.full((1, count), high)
    x[0, 1:3], y[0, :2] = wide, 0.0
    return x, y

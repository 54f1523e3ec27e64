"""Pixel area of boxes' images, clipped to the picture: exact through a pinhole.

As of a cube (`camera.area`) the image is the union of the faces on the camera's side, and what of a
face lies in the picture is found by Green's theorem, edge by edge. A face that reaches behind the
camera is cut where it passes the camera's plane.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..placed_boxes import PlacedBoxes
from .aperture import aperture_of
from .area import QUAD, ROUNDING_PX, clamped_integral
from .model import Camera

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAREST_M = 1e-3
"""A face is cut so far in front of the camera's plane [m]."""
PIECES = ((3.0, 32), (12.0, 8), (np.inf, 3))
"""Straight pieces that an edge is taken for through a lens that bends: up to so many half diagonals
away, and farther."""


def box_area(camera: Camera, axes: Floats, boxes: PlacedBoxes) -> Floats:
    """(N,) pixels covered by boxes; 0 of one that the camera is in.

    Parameters
    ----------
    camera : Camera
    axes : (3, 3) float
        Rotation from the camera's frame to the ground frame (`ties.axes_of`).
    boxes : PlacedBoxes
    """
    exact = _straight_area if camera.projection.is_straight else _bent_area
    area = np.zeros(len(boxes.offsets))
    for k in range(3):
        toward = np.flatnonzero(np.abs(boxes.offsets[:, k]) > boxes.halves[:, k])
        if len(toward):
            area[toward] += exact(camera, axes, boxes, toward, k)
    return np.where(area > ROUNDING_PX, area, 0.0)


def along_camera(axes: Floats, boxes: PlacedBoxes, which: Ints, points: Floats) -> Floats:
    """Points (P, ..., 3) along the axes of box `which` (P,) each, along the camera's axes."""
    wide = (len(which), *(1,) * (points.ndim - 2))
    c, s = (w[which].reshape(wide) for w in boxes.headings.T)
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    x, y = c * x - s * y, s * x + c * y
    return np.stack([a[0] * x + a[1] * y + a[2] * z for a in axes.T], axis=-1)


def face_points(boxes: PlacedBoxes, which: Ints, axis: int, places: Floats) -> Floats:
    """(P, K, 3) points of the faces across an axis that look at the sensor, along boxes' own axes.

    `places` (K, 2) in halves along the other two axes.
    """
    i, j = (axis + 1) % 3, (axis + 2) % 3
    offsets, halves = boxes.offsets[which], boxes.halves[which]
    points = np.repeat(offsets[:, None, :], len(places), axis=1)
    points[..., i] += halves[:, i, None] * places[:, 0]
    points[..., j] += halves[:, j, None] * places[:, 1]
    points[..., axis] -= (np.sign(offsets[:, axis]) * halves[:, axis])[:, None]
    return points


def _straight_area(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int
) -> Floats:
    corners = face_points(boxes, which, axis, np.array(QUAD))
    corners = along_camera(axes, boxes, which, corners)
    front = corners[..., 0] > NEAREST_M
    area, whole = np.zeros(len(which)), front.all(axis=1)
    cut = ~whole & front.any(axis=1)
    if whole.any():
        ends = np.roll(corners[whole], -1, axis=1)
        area[whole] = _between(camera, corners[whole], ends)
    if cut.any():
        area[cut] = _between(camera, *_in_front(corners[cut], front[cut]))
    return area


def _in_front(corners: Floats, front: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Starts and ends (P, 5, 3) of the edges of quadrilaterals, cut at `NEAREST_M`.

    Edges that lie behind are points; the last joins where the outline leaves and comes back.
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


def _between(camera: Camera, starts: Floats, ends: Floats) -> Floats:
    """(P,) area inside the picture of outlines of edges (P, K, 3), through a pinhole."""
    lens = camera.projection
    (x0, y0), (x1, y1) = (
        (lens.cx - p[..., 1] * lens.fx / p[..., 0], lens.cy - p[..., 2] * lens.fy / p[..., 0])
        for p in (starts, ends)
    )
    parts = clamped_integral(x0, y0, x1, y1, float(camera.width), float(camera.height))
    return np.asarray(np.abs(parts.sum(axis=1)))


def _bent_area(camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int) -> Floats:
    area = np.zeros(len(which))
    offsets, halves = boxes.offsets[which], boxes.halves[which]
    ratio = np.sqrt((offsets**2).sum(axis=1) / (halves**2).sum(axis=1))
    nearer = 0.0
    for farther, pieces in PIECES:
        some = np.flatnonzero((ratio >= nearer) & (ratio < farther))
        if len(some):
            area[some] = _outline_area(camera, axes, boxes, which[some], axis, pieces)
        nearer = farther
    return area


def _outline_area(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int, pieces: int
) -> Floats:
    """Area of faces, of edges in so many pieces, inside the picture and the lens's field."""
    aperture = aperture_of(camera)
    outline = face_points(boxes, which, axis, _round_a_face(pieces))
    depth, left, up = np.moveaxis(along_camera(axes, boxes, which, outline), -1, 0)
    area = aperture.area(camera.projection.project(depth, left, up))
    behind = _holds_behind(axes, boxes, which, axis)
    whole = aperture.area(_picture(camera))[0]
    return np.where(behind, whole - area, area)


def _round_a_face(pieces: int) -> Floats:
    """(4 pieces, 2) places round a face, in halves."""
    corners = np.array(QUAD)
    share = (np.arange(pieces) / pieces)[None, :, None]
    steps = np.roll(corners, -1, axis=0) - corners
    return (corners[:, None] + steps[:, None] * share).reshape(-1, 2)


def _holds_behind(axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int) -> NDArray[np.bool_]:
    """Whether the direction right behind the camera meets faces: what is outlined is the rest."""
    back = np.broadcast_to(-axes[:, 0], (len(which), 3))
    speed = np.stack(boxes.along(which, back), axis=1)
    offsets, halves = boxes.offsets[which], boxes.halves[which]
    plane = offsets[:, axis] - np.sign(offsets[:, axis]) * halves[:, axis]
    runs = speed[:, axis] * plane > 0.0
    distance = plane / np.where(runs, speed[:, axis], 1.0)
    aside = np.abs(offsets - distance[:, None] * speed) < halves
    aside[:, axis] = True
    return runs & aside.all(axis=1)


def _picture(camera: Camera) -> tuple[Floats, Floats]:
    """Outline of the picture [px]."""
    wide, high = float(camera.width), float(camera.height)
    return np.array([[0.0, wide, wide, 0.0]]), np.array([[0.0, 0.0, high, high]])

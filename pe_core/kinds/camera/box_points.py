"""Points on boxes that say how much of a box's image is seen: a fixed grid on each face.

Each face that looks at the camera is cut into GRID by GRID parts alike. A part's middle stands for
it, and weighs as many pixels as its image has by the lens's density there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..placed_boxes import PlacedBoxes
from .box_area import along_camera, face_points
from .model import Camera

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

GRID = 8
"""Parts along a side of a face."""


@dataclass(frozen=True, slots=True)
class BoxPoints:
    """Points on boxes, (P,) each.

    `item` the box; `aims` (P, 3) where they are from the camera, ground axes [m]; `weight` the
    pixels that each stands for.
    """

    item: Ints
    aims: Floats
    weight: Floats


def box_points(camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints) -> BoxPoints:
    """Return the points of some boxes that are in the picture; box by box, in their order.

    Of a box none of whose points is in the picture (a sliver of it is) all that are in front count.
    """
    found = [_on_faces(camera, axes, boxes, which, axis) for axis in range(3)]
    item, aims, weight, inside = (np.concatenate(w) for w in zip(*found, strict=True))
    has = np.zeros(len(boxes.offsets), bool)
    has[item[inside]] = True
    kept = np.flatnonzero(inside | (~has[item] & (weight > 0.0)))
    kept = kept[np.argsort(item[kept], kind="stable")]
    return BoxPoints(item[kept], aims[kept], weight[kept])


def seen_share(points: BoxPoints, hidden: Flags, count: int) -> Floats:
    """(N,) share of each box's points, by weight, that nothing hides; 1 of boxes without any."""
    whole = np.bincount(points.item, points.weight, count)
    seen = np.bincount(points.item, np.where(hidden, 0.0, points.weight), count)
    return np.where(whole > 0.0, seen / np.where(whole > 0.0, whole, 1.0), 1.0)


def _on_faces(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, which: Ints, axis: int
) -> tuple[Ints, Floats, Floats, Flags]:
    """Points of the faces across an axis: box, aim, weight, and whether it is in the picture."""
    which = which[np.abs(boxes.offsets[which, axis]) > boxes.halves[which, axis]]
    own = face_points(boxes, which, axis, _grid()).reshape(-1, 3)
    item = np.repeat(which, GRID * GRID)
    depth, left, up = along_camera(axes, boxes, item, own).T
    square = (own * own).sum(axis=1)
    size = np.prod(np.delete(boxes.halves[item], axis, axis=1), axis=1)
    solid = np.abs(own[:, axis]) * size / (square * np.sqrt(square))
    weight, inside = _in_picture(camera, depth, left, up)
    return item, _along_ground(boxes, item, own), weight * solid, inside


def _in_picture(camera: Camera, depth: Floats, left: Floats, up: Floats) -> tuple[Floats, Flags]:
    """Pixels a steradian in directions, and whether they are in the picture."""
    lens = camera.projection
    theta = np.arctan2(np.hypot(left, up), depth)
    seen = theta < lens.edge
    density = np.zeros(len(depth))
    density[seen] = lens.density(depth[seen], left[seen], up[seen])
    x, y = lens.project(depth, left, up)
    inside = seen & (x >= 0.0) & (x <= camera.width) & (y >= 0.0) & (y <= camera.height)
    return density, inside


def _along_ground(boxes: PlacedBoxes, item: Ints, own: Floats) -> Floats:
    c, s = boxes.headings[item].T
    x, y, z = own.T
    return np.stack([c * x - s * y, s * x + c * y, z], axis=1)


def _grid() -> Floats:
    """(GRID^2, 2) middles of the parts of a face, in halves."""
    middles = (np.arange(GRID) + 0.5) * (2.0 / GRID) - 1.0
    return np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1).reshape(-1, 2)

"""Rays to boxes that say how much of a box's image is seen: a fixed lattice over the image.

Over the upright rectangle that holds a box's image lie RAYS places, a Fibonacci lattice: no two are
at the same height or side by side, so an edge that cuts the image, however it runs, has the right
share of them on each side to a hundredth or two. The rays through them that meet the box decide.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot, rotate
from ...scene.numbering import blocks
from ..placed_boxes import PlacedBoxes
from .box_area import BoxImages
from .model import Camera

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

RAYS, TURN = 144, 89
"""Neighbours in Fibonacci's row: place i is at i / RAYS across, and at i * TURN / RAYS down."""
BOXES_AT_ONCE = 512


@dataclass(frozen=True, slots=True)
class BoxRays:
    """Rays from a camera that meet boxes, (R,) each.

    `item` the box, by its rank among those asked for, ascending; `directions` (R, 3) unit, ground
    frame; `distance` to the box [m].
    """

    item: Ints
    directions: Floats
    distance: Floats


def rays_to_boxes(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, images: BoxImages, which: Ints
) -> BoxRays:
    """Return the rays through the images of boxes `which` (P,) that meet them."""
    found = list(_met(camera, axes, boxes, images, which))
    if not found:
        return BoxRays(np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0))
    return BoxRays(*(np.concatenate(w) for w in zip(*found, strict=True)))


def seen_share(rays: BoxRays, hidden: Flags, count: int) -> Floats:
    """(P,) share of each box's rays that nothing hides; 1 of a box that none of them meets."""
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


def _through(camera: Camera, axes: Floats, places: Floats) -> tuple[Floats, Ints]:
    """Unit directions, ground frame, through places (P, 2) of the picture, and of which places."""
    lens, (x, y) = camera.projection, places.T
    if not lens.is_straight:
        rays = lens.unproject(x, y)
        exists = np.flatnonzero(~np.isnan(rays[:, 0]))
        return rotate(axes, rays[exists]), exists
    rays = np.stack([np.ones(len(x)), (lens.cx - x) / lens.fx, (lens.cy - y) / lens.fy], axis=1)
    return rotate(axes, rays / np.sqrt(dot(rays, rays))[:, None]), np.arange(len(x))

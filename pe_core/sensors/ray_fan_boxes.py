"""Points on the sides of boxes that face a sensor, for sensors with a fan of rays."""

from __future__ import annotations

import numpy as np

from ..base.arrays import Floats
from ..geometry.poses import dot
from .box_rays import BoxRays
from .object_kernel import PlacedBoxes

NEAREST_M = 1e-6
"""Replaces the distance 0 [m]."""


def side_points(boxes: PlacedBoxes, count: int, turn: int) -> tuple[BoxRays, Floats]:
    """Return rays to points on the sides of boxes that face the sensor, and their solid angles.

    A side has `count` points, each with the solid angle (R,) of an equal piece of its area [sr]: a
    Fibonacci lattice, if `turn` and `count` are neighbouring Fibonacci numbers. No two points have
    the same distance from an edge of the side, so an edge that cuts the side at any angle has the
    right share of them on each side.
    """
    step = np.arange(count) + 0.5
    lattice = np.stack([step / count, (step * turn / count) % 1.0], axis=1) * 2.0 - 1.0
    items, places, pieces = [], [], []
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        facing = np.flatnonzero(np.abs(boxes.offsets[:, axis]) > boxes.halves[:, axis])
        offset, half = boxes.offsets[facing], boxes.halves[facing]
        points = np.repeat(offset[:, None], len(lattice), axis=1)
        points[:, :, axis] -= (np.sign(offset[:, axis]) * half[:, axis])[:, None]
        for k, other in enumerate(others):
            points[:, :, other] += half[:, other, None] * lattice[:, k]
        area = 4.0 * half[:, others[0]] * half[:, others[1]] / len(lattice)
        items.append(np.repeat(facing, len(lattice)))
        places.append(points.reshape(-1, 3))
        pieces.append(np.repeat(area * np.abs(points[:, 0, axis]), len(lattice)))
    item, (x, y, z) = np.concatenate(items), np.concatenate(places).T
    c, s = boxes.headings[item].T
    ground = np.stack([c * x - s * y, s * x + c * y, z], axis=1)
    distance = np.maximum(np.sqrt(dot(ground, ground)), NEAREST_M)
    solid = np.concatenate(pieces) / (distance * distance * distance)
    return BoxRays(item, ground / distance[:, None], distance), solid

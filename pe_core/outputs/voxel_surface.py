"""Closed surfaces of sets of cubes."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from .solid import Floats, Ints, Solid

Flags = NDArray[np.bool_]

SIDES = {
    (0, 1): ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    (0, -1): ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
    (1, 1): ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
    (1, -1): ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
    (2, 1): ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    (2, -1): ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)),
}
"""Corners of a cube's sides by axis and direction, counter-clockwise as seen from outside."""


def voxel_solid(name: str, cubes: Flags, lowest: Floats, side: float) -> Solid | None:
    """Return the surface of cubes (NX, NY, NZ) from a lowest corner (3,) [m] on; None of none.

    No edge of it may have four faces: see `joined`.
    """
    shape = np.array(cubes.shape) + 1
    quads = [_quads(cubes, shape, *key) for key in SIDES]
    corners = np.concatenate(quads)
    if not len(corners):
        return None
    used, index = np.unique(corners, return_inverse=True)
    a, b, c, d = index.reshape(-1, 4).T
    points = lowest + np.stack(np.unravel_index(used, tuple(shape)), axis=1) * side
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Solid(name, points, faces)


def _quads(cubes: Flags, shape: Ints, axis: int, way: int) -> Ints:
    """Return the sides (Q, 4) that are open to a direction, by numbers of lattice points."""
    padded = np.pad(cubes, 1)
    beside = np.roll(padded, -way, axis)[1:-1, 1:-1, 1:-1]
    place = np.argwhere(cubes & ~beside)
    corners = place[:, None] + np.array(SIDES[axis, way])
    numbers = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), tuple(shape))
    return np.asarray(numbers, np.int64).reshape(-1, 4)


def joined(cubes: Flags) -> Flags:
    """Fill a cube, the lower one, wherever two touch along an edge alone."""
    cubes = cubes.copy()
    while True:
        before = int(cubes.sum())
        for axes in combinations(range(3), 2):
            turned = np.moveaxis(cubes, axes, (0, 1))
            a, b = turned[:-1, :-1], turned[1:, :-1]
            c, d = turned[:-1, 1:], turned[1:, 1:]
            b |= a & d & ~b & ~c
            a |= b & c & ~a & ~d
        if int(cubes.sum()) == before:
            return cubes

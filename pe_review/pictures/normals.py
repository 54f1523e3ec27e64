"""Normals of a mesh's corners, smooth over what is curved and sharp where it is creased."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CREASE = math.cos(math.radians(38.0))
"""Faces that meet at a larger angle keep their edge."""
GRID_M = 1e-4
"""Corners this near to each other are one."""
MOST_AROUND = 24
"""Faces round a corner that are looked at."""
MANY = 250_000
"""Triangles from which on each has its own normal: at a pixel's size nobody sees the difference."""


def face_normals(triangles: Floats) -> Floats:
    """(F, 3) normals of triangles (F, 3, 3), as long as twice their areas."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def unit(vectors: Floats) -> Floats:
    """Vectors (..., 3) made one long; those without length stay."""
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return vectors / np.where(length > 0.0, length, 1.0)


def corner_normals(triangles: Floats) -> Floats:
    """(F, 3, 3) unit normals of corners: means over the faces around that are not creased.

    Whichever way round its neighbours are wound, a face keeps its own side.
    """
    normals = face_normals(triangles)
    own = np.repeat(normals, 3, axis=0)
    if len(triangles) > MANY:
        return unit(own).reshape(-1, 3, 3)
    order, start, count = _around(triangles.reshape(-1, 3))
    weighted, sharp = own[order], unit(own)[order]
    place = np.arange(len(order)) - start
    total = weighted.copy()
    for step in range(1, min(int(count.max(initial=1)), MOST_AROUND)):
        some = np.flatnonzero(count > step)
        other = start[some] + (place[some] + step) % count[some]
        along = (sharp[some] * sharp[other]).sum(axis=1)
        share = np.where(np.abs(along) > CREASE, np.sign(along), 0.0)
        total[some] += share[:, None] * weighted[other]
    found = np.empty_like(total)
    found[order] = unit(total)
    return found.reshape(-1, 3, 3)


def _around(corners: Floats) -> tuple[Ints, Ints, Ints]:
    """Corners in an order in which equal ones are together; where each run begins, how long."""
    cell = np.round(corners / GRID_M).astype(np.int64)
    number = (cell[:, 0] * 73_856_093) ^ (cell[:, 1] * 19_349_663) ^ (cell[:, 2] * 83_492_791)
    order = np.argsort(number, kind="stable")
    row = number[order]
    first = np.concatenate([[True], row[1:] != row[:-1]])
    run = np.cumsum(first) - 1
    begins = np.flatnonzero(first)
    sizes = np.diff(np.append(begins, len(row)))
    return order, begins[run], sizes[run]

"""The vehicle's top surface as a height map over the space's columns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .numbering import count_up
from .space import PerceptionSpace

Floats = NDArray[np.float64]


def top_heights(triangles: Floats, space: PerceptionSpace) -> Floats:
    """(nx, ny) highest z of the triangles above each column's centre [m]; -inf where none is.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Ground frame [m].
    space : PerceptionSpace
    """
    nx, ny, _ = space.shape
    heights = np.full(nx * ny, -np.inf)
    face, column = _candidates(triangles, space)
    x = space.centers(0)[column // ny]
    y = space.centers(1)[column % ny]
    inside, z = _height_at(triangles[face], x, y)
    np.maximum.at(heights, column[inside], z[inside])
    return heights.reshape(nx, ny)


def _candidates(triangles: Floats, space: PerceptionSpace) -> tuple[NDArray, NDArray]:
    """(triangle, column) pairs whose column centre lies in the triangle's bounding rectangle."""
    first, last = [], []
    for axis in (0, 1):
        w = (triangles[:, :, axis] - space.origin[axis]) / space.interval - 0.5
        limit = space.shape[axis] - 1
        first.append(np.clip(np.ceil(w.min(axis=1)), 0, limit + 1).astype(int))
        last.append(np.clip(np.floor(w.max(axis=1)), -1, limit).astype(int))
    wide, high = (np.maximum(hi - lo + 1, 0) for lo, hi in zip(first, last, strict=True))
    n = wide * high
    step, rows = count_up(n), np.repeat(np.maximum(high, 1), n)
    i = np.repeat(first[0], n) + step // rows
    j = np.repeat(first[1], n) + step % rows
    return np.repeat(np.arange(len(triangles)), n), i * space.shape[1] + j


def _height_at(triangles: Floats, x: Floats, y: Floats) -> tuple[NDArray[np.bool_], Floats]:
    """Whether (x, y) lies in each triangle seen from above, and the plane's z there."""
    dx, dy = triangles[..., 0] - x[:, None], triangles[..., 1] - y[:, None]
    areas = np.stack(
        [dx[:, i] * dy[:, j] - dx[:, j] * dy[:, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1
    )
    total = areas.sum(axis=1)
    inside = ((areas >= 0).all(axis=1) | (areas <= 0).all(axis=1)) & (total != 0)
    z = (areas * triangles[..., 2]).sum(axis=1) / np.where(total == 0, 1.0, total)
    return inside, z

"""Boxes to voxels: how often each column and each layer of the space is inside a box.

All counts are whole numbers, so the result does not depend on the order of the boxes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..scene.frozen import frozen
from ..scene.space import PerceptionSpace
from .boxes import OUTSIDE, Boxes, BoxReport
from .classes import Floats, Shape, normed

Ints = NDArray[np.int64]

ROWS_AT_ONCE = 1 << 18
TIE_DECIMALS = 9
"""Edges are rounded to this many decimals of a voxel, so that a box whose edge runs through voxel
centres owns its lower ones whatever its arithmetic left over."""
STRAIGHT = 1e-12
"""A sine or cosine below this is zero: the box stands along the grid."""


@dataclass(frozen=True, slots=True)
class Voxelised:
    """The shape of every class on one space, and what became of the boxes."""

    shapes: tuple[Shape, ...]
    report: BoxReport


@lru_cache(maxsize=2)
def voxelised(boxes: Boxes, space: PerceptionSpace) -> Voxelised:
    """Return boxes as densities over a space, class by class in the order of `Boxes.classes`.

    A voxel belongs to a box when its centre lies inside; a box without any (thinner than a voxel)
    has the column or layer that holds its own centre. A class that is not met in the space has no
    mass. The last two results are kept, by the boxes (the object) and the space.

    Raises
    ------
    InputError
        When no box is in the space.
    """
    shapes, taken = [], 0
    for name in boxes.classes:
        shape, count = _class_counts(_Footprints(boxes, np.flatnonzero(boxes.names == name)), space)
        shapes.append(shape)
        taken += count
    if not taken:
        bounds = ", ".join(f"{a} {list(getattr(space, a))}" for a in "xyz")
        expected = f"a box in the space ({bounds}), in the ground frame of the vehicle"
        raise InputError(boxes.source, "boxes", expected, f"all {len(boxes):,} outside")
    outside = len(boxes) - taken
    reasons = (*([(OUTSIDE, outside)] if outside else []), *boxes.left_out)
    return Voxelised(tuple(shapes), BoxReport(boxes.source, taken, reasons))


class _Footprints:
    """Some boxes, with the sines of their yaws: by scalar functions, alike in all builds."""

    def __init__(self, boxes: Boxes, some: Ints) -> None:
        self.x, self.y, self.z = boxes.x[some], boxes.y[some], boxes.z[some]
        self.along, self.across = boxes.length[some] / 2.0, boxes.width[some] / 2.0
        self.up = boxes.height[some] / 2.0
        yaws = boxes.yaw[some].tolist()
        self.cos, self.sin = (np.array([f(a) for a in yaws]) for f in (math.cos, math.sin))
        for values in (self.cos, self.sin):
            values[np.abs(values) < STRAIGHT] = 0.0


def _class_counts(boxes: _Footprints, space: PerceptionSpace) -> tuple[Shape, int]:
    """Return a class's shape, and how many of its boxes are in the space."""
    nx, ny, nz = space.shape
    first, last = _layers(boxes, space)
    layers = last - first
    steps = np.zeros((nx, ny + 1), np.int64)  # differences along y: spans cost two additions each
    columns = np.zeros(len(layers), np.int64)
    for which, i, start, end in _rows(boxes, space):
        np.add.at(steps, (i, start), layers[which])
        np.subtract.at(steps, (i, end), layers[which])
        np.add.at(columns, which, end - start)
    thin = np.flatnonzero(columns == 0)
    i, j = _voxel_of(boxes.x[thin], space, 0), _voxel_of(boxes.y[thin], space, 1)
    held = (i >= 0) & (j >= 0)
    thin, i, j = thin[held], i[held], j[held]
    np.add.at(steps, (i, j), layers[thin])
    np.subtract.at(steps, (i, j + 1), layers[thin])
    columns[thin] = 1
    rises = np.zeros(nz + 1, np.int64)
    np.add.at(rises, first, columns)
    np.subtract.at(rises, last, columns)
    ground, profile = np.cumsum(steps, axis=1)[:, :-1], np.cumsum(rises)[:-1]
    shape = normed(ground, profile)
    for values in shape:
        frozen(values)  # they are kept for the next who asks
    return shape, int(((columns > 0) & (layers > 0)).sum())


def _layers(boxes: _Footprints, space: PerceptionSpace) -> tuple[Ints, Ints]:
    """First layer of each box, and the one after its last."""
    first = _first_center(boxes.z - boxes.up, space, 2)
    last = _first_center(boxes.z + boxes.up, space, 2)
    own = _voxel_of(boxes.z, space, 2)
    thin = (first == last) & (own >= 0)
    return np.where(thin, own, first), np.where(thin, own + 1, last)


def _rows(boxes: _Footprints, space: PerceptionSpace) -> Iterator[tuple[Ints, Ints, Ints, Ints]]:
    """Yield the rows of columns inside boxes: box, index along x, first along y, one after last."""
    reach = np.abs(boxes.cos) * boxes.along + np.abs(boxes.sin) * boxes.across
    first = _first_center(boxes.x - reach, space, 0)
    counts = _first_center(boxes.x + reach, space, 0) - first
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    for start in range(0, total, ROWS_AT_ONCE):
        row = np.arange(start, min(start + ROWS_AT_ONCE, total))
        which = np.searchsorted(ends, row, side="right")
        i = first[which] + row - (ends - counts)[which]
        low, high = _across(boxes, which, space.centers(0)[i] - boxes.x[which])
        low, high = (boxes.y[which] + edge for edge in (low, high))
        begin, end = (_first_center(edge, space, 1) for edge in (low, high))
        yield which, i, begin, np.maximum(begin, end)


def _across(boxes: _Footprints, which: Ints, dx: Floats) -> tuple[Floats, Floats]:
    """Where a line across, at `dx` from the boxes' centres, enters and leaves their rectangles.

    Both are lengths along y from the centre: the line is clipped to the strip between the long
    sides and to that between the short ones.
    """
    cos, sin = boxes.cos[which], boxes.sin[which]
    long_low, long_high = _strip(sin * dx, boxes.across[which], cos)
    short_low, short_high = _strip(-cos * dx, boxes.along[which], sin)
    return np.maximum(long_low, short_low), np.minimum(long_high, short_high)


def _strip(middle: Floats, half: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Solve |slope * y - middle| <= half for y; everything where the slope is zero."""
    straight = slope == 0.0
    slope = np.where(straight, 1.0, slope)
    center, reach = middle / slope, half / np.abs(slope)
    low, high = center - reach, center + reach
    return np.where(straight, -np.inf, low), np.where(straight, np.inf, high)


def _first_center(edge: Floats, space: PerceptionSpace, axis: int) -> Ints:
    """Index of the first voxel centre at or above an edge, 0 to the number of voxels."""
    steps = (edge - space.origin[axis]) / space.interval - 0.5
    clipped = np.clip(steps, 0.0, space.shape[axis])
    return np.ceil(np.round(clipped, TIE_DECIMALS)).astype(np.int64)


def _voxel_of(value: Floats, space: PerceptionSpace, axis: int) -> Ints:
    """Index of the voxel that holds a coordinate, -1 outside the space."""
    count = space.shape[axis]
    steps = np.clip((value - space.origin[axis]) / space.interval, -1.0, count)
    index = np.floor(np.round(steps, TIE_DECIMALS)).astype(np.int64)
    return np.where(index < count, index, -1)

"""Voxelization of labelled boxes: how often each column and each layer of the space is in a box.

All counts are integers, so the result does not depend on the order of the boxes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..base.arrays import Floats, Ints, read_only
from ..base.errors import InputError
from ..geometry.grids import PerceptionSpace
from .boxes import OUTSIDE, Boxes, BoxReport
from .classes import Shape, normed

ROWS_AT_ONCE = 1 << 18
TIE_DECIMALS = 9
"""Edges are rounded to this many decimals of a voxel: a box whose edge runs through voxel centres
owns those at its lower edge, whatever the rounding errors."""
STRAIGHT = 1e-12
"""A sine or cosine below this counts as zero: the box is parallel to the grid."""


class Voxelised(NamedTuple):
    """The density of every class on one space, and the report on the boxes."""

    shapes: tuple[Shape, ...]
    report: BoxReport


@lru_cache(maxsize=2)
def voxelised(boxes: Boxes, space: PerceptionSpace) -> Voxelised:
    """Return boxes as densities over a space, class by class in the order of `Boxes.classes`.

    A voxel belongs to a box if its centre lies inside. A box without any voxel centre (thinner than
    a voxel) gets the column or layer of its own centre. A class without boxes in the space has no
    mass. `InputError` when no box is in the space. The last two results are cached.
    """
    shapes, inside = [], 0
    for name in boxes.classes:
        shape, count = _class_counts(_Footprints(boxes, np.flatnonzero(boxes.names == name)), space)
        shapes.append(shape)
        inside += count
    if not inside:
        bounds = ", ".join(f"{a} {list(getattr(space, a))}" for a in "xyz")
        expected = f"a box in the space ({bounds}), in the ground frame of the vehicle"
        raise InputError(boxes.source, "boxes", expected, f"all {len(boxes):,} outside")
    outside = len(boxes) - inside
    reasons = (*([(OUTSIDE, outside)] if outside else []), *boxes.left_out)
    return Voxelised(tuple(shapes), BoxReport(boxes.source, inside, reasons))


class _Footprints:
    """Centres and half sizes of some boxes, and cosine and sine of their yaws.

    The sines are those of `math`, which are the same in all builds of NumPy.
    """

    def __init__(self, boxes: Boxes, index: Ints) -> None:
        self.x, self.y, self.z = boxes.x[index], boxes.y[index], boxes.z[index]
        self.along, self.across = boxes.length[index] / 2.0, boxes.width[index] / 2.0
        self.up = boxes.height[index] / 2.0
        yaws = boxes.yaw[index].tolist()
        self.cos, self.sin = (np.array([f(a) for a in yaws]) for f in (math.cos, math.sin))
        for values in (self.cos, self.sin):
            values[np.abs(values) < STRAIGHT] = 0.0


def _class_counts(boxes: _Footprints, space: PerceptionSpace) -> tuple[Shape, int]:
    """Return the density of a class, and how many of its boxes are in the space."""
    nx, ny, nz = space.shape
    first, last = _layers(boxes, space)
    layers = last - first
    steps = np.zeros(
        (nx, ny + 1), np.int64
    )  # differences along y: a run of columns costs two additions
    columns = np.zeros(len(layers), np.int64)
    for which, i, start, end in _rows(boxes, space):
        np.add.at(steps, (i, start), layers[which])
        np.subtract.at(steps, (i, end), layers[which])
        np.add.at(columns, which, end - start)
    thin = np.flatnonzero(columns == 0)
    i, j = _voxel_of(boxes.x[thin], space, 0), _voxel_of(boxes.y[thin], space, 1)
    inside = (i >= 0) & (j >= 0)
    thin, i, j = thin[inside], i[inside], j[inside]
    np.add.at(steps, (i, j), layers[thin])
    np.subtract.at(steps, (i, j + 1), layers[thin])
    columns[thin] = 1
    rises = np.zeros(nz + 1, np.int64)
    np.add.at(rises, first, columns)
    np.subtract.at(rises, last, columns)
    ground, profile = np.cumsum(steps, axis=1)[:, :-1], np.cumsum(rises)[:-1]
    shape = normed(ground, profile)
    for values in shape:
        read_only(values)  # the caller gets the cached arrays
    return shape, int(((columns > 0) & (layers > 0)).sum())


def _layers(boxes: _Footprints, space: PerceptionSpace) -> tuple[Ints, Ints]:
    """First layer of each box, and the one after its last."""
    first = _first_center(boxes.z - boxes.up, space, 2)
    last = _first_center(boxes.z + boxes.up, space, 2)
    own = _voxel_of(boxes.z, space, 2)
    thin = (first == last) & (own >= 0)
    return np.where(thin, own, first), np.where(thin, own + 1, last)


def _rows(boxes: _Footprints, space: PerceptionSpace) -> Iterator[tuple[Ints, Ints, Ints, Ints]]:
    """Yield rows of columns inside boxes: box, index along x, first along y, one past the last."""
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
    """Where a line along y, at `dx` from the boxes' centres, enters and leaves their rectangles.

    Both are offsets in y from the centre: the line is clipped to the strip between the long sides
    and to the strip between the short ones.
    """
    cos, sin = boxes.cos[which], boxes.sin[which]
    long_low, long_high = _strip(sin * dx, boxes.across[which], cos)
    short_low, short_high = _strip(-cos * dx, boxes.along[which], sin)
    return np.maximum(long_low, short_low), np.minimum(long_high, short_high)


def _strip(middle: Floats, half: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Solve |slope * y - middle| <= half for y; all y where the slope is zero."""
    parallel = slope == 0.0
    slope = np.where(parallel, 1.0, slope)
    center, reach = middle / slope, half / np.abs(slope)
    low, high = center - reach, center + reach
    return np.where(parallel, -np.inf, low), np.where(parallel, np.inf, high)


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

"""Which run of a fan's channels passes through a box: the box clipped by the plane of an azimuth.

**Upright LiDAR** (`PlanarBoxes`, `upright_runs`). The plane is vertical. Seen from above it is a
ray; a side of the box's rectangle at a distance X along its normal is met at ``X / p``, p being the
ray's component along the normal. Kernels work with the inverse, which is linear in the ray: the ray
is inside from the greatest distance of the near sides to the least distance of the far sides, so
from the least inverse of the former to the greatest inverse of the latter. The channels have slopes
between two quotients of height and distance.

**Tilted LiDAR** (`TiltedBoxes`, `tilted_runs`). The plane contains the LiDAR's axis. Along a
beam of slope s in it the inverse distance of a side is linear in s and in the azimuth's unit
vector. The beam meets the box where the inverse of each near side is above that of each far side;
so each pair of sides bounds s from below or above, by a number that again is linear in the vector.

Where rounding could decide, a run is unsure, and its beams are left to an exact test.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...geometry.poses import dot
from ..boxes import PlacedBoxes
from .fan_runs import RotatedFan, RunBlock

SideLines = tuple[Floats, Floats]
"""(a, b), (N,) each: along a ray (x, y) the inverse distance of a side is ``a x + b y`` [1/m]."""
PairBound = tuple[Floats, Floats, Floats, Floats]
"""Bounds (N,) of slopes through boxes by a pair of sides: a, b, lower, upper. The bound at azimuth
(x, y) is ``a x + b y``, plus 0 where it is a lower one, else minus infinity; or plus 0 where it is
an upper one, else infinity."""
MIN_BESIDE_M = 1e-3
"""A box has all beams tested if the sensor, seen from above, is nearer to it than this."""
IN_LINE_M = 1e-5  # A box with a side this nearly in line with the sensor is unsure
GRAZING = 1e-10
"""A ray whose inverse distances to where it enters and leaves differ by less is unsure [1/m]."""
ZERO_RISE = 1e-12
"""A pair of sides whose inverse distances differ by less per slope is decided by azimuth alone."""
SMALL_RISE = 1e-6  # A box with a pair between ZERO_RISE and this is unsure
TINY_RISE = 1e-30  # Replaces a rise of 0 as a divisor
NEAR = 3
FAR = 6
MAX_PAIRS = 9
"""Sides that may face a sensor and away from it, and the most pairs of them that differ."""
DISTANCE_MARGIN_M = 1e-3
"""Distances of a box's nearest and farthest point are moved apart by this, against rounding."""


@dataclass(frozen=True, slots=True)
class PlanarBoxes:
    """Boxes seen from above, from an upright LiDAR; (N,) each.

    `first` and `last` are azimuths of corners [rad], `distance` is that of the rectangle [m].
    `beside` flags a sensor clearly outside of it, `in_line` one nearly in line with a side. `near`
    and `far` are the sides that face the sensor and the others; one twice where there are fewer.
    """

    first: Floats
    last: Floats
    distance: Floats
    beside: Flags
    in_line: Flags
    near: tuple[SideLines, SideLines]
    far: tuple[SideLines, SideLines, SideLines]

    @classmethod
    def of(cls, boxes: PlacedBoxes) -> "PlanarBoxes":
        """Project boxes on the ground."""
        x, y, _ = boxes.offsets.T
        long, wide, _ = boxes.halves.T
        out_x = np.abs(x) - long
        out_y = np.abs(y) - wide
        first, last = _azimuths(boxes)
        return cls(
            first,
            last,
            np.hypot(np.maximum(out_x, 0.0), np.maximum(out_y, 0.0)),
            np.maximum(out_x, out_y) > MIN_BESIDE_M,
            np.minimum(np.abs(out_x), np.abs(out_y)) < IN_LINE_M,
            *_sides(boxes, out_x > 0.0, out_y > 0.0),
        )


def _azimuths(boxes: PlacedBoxes) -> tuple[Floats, Floats]:
    """First and last azimuth (N,) of the corners [rad], where the sensor is beside the box."""
    x, y, _ = boxes.offsets.T
    long, wide, _ = boxes.halves.T
    c, s = boxes.headings.T
    square = x * x + y * y
    turns = []
    for side in (1.0, -1.0):
        across = side * x * wide - y * long
        along = x * long + side * y * wide
        turns += [np.arctan2(across, square + along), np.arctan2(-across, square - along)]
    middle = np.arctan2(s * x + c * y, c * x - s * y)
    return middle + np.minimum.reduce(turns), middle + np.maximum.reduce(turns)


def _sides(
    boxes: PlacedBoxes, out_x: Flags, out_y: Flags
) -> tuple[tuple[SideLines, SideLines], tuple[SideLines, SideLines, SideLines]]:
    """Near and far sides; `out_x`, `out_y` flag a sensor outside the strip between two sides."""
    x, y, _ = boxes.offsets.T
    long, wide, _ = boxes.halves.T
    c, s = boxes.headings.T
    long, wide = (np.copysign(half, at) for half, at in ((long, x), (wide, y)))
    with np.errstate(divide="ignore"):  # of boxes that the sensor is not beside
        ends = 1.0 / (x - long), 1.0 / (x + long)
        flanks = 1.0 / (y - wide), 1.0 / (y + wide)
    front, back = ((c * per, s * per) for per in ends)
    flank, other = ((-s * per, c * per) for per in flanks)
    near = _either(out_x, front, flank), _either(out_y, flank, front)
    return near, (back, other, _either(out_x, _either(out_y, other, flank), front))


def _either(flags: Flags, one: SideLines, other: SideLines) -> SideLines:
    """Lines of one side where flagged, else of the other."""
    a, b = (np.where(flags, v, w) for v, w in zip(one, other, strict=True))
    return a, b


def upright_runs(
    fan: RotatedFan, boxes: PlacedBoxes, planar: PlanarBoxes, index: Ints
) -> Iterator[RunBlock]:
    """Yield the runs of an upright LiDAR's fan, in the ground frame, through boxes. `index` (M,)
    are boxes that the sensor is `beside`. Fast because each side costs two products and a sum for a
    run, and a run two table look-ups."""
    for block, column in fan.columns(planar.first[index], planar.last[index]):
        box = index[block]
        x, y = (np.take(w, column) for w in fan.rays)
        buffer = np.empty(column.shape)
        near, flank = (_inverse(side, box, x, y, buffer=buffer) for side in planar.near)
        np.minimum(near, flank, out=near)
        far, *others = (_inverse(side, box, x, y, buffer=buffer) for side in planar.far)
        for other in others:
            np.maximum(far, other, out=far)
        gap = near - far
        middle = boxes.offsets[box, 2]
        half = boxes.halves[box, 2]
        bottom, top = (z * fan.slopes.scale for z in (middle - half, middle + half))
        one = bottom * near
        other = bottom * far
        low, low_unsure = fan.slopes.below(np.minimum(one, other, out=one))
        np.multiply(top, near, out=one)
        np.multiply(top, far, out=other)
        high, high_unsure = fan.slopes.below(np.maximum(one, other, out=one))
        unsure = (np.abs(gap) < GRAZING) | planar.in_line[box] | low_unsure | high_unsure
        high[gap <= 0.0] = 0
        np.maximum(high, low, out=high)
        column[column >= fan.count] -= fan.count
        yield RunBlock(box, column, low, high, near=near, far=far, unsure=unsure)


def _inverse(side: SideLines, box: Ints, x: Floats, y: Floats, buffer: Floats) -> Floats:
    """Inverse distances (A, N) of sides along rays [1/m]."""
    a, b = (w[box] for w in side)
    inverse = a * x
    inverse += np.multiply(b, y, out=buffer)
    return inverse


@dataclass(frozen=True, slots=True)
class TiltedBoxes:
    """Boxes seen along a tilted LiDAR's own axes; (N,) each.

    `bounds` are slopes by pair of sides, `unsure` flags boxes that rounding could decide, `outside`
    those that the sensor is clearly outside of; `near` is an inverse distance no smaller than that
    of any point of the box, `far` one no larger [1/m].
    """

    bounds: tuple[PairBound, ...]
    unsure: Flags
    outside: Flags
    near: Floats
    far: Floats

    @classmethod
    def of(cls, boxes: PlacedBoxes, ground_from_sensor: Floats) -> "TiltedBoxes":
        """Pair the near and far sides of boxes."""
        out = np.abs(boxes.offsets) - boxes.halves
        near, far = _inverse_distances(boxes, boxes.axes_in(ground_from_sensor), out)
        bounds = []
        unsure = np.abs(out).min(axis=1) < IN_LINE_M
        for first, second in _different_pairs(out):
            rows = np.arange(len(out))
            x, y, rise = (near[first, :, rows] - far[second, :, rows]).T
            unsure |= (np.abs(rise) > ZERO_RISE) & (np.abs(rise) < SMALL_RISE)
            rise = np.where(np.abs(rise) > ZERO_RISE, rise, TINY_RISE)
            lower = rise > 0.0
            limits = np.where(lower, 0.0, -np.inf), np.where(lower, np.inf, 0.0)
            bounds.append((-x / rise, -y / rise, *limits))
        beyond = np.maximum(out, 0.0)
        distance = np.maximum(np.sqrt(dot(beyond, beyond)) - DISTANCE_MARGIN_M, DISTANCE_MARGIN_M)
        corner = np.abs(boxes.offsets) + boxes.halves
        farthest = np.sqrt(dot(corner, corner)) + DISTANCE_MARGIN_M
        outside = out.max(axis=1) > IN_LINE_M
        return cls(tuple(bounds), unsure, outside, 1.0 / distance, far=1.0 / farthest)


def _different_pairs(out: Floats) -> Iterator[Ints]:
    """Yield near and far sides (2, N) of each box, pair by pair; the last one again and again."""
    facing = out > 0.0
    near, far = np.divmod(np.arange(NEAR * FAR), FAR)
    different = facing[:, near] & ((far % 2 == 0) | ~facing[:, far // 2])
    order = np.argsort(~different, axis=1, kind="stable")[:, :MAX_PAIRS]
    last = np.minimum(np.arange(MAX_PAIRS), different.sum(axis=1)[:, None] - 1)
    for column in np.take_along_axis(order, np.maximum(last, 0), axis=1).T:
        yield np.stack(np.divmod(column, FAR))


def _inverse_distances(
    boxes: PlacedBoxes, axes: list[Floats], out: Floats
) -> tuple[Floats, Floats]:
    """Inverse distances (3, 3, N) of sides that may face the sensor, and (6, 3, N) of far sides. A
    near side that does not face it is replaced by one that does."""
    near = []
    far = []
    with np.errstate(divide="ignore", invalid="ignore"):  # of sides that face the other way
        for k, axis in enumerate(axes):
            at = boxes.offsets[:, k]
            half = np.copysign(boxes.halves[:, k], at)
            back = axis / (at + half)
            front = axis / (at - half)
            near.append(front)
            far += [back, np.where(out[:, k] > 0.0, back, front)]
    best = np.argmax(out, axis=1)  # a side that faces the sensor
    facing = np.stack(near)[best, :, np.arange(len(best))].T
    near = [np.where(out[:, k] > 0.0, side, facing) for k, side in enumerate(near)]
    return np.stack(near), np.stack(far)


def tilted_runs(
    fan: RotatedFan, boxes: TiltedBoxes, spans: tuple[Floats, Floats], index: Ints
) -> Iterator[RunBlock]:
    """Yield the runs of a tilted LiDAR's fan, in the sensor frame, through boxes. `index` (M,) are
    boxes that the sensor is `outside` of, `spans` the first and last azimuths (N,) of all boxes
    [rad]. Fast because each pair of sides costs two products and a sum for a run."""
    for block, column in fan.columns(spans[0][index], spans[1][index]):
        box = index[block]
        scale = fan.slopes.scale
        x, y = (np.take(w, column) for w in fan.rays)
        low = np.full(column.shape, -np.inf)
        high = np.full(column.shape, np.inf)
        for bound in boxes.bounds:
            a, b, lower, upper = (w[box] for w in bound)
            value = a * x
            value += b * y
            np.maximum(low, value + lower, out=low)
            np.minimum(high, value + upper, out=high)
        first, first_unsure = fan.slopes.below(low * scale)
        last, last_unsure = fan.slopes.below(high * scale)
        last[low >= high] = 0
        np.maximum(last, first, out=last)
        column[column >= fan.count] -= fan.count
        near, far = (np.broadcast_to(w[box], column.shape) for w in (boxes.near, boxes.far))
        unsure = first_unsure | last_unsure | boxes.unsure[box]
        yield RunBlock(box, column, first, last, near=near, far=far, unsure=unsure)

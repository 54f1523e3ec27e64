"""Boxes seen from above, from a LiDAR: between which azimuths they lie, and how rays cross them.

Along a horizontal ray the side of a rectangle that lies at a distance X along its normal is met at
``X / p``, where p is the ray's part along that normal. Kernels work with the inverse, which is
linear in the ray: the ray is inside from the greater of the near sides' distances to the least of
the far sides', so from the least of the inverses of the one to the greatest of those of the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..placed_boxes import PlacedBoxes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
SideLines = tuple[Floats, Floats]
"""Along a ray (x, y) the inverse distance of sides (N,) is ``a x + b y`` [1/m]."""

BESIDE_M = 1e-3
"""A sensor nearer than this to a box, seen from above, or over it, has all its beams tested."""
IN_LINE_M = 1e-5
"""A side this nearly in line with the sensor is unsure."""


@dataclass(frozen=True, slots=True)
class BoxesFromAbove:
    """Boxes seen from above, (N,) each.

    `first` and `last` azimuth of the corners [rad]; `distance` of the rectangle [m]; `beside`
    whether the sensor is beside it, not over it or next to it; `in_line` whether a side nearly is.
    `near` and `far` hold inverse distances of the sides that the sensor sees and does not see, with
    one of them twice where there are fewer.
    """

    first: Floats
    last: Floats
    distance: Floats
    beside: Flags
    in_line: Flags
    near: tuple[SideLines, SideLines]
    far: tuple[SideLines, SideLines, SideLines]

    @classmethod
    def of(cls, boxes: PlacedBoxes) -> BoxesFromAbove:
        """Look at boxes from above."""
        (x, y, _), (long, wide, _) = boxes.offsets.T, boxes.halves.T
        out_x, out_y = np.abs(x) - long, np.abs(y) - wide
        first, last = _azimuths(boxes)
        return cls(
            first,
            last,
            np.hypot(np.maximum(out_x, 0.0), np.maximum(out_y, 0.0)),
            np.maximum(out_x, out_y) > BESIDE_M,
            np.minimum(np.abs(out_x), np.abs(out_y)) < IN_LINE_M,
            *_sides(boxes, out_x > 0.0, out_y > 0.0),
        )


def _azimuths(boxes: PlacedBoxes) -> tuple[Floats, Floats]:
    """First and last azimuth of the corners; right where the sensor is beside the box."""
    (x, y, _), (long, wide, _), (c, s) = boxes.offsets.T, boxes.halves.T, boxes.headings.T
    square, turns = x * x + y * y, []
    for side in (1.0, -1.0):
        across, along = side * x * wide - y * long, x * long + side * y * wide
        turns += [np.arctan2(across, square + along), np.arctan2(-across, square - along)]
    middle = np.arctan2(s * x + c * y, c * x - s * y)
    return middle + np.minimum.reduce(turns), middle + np.maximum.reduce(turns)


def _sides(
    boxes: PlacedBoxes, out_x: Flags, out_y: Flags
) -> tuple[tuple[SideLines, SideLines], tuple[SideLines, SideLines, SideLines]]:
    """Near and far sides, where the sensor is out of one strip between two sides at least."""
    (x, y, _), (long, wide, _), (c, s) = boxes.offsets.T, boxes.halves.T, boxes.headings.T
    long, wide = (np.copysign(half, at) for half, at in ((long, x), (wide, y)))
    with np.errstate(divide="ignore"):  # of boxes that the sensor is not beside
        ends = 1.0 / (x - long), 1.0 / (x + long)
        flanks = 1.0 / (y - wide), 1.0 / (y + wide)
    front, back = ((c * per, s * per) for per in ends)
    flank, other = ((-s * per, c * per) for per in flanks)
    near = _either(out_x, front, flank), _either(out_y, flank, front)
    return near, (back, other, _either(out_x, _either(out_y, other, flank), front))


def _either(which: Flags, one: SideLines, other: SideLines) -> SideLines:
    a, b = (np.where(which, v, w) for v, w in zip(one, other, strict=True))
    return a, b

"""Beams through single voxels, bounded from below and above by look-ups in single precision.

Seen from the sensor a cube lies inside an outer window of azimuth and elevation, and every beam of
an inner window passes through it. On a regular lattice the beams of a window are a product of two
counts. Where both windows hold the same beams, that number is m; `points` counts the rest.

The inner window is that of a slice of the cube: the plane through its centre that holds the sensor
frame's up direction and its two silhouette edges. docs/engine.md has a figure, and a voxel worked
by hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.numbering import blocks
from .slopes import SlopeBounds

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Counts = NDArray[np.int32]

MARGIN = np.float32(4e-6)
"""Windows are widened (outer) and narrowed (inner) by this, relative: single precision's rounding,
with room to spare."""
SLACK = np.float32(1e-4)
"""Cubes are taken larger (outer) and smaller (inner) by this, in sides: a point a thousand sides
away is known to half of it in single precision."""
AT_ONCE = 1 << 15
"""Voxels worked on together: all their arrays fit the cache."""
BALL = np.float32(0.867)
"""Radius of a ball around a cube: how far one that the sensor's axis may touch reaches."""
ON_AXIS = np.float32(1e-9)
"""Stands for the least distance from the sensor's axis of a cube that the axis may touch."""
LEAST_SHARE, MOST_SHARE = np.float32(0.85), np.float32(1.0 - 1e-5)
"""Ends of the share of the slice's width that the inner window has."""
WORTH_PICKING = 0.85
"""Inner windows are worked out where the outer ones hold beams, if no more than this share do."""


@dataclass(frozen=True, slots=True)
class Bracket:
    """Bounds (V,) of the number of beams through each voxel, and its outer window's beams.

    The outer window is channels `row` to ``row + rows - 1``, sorted by elevation, at azimuth steps
    `column` to ``column + columns - 1``, which may lie outside [0, azimuth_count).
    """

    least: Counts
    most: Counts
    row: Counts
    rows: Counts
    column: Counts
    columns: Counts


def bracket(
    points: Sequence[Singles],
    ground_from_sensor: Floats,
    slopes: SlopeBounds,
    azimuth_count: int,
) -> Bracket:
    """Bound the beams through unit cubes, for a full-circle LiDAR without azimuth offsets.

    Parameters
    ----------
    points : three (V,) float32
        Cube centres seen from the sensor along the ground axes, in voxel sides.
    ground_from_sensor : (3, 3) float
    slopes : SlopeBounds
    azimuth_count : int
    """
    out = Bracket(*(np.empty(len(points[0]), np.int32) for _ in range(6)))
    rotation = ground_from_sensor.astype(np.float32)
    step = np.float32(2.0 * np.pi / azimuth_count)
    for some in blocks(len(points[0]), AT_ONCE):
        seen = Silhouettes.of([p[some] for p in points], rotation, step)
        block = _bounds(seen, slopes, azimuth_count)
        for whole, part in zip(
            (out.least, out.most, out.row, out.rows, out.column, out.columns), block, strict=True
        ):
            whole[some] = part
    return out


@dataclass(frozen=True, slots=True)
class Silhouettes:
    """Cubes as they are seen, in the sensor frame; lengths in voxel sides, (V,) each.

    `flat` and `z` are the centre's distance from the sensor's axis and its height, `middle` its
    azimuth, in steps of `step` [rad]. `radial`, `sideways` and `up` are the cube's half edges along
    these directions, one a ground axis; `deep`, `wide` and `tall` their sums: half the extents.
    """

    flat: Singles
    z: Singles
    middle: Singles
    step: np.float32
    radial: list[Singles]
    sideways: list[Singles]
    up: Singles
    deep: Singles
    wide: Singles
    tall: np.float32

    @classmethod
    def of(cls, points: Sequence[Singles], rotation: Singles, step: np.float32) -> Silhouettes:
        """See cubes with centres along the ground axes."""
        x, y, z = (
            rotation[0, w] * points[0] + rotation[1, w] * points[1] + rotation[2, w] * points[2]
            for w in range(3)
        )
        flat = np.sqrt(x * x + y * y)
        safe = np.maximum(flat, np.float32(0.1))
        c, s = x / safe, y / safe
        c[flat == 0.0] = 1.0  # on the axis any azimuth does, but there has to be one
        half = rotation * np.float32(0.5)
        radial = [half[k, 0] * c + half[k, 1] * s for k in range(3)]
        sideways = [half[k, 1] * c - half[k, 0] * s for k in range(3)]
        deep, wide = (np.abs(a) + np.abs(b) + np.abs(c) for a, b, c in (radial, sideways))
        middle = np.arctan2(y, x) / step
        up = half[:, 2]
        return cls(flat, z, middle, step, radial, sideways, up, deep, wide, np.abs(up).sum())

    def some(self, which: NDArray[np.intp]) -> Silhouettes:
        """Return those of some cubes."""
        flat, z, middle, deep, wide = (
            w[which] for w in (self.flat, self.z, self.middle, self.deep, self.wide)
        )
        radial, sideways = ([w[which] for w in side] for side in (self.radial, self.sideways))
        step, up, tall = self.step, self.up, self.tall
        return Silhouettes(flat, z, middle, step, radial, sideways, up, deep, wide, tall)


def _bounds(seen: Silhouettes, slopes: SlopeBounds, count: int) -> tuple[Counts, ...]:
    """Fields of a `Bracket`."""
    deep, wide, tall = seen.deep + SLACK, seen.wide + SLACK, seen.tall + SLACK
    beside = seen.flat > deep * np.float32(1.1)
    near = np.where(beside, seen.flat - deep, ON_AXIS)
    far = np.where(beside, np.sqrt((seen.flat + deep) ** 2 + wide * wide), seen.flat + BALL)
    reach = wide / near / seen.step * (1 + MARGIN) + np.abs(seen.middle) * MARGIN + MARGIN
    reach = np.minimum(reach, np.float32(count))
    first, last = np.ceil(seen.middle - reach), np.floor(seen.middle + reach)
    columns = np.minimum(last - first + 1, count).astype(np.int32)
    high = slopes.bins(_slope(seen.z + tall, near, far))
    low = slopes.bins(_slope(seen.z - tall, far, near))
    row = slopes.below[low]
    rows = np.maximum(slopes.upto[high] - row, 0)
    most = rows * columns
    least = _least(seen, slopes, most, beside)
    columns = np.where(beside, columns, np.int32(count))  # it surrounds the sensor's axis
    return least, rows * columns, row, rows, first.astype(np.int32), columns


def _least(
    seen: Silhouettes, slopes: SlopeBounds, most: Counts, beside: NDArray[np.bool_]
) -> Counts:
    """Beams of the inner windows, where there are any in the outer ones."""
    some = np.flatnonzero(beside & (most > 0))
    if len(some) > WORTH_PICKING * len(most):
        rows, columns = _inner(seen, slopes)
        return np.where(beside, np.minimum(rows * columns, most), 0)
    least = np.zeros_like(most)
    rows, columns = _inner(seen.some(some), slopes)
    least[some] = np.minimum(rows * columns, most[some])
    return least


def _slope(up: Singles, over_if_above: Singles, over_if_below: Singles) -> Singles:
    return up / np.where(up > 0, over_if_above, over_if_below)


def _inner(seen: Silhouettes, slopes: SlopeBounds) -> tuple[Counts, Counts]:
    """Rows and columns of the inner window."""
    width, height, skew = slice_through(seen)
    drift = np.abs(skew) * width
    near, far = seen.flat - drift, np.sqrt((seen.flat + drift) ** 2 + width * width)
    near = np.maximum(near, np.float32(1e-3))
    high = slopes.bins(_slope(seen.z + height, far, near))
    low = slopes.bins(_slope(seen.z - height, near, far))
    rows = np.maximum(slopes.below[high] - slopes.upto[low], 0)
    left, right = (
        width / np.maximum(reach, np.float32(1e-3)) / seen.step
        for reach in (seen.flat + skew * width, seen.flat - skew * width)
    )
    # atan(t) >= t - t^3 / 3, so that no arc tangent is needed
    left, right = (t * (1 - (t * seen.step) ** 2 / 3) * (1 - MARGIN) for t in (left, right))
    slack = np.abs(seen.middle) * MARGIN + MARGIN
    columns = np.floor(seen.middle + left - slack) - np.ceil(seen.middle - right + slack) + 1
    return rows, np.maximum(columns, 0).astype(np.int32)


def slice_through(seen: Silhouettes) -> tuple[Singles, Singles, Singles]:
    """Half width and half height of a rectangle inside the slice, and how far the slice recedes.

    That is the distance by which it is farther from the axis, for each side it reaches to the left.
    """
    a, b, c = (np.copysign(r, r * s) for r, s in zip(seen.radial, seen.sideways, strict=True))
    skew: Singles = (a + b + c) / seen.wide
    tilt: list[Singles] = [
        np.float32(2) * np.abs(b + skew * a)
        for a, b in zip(seen.radial, seen.sideways, strict=True)
    ]
    rectangle = _rectangle(tilt, np.abs(2 * seen.up))
    width, height = (np.maximum(side - SLACK, 0) for side in rectangle)
    return width, height, skew


def _rectangle(tilt: list[Singles], up: Singles) -> tuple[Singles, Singles]:
    """Half width and half height of a rectangle in the slice.

    The slice is where ``|s tilt_k + u up_k| <= 1/2`` for the three axes k of the cube. A tilted
    one has no height at its full width, and about the cube's from the share ``1 - up_k`` of it on,
    k being the second most upright axis.
    """
    half, none = np.float32(0.5), np.float32(1e-9)
    widest = half / np.maximum(np.maximum(np.maximum(tilt[0], tilt[1]), tilt[2]), none)
    share = np.clip(np.float32(1.0) - np.sort(up)[1], LEAST_SHARE, MOST_SHARE)
    width = widest * share
    rooms = [(half - width * t) / max(u, none) for t, u in zip(tilt, up, strict=True)]
    height = np.minimum(np.minimum(rooms[0], rooms[1]), rooms[2])
    return width, np.maximum(height, 0)

"""Beams through single voxels, bounded from below and above by look-ups in single precision.

Seen from the sensor a cube lies inside an outer window of azimuth and elevation, and every beam of
an inner window passes through it. On a regular lattice the beams of a window are a product of two
counts. Where both windows hold the same beams, that number is m; `lidar_points` counts the rest.

The inner window is that of a slice of the cube: the plane through its centre that holds the sensor
frame's up direction and its two silhouette edges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .model import Lidar

Singles = NDArray[np.float32]
Counts = NDArray[np.int32]

BINS = 1 << 16
MARGIN = np.float32(4e-6)
"""Windows are widened (outer) and narrowed (inner) by this, relative: single precision's rounding,
with room to spare."""
SLACK = np.float32(1e-4)
"""Cubes are taken larger (outer) and smaller (inner) by this, in sides: a point a thousand sides
away is known to half of it in single precision."""
AT_ONCE = 1 << 15
"""Voxels worked on together: all their arrays fit the cache."""
ON_AXIS = np.float32(1e-9)
"""Stands for the least distance from the sensor's axis of a cube that the axis may touch."""
SLICE_WIDTHS = (1.0 - 1e-5, 0.97, 0.9)
"""Widths of the inner window tried, of the slice's: narrower is higher where the cube is tilted."""


@dataclass(frozen=True, slots=True)
class ChannelTable:
    """How many channels lie below a slope, by look-up, never too many and never too few.

    `below` counts channels surely below a bin's lower edge, `upto` those not above its upper edge.
    """

    low: float
    scale: float
    below: Counts
    upto: Counts

    @classmethod
    def of(cls, lidar: Lidar) -> ChannelTable:
        """Make the table over the tangents of a LiDAR's elevations."""
        slopes = np.tan(np.sort(lidar.elevations))
        room = 1e-3 * (1.0 + np.abs(slopes).max())
        edges = np.linspace(slopes[0] - room, slopes[-1] + room, BINS + 1)
        slack = float(MARGIN) * (1.0 + np.abs(edges))
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        below[0], upto[-1] = 0, len(slopes)
        scale = BINS / (edges[-1] - edges[0])
        return cls(float(edges[0]), float(scale), below.astype(np.int32), upto.astype(np.int32))

    def bins(self, slopes: Singles) -> Counts:
        """Bin of each slope."""
        scaled = (slopes - np.float32(self.low)) * np.float32(self.scale)
        return np.clip(scaled, 0, BINS - 1).astype(np.int32)


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
    ground_from_sensor: NDArray[np.float64],
    table: ChannelTable,
    azimuth_count: int,
) -> Bracket:
    """Bound the beams through unit cubes, for a full-circle LiDAR without azimuth offsets.

    Parameters
    ----------
    points : three (V,) float32
        Cube centres seen from the sensor along the ground axes, in voxel sides.
    ground_from_sensor : (3, 3) float
    table : ChannelTable
    azimuth_count : int
    """
    out = Bracket(*(np.empty(len(points[0]), np.int32) for _ in range(6)))
    rotation = ground_from_sensor.astype(np.float32)
    for start in range(0, len(points[0]), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        block = _block([p[some] for p in points], rotation, table, azimuth_count)
        for whole, part in zip(
            (out.least, out.most, out.row, out.rows, out.column, out.columns), block, strict=True
        ):
            whole[some] = part
    return out


def _block(
    points: Sequence[Singles], rotation: Singles, table: ChannelTable, count: int
) -> tuple[Counts, ...]:
    x, y, z = (
        rotation[0, w] * points[0] + rotation[1, w] * points[1] + rotation[2, w] * points[2]
        for w in range(3)
    )
    flat = np.sqrt(x * x + y * y)
    safe = np.maximum(flat, np.float32(0.1))
    c, s = x / safe, y / safe
    # half edges of the cube along the radial, sideways and up directions
    half = rotation * np.float32(0.5)
    radial = [half[k, 0] * c + half[k, 1] * s for k in range(3)]
    sideways = [half[k, 1] * c - half[k, 0] * s for k in range(3)]
    deep, wide = (np.abs(a) + np.abs(b) + np.abs(c) for a, b, c in (radial, sideways))
    deep, wide = deep + SLACK, wide + SLACK
    tall = np.abs(half[:, 2]).sum() + SLACK
    beside = flat > deep * np.float32(1.1)
    near = np.where(beside, flat - deep, ON_AXIS)
    far = np.sqrt((flat + deep) ** 2 + wide * wide)

    step = np.float32(2.0 * np.pi / count)
    middle = np.arctan2(y, x) / step
    reach = wide / near / step * (1 + MARGIN) + np.abs(middle) * MARGIN + MARGIN
    reach = np.minimum(reach, np.float32(count))
    first, last = np.ceil(middle - reach), np.floor(middle + reach)
    columns = np.minimum(last - first + 1, count).astype(np.int32)
    high = table.bins(_slope(z + tall, near, far))
    low = table.bins(_slope(z - tall, far, near))
    row = table.below[low]
    rows = np.maximum(table.upto[high] - row, 0)
    most = rows * columns

    inner_rows, inner_columns = _inner(
        flat, z, radial, sideways, wide, half[:, 2], table, middle, step
    )
    least = np.where(beside, np.minimum(inner_rows * inner_columns, most), 0)
    columns = np.where(beside, columns, np.int32(count))  # it surrounds the sensor's axis
    return least, rows * columns, row, rows, first.astype(np.int32), columns


def _slope(up: Singles, over_if_above: Singles, over_if_below: Singles) -> Singles:
    return up / np.where(up > 0, over_if_above, over_if_below)


def _inner(
    flat: Singles,
    z: Singles,
    radial: list[Singles],
    sideways: list[Singles],
    wide: Singles,
    up: Singles,
    table: ChannelTable,
    middle: Singles,
    step: np.float32,
) -> tuple[Counts, Counts]:
    """Rows and columns of the inner window."""
    safe = np.maximum(wide, np.float32(1e-6))
    a, b, c = (np.copysign(r, r * s) for r, s in zip(radial, sideways, strict=True))
    skew = (a + b + c) / safe
    tilt: list[Singles] = [
        np.float32(2) * np.abs(b + skew * a) for a, b in zip(radial, sideways, strict=True)
    ]
    a, b = (np.maximum(side - SLACK, 0) for side in _slice_window(tilt, np.abs(2 * up)))
    drift = np.abs(skew) * a
    near, far = flat - drift, np.sqrt((flat + drift) ** 2 + a * a)
    near = np.maximum(near, np.float32(1e-3))
    high = table.bins(_slope(z + b, far, near))
    low = table.bins(_slope(z - b, near, far))
    rows = np.maximum(table.below[high] - table.upto[low], 0)
    left, right = (
        a / np.maximum(reach, np.float32(1e-3)) / step
        for reach in (flat + skew * a, flat - skew * a)
    )
    # atan(t) >= t - t^3 / 3, so that no arc tangent is needed
    left, right = (t * (1 - (t * step) ** 2 / 3) * (1 - MARGIN) for t in (left, right))
    slack = np.abs(middle) * MARGIN + MARGIN
    columns = np.floor(middle + left - slack) - np.ceil(middle - right + slack) + 1
    return rows, np.maximum(columns, 0).astype(np.int32)


def _slice_window(tilt: list[Singles], up: Singles) -> tuple[Singles, Singles]:
    """Half width and half height of a rectangle in the slice, the larger of a few.

    The slice is where ``|s tilt_k + u up_k| <= 1/2`` for the three axes k of the cube.
    """
    half, none = np.float32(0.5), np.float32(1e-9)
    widest = half / np.maximum(np.maximum(np.maximum(tilt[0], tilt[1]), tilt[2]), none)
    width = height = area = np.zeros_like(widest)
    for share in SLICE_WIDTHS:
        a = widest * np.float32(share)
        rooms = [(half - a * t) / max(u, none) for t, u in zip(tilt, up, strict=True)]
        b = np.minimum(np.minimum(rooms[0], rooms[1]), rooms[2])
        better = a * b > area
        width, height = np.where(better, a, width), np.where(better, b, height)
        area = np.maximum(area, a * b)
    return width, height

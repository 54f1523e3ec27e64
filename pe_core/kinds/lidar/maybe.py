"""Which beams of a regular LiDAR the vehicle may stop: too many rather than too few, and quickly.

Seen from the sensor a box lies in a window of azimuths and slopes, so of beams too. The boxes of
the vehicle's tree are opened, largest first, until their windows are small; triangles that still
are large on their own get windows of their own corners. What no window holds is free.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.bins import greatest_of, least_of
from ...scene.geometry import rotate
from ...scene.raycast import SeenTriangles
from .lattice import Lattice

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

MARGIN = 1e-6
"""Windows are widened by this, relative: far more than rounding, far less than a step."""
LEAST_M = 1e-9
"""Stands for a distance from the sensor's axis of 0 [m]."""
STEEP = 1e9
"""Stands for a slope beyond all channels."""
SMALL = 48
"""Columns of a window from which on a box is opened."""


@dataclass(frozen=True, slots=True)
class BeamWindows:
    """Windows of beams, (N,) each: channels by elevation, azimuths in steps, ends included."""

    low: Ints
    high: Ints
    first: Ints
    last: Ints

    def __getitem__(self, some: NDArray) -> BeamWindows:
        """Return some of them."""
        return BeamWindows(self.low[some], self.high[some], self.first[some], self.last[some])


def may_be_stopped(seen: SeenTriangles, ground_from_sensor: Floats, lattice: Lattice) -> Flags:
    """(C, A) flags of a regular LiDAR's beams, lowest channel first.

    Parameters
    ----------
    seen : SeenTriangles
        The vehicle from where the beams start.
    ground_from_sensor : (3, 3) float
    lattice : Lattice
        One with `slope_bounds`.
    """
    marks = np.zeros((len(lattice.channels) + 1, 2 * lattice.count + 1), np.int32)
    for windows in _windows(seen, ground_from_sensor, lattice):
        _mark(marks, windows, lattice.count)
    once, again = marks[:, : lattice.count], marks[:, lattice.count : -1]
    again[:, 0] += once.sum(axis=1)  # windows that go on into the second turn
    once += again
    for row, before in zip(once[1:], once, strict=False):
        row += before  # five times as fast as a sum down the columns
    held: Flags = np.cumsum(once[:-1], axis=1) > 0
    return held


def _windows(
    seen: SeenTriangles, ground_from_sensor: Floats, lattice: Lattice
) -> Iterator[BeamWindows]:
    """Yield windows that together hold all that shows of the vehicle."""
    tree, level = seen.tree, len(seen.tree.boxes) - 1
    some = np.arange(len(tree.boxes[level])) if level >= 0 else np.zeros(0, np.int64)
    while level >= 0 and len(some):
        low, high = tree.boxes[level][some].transpose(1, 0, 2) - seen.origin
        windows = _of_boxes(low, high, ground_from_sensor, lattice)
        shown = windows.low <= windows.high
        large = windows.last - windows.first >= SMALL
        yield windows[np.flatnonzero(shown & ~large)]
        some = tree.below(some[shown & large], level)
        level -= 1
    if len(some):
        corners = rotate(ground_from_sensor.T, tree.triangles[some] - seen.origin)
        windows = _of_triangles(corners.transpose(2, 1, 0), lattice)
        yield windows[np.flatnonzero(windows.low <= windows.high)]


def _of_boxes(low: Floats, high: Floats, axes: Floats, lattice: Lattice) -> BeamWindows:
    """Windows of boxes with corners (N, 3) along the ground's axes, seen from the origin."""
    x, y, z = rotate(axes.T, (low + high) / 2.0).T
    half = ((high - low) / 2.0).T
    flat = np.sqrt(x * x + y * y)
    c, s = x / np.maximum(flat, LEAST_M), y / np.maximum(flat, LEAST_M)
    deep = _sum(h * np.abs(a[0] * c + a[1] * s) for h, a in zip(half, axes, strict=True))
    wide = _sum(h * np.abs(a[1] * c - a[0] * s) for h, a in zip(half, axes, strict=True))
    tall = _sum(h * abs(float(a[2])) for h, a in zip(half, axes, strict=True))
    deep, wide, tall = (w * (1.0 + MARGIN) + LEAST_M for w in (deep, wide, tall))
    beside = flat > deep * 1.1
    room = np.where(beside, flat - deep, 1.0)
    round_it = flat + np.sqrt(_sum(h * h for h in half)) * (1.0 + MARGIN) + LEAST_M
    far = np.where(beside, np.sqrt((flat + deep) ** 2 + wide * wide), round_it)
    low_row, high_row = _rows(z - tall, z + tall, np.where(beside, room, 0.0), far, lattice)
    middle, reach = np.arctan2(y, x), np.where(beside, np.arctan2(wide, room), np.pi)
    return BeamWindows(low_row, high_row, *_columns(middle - reach, middle + reach, lattice))


def _of_triangles(corners: Floats, lattice: Lattice) -> BeamWindows:
    """Windows of triangles with corners (3 axes, 3, N) in the sensor's frame."""
    x, y, z = corners
    azimuth = np.arctan2(y, x)
    turned = azimuth - azimuth[0]
    turned -= 2.0 * np.pi * np.round(turned / (2.0 * np.pi))
    first, last = least_of(turned), greatest_of(turned)
    beside = last - first < np.pi * (1.0 - MARGIN)  # else it may reach round the axis
    near = least_of(np.stack([_from_axis(x, y, i, (i + 1) % 3) for i in range(3)]))
    far = greatest_of(np.sqrt(x * x + y * y))
    low, high = _rows(least_of(z), greatest_of(z), np.where(beside, near, 0.0), far, lattice)
    first = np.where(beside, azimuth[0] + first, -np.pi)
    last = np.where(beside, azimuth[0] + last, np.pi)
    return BeamWindows(low, high, *_columns(first, last, lattice))


def _from_axis(x: Floats, y: Floats, i: int, j: int) -> Floats:
    """Distance of edges from the axis."""
    along_x, along_y = x[j] - x[i], y[j] - y[i]
    size = np.maximum(along_x * along_x + along_y * along_y, LEAST_M**2)
    t = np.clip(-(x[i] * along_x + y[i] * along_y) / size, 0.0, 1.0)
    return np.hypot(x[i] + t * along_x, y[i] + t * along_y)


def _rows(
    low: Floats, high: Floats, near: Floats, far: Floats, lattice: Lattice
) -> tuple[Ints, Ints]:
    """First and last channel that pass heights at distances from the axis."""
    assert lattice.slope_bounds is not None
    near = np.maximum(near * (1.0 - MARGIN) - LEAST_M, LEAST_M)
    far = far * (1.0 + MARGIN) + LEAST_M
    least = np.where(low < 0.0, low / near, low / far)
    most = np.where(high > 0.0, high / near, high / far)
    least, most = (np.clip(w, -STEEP, STEEP).astype(np.float32) for w in (least, most))
    slopes = lattice.slope_bounds
    first = slopes.below[slopes.bins(least)].astype(np.int64)
    return first, slopes.upto[slopes.bins(most)].astype(np.int64) - 1


def _columns(first: Floats, last: Floats, lattice: Lattice) -> tuple[Ints, Ints]:
    """First and last azimuth step between azimuths [rad]; the first is in a first turn."""
    begin = np.ceil(first / lattice.step - MARGIN * lattice.count).astype(np.int64)
    end = np.floor(last / lattice.step + MARGIN * lattice.count).astype(np.int64)
    count = np.minimum(end - begin, lattice.count - 1)
    begin %= lattice.count
    return begin, begin + count


def _mark(marks: NDArray[np.int32], windows: BeamWindows, count: int) -> None:
    """Add windows to a table whose sums are the number of windows that hold a beam."""
    width = marks.shape[1]
    some = np.flatnonzero(windows.first <= windows.last)
    own, flat = windows[some], marks.reshape(-1)
    corners = (
        (own.low, own.first, 1),
        (own.low, own.last + 1, -1),
        (own.high + 1, own.first, -1),
        (own.high + 1, own.last + 1, 1),
    )
    for row, column, sign in corners:
        np.add.at(flat, row * width + column, sign)


def _sum(terms: Iterator[Floats]) -> Floats:
    a, b, c = terms
    return a + b + c

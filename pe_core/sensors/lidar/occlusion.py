"""Which beams of a LiDAR the vehicle may occlude, without casting them.

`occlusion_candidates` gives a superset for exact counts: every beam that the vehicle occludes, and
a few more. Seen from the sensor a box covers a window of azimuths and slopes, so of beams too. The
boxes of the vehicle's tree are opened, largest first, until their windows are small; triangles
that are still large get windows of their own corners. A beam in no window is free.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints
from ...geometry.bins import corner_max, corner_min
from ...geometry.poses import rotate
from ...geometry.raycast import VisibleTriangles

if TYPE_CHECKING:
    from .lattice import Lattice

BeamWindows = Ints
"""Windows of beams (4, N), ends included: from channel to channel, numbered by elevation, and from
azimuth step to azimuth step, which may go on into a second turn."""

MARGIN = 1e-6
"""Windows are widened by this, relative: far more than rounding, far less than an azimuth step."""
MIN_DISTANCE_M = 1e-9  # Replaces a distance of 0 from the sensor's axis [m]
MAX_SLOPE = 1e9  # Slopes are clipped to this: beyond all channels
LARGE_WINDOW = 48  # A box whose window has this many azimuth steps or more is opened


def occlusion_candidates(
    mesh: VisibleTriangles, ground_from_sensor: Floats, lattice: "Lattice"
) -> Flags:
    """Flag the beams of a regular LiDAR that the vehicle may occlude: too many rather than too few.

    Returns flags (C, A) by channel, lowest first, and azimuth step; `lattice` has `slope_bounds`.
    Fast because windows are added to a summed-area table at four corners each, whatever their size.
    """
    marks = np.zeros((len(lattice.channels) + 1, 2 * lattice.count + 1), np.int32)
    windows = list(_windows(mesh, ground_from_sensor, lattice))
    if windows:
        _mark(marks, np.concatenate(windows, axis=1))
    once = marks[:, : lattice.count]
    again = marks[:, lattice.count : -1]
    again[:, 0] += once.sum(axis=1)  # windows that go on into a second turn
    once += again
    for row, before in zip(once[1:], once, strict=False):
        row += before  # five times as fast as np.cumsum along the first axis
    covered: Flags = np.cumsum(once[:-1], axis=1, dtype=np.int32) > 0
    return covered


def _windows(
    mesh: VisibleTriangles, ground_from_sensor: Floats, lattice: "Lattice"
) -> Iterator[BeamWindows]:
    """Yield windows that together cover every visible triangle of the vehicle."""
    tree = mesh.tree
    level = tree.entry_level
    nodes = np.arange(len(tree.boxes[level])) if level >= 0 else np.zeros(0, np.int64)
    while level >= 0 and len(nodes):
        low, high = tree.boxes[level][nodes].transpose(1, 0, 2) - mesh.origin
        windows = _box_windows(low, high, ground_from_sensor, lattice)
        has_beams = windows[0] <= windows[1]
        large = windows[3] - windows[2] >= LARGE_WINDOW
        yield windows[:, has_beams & ~large]
        nodes = tree.below(nodes[has_beams & large], level)
        level -= 1
    if len(nodes):
        corners = rotate(ground_from_sensor.T, tree.triangles[nodes] - mesh.origin)
        windows = _triangle_windows(corners.transpose(2, 1, 0), lattice)
        yield windows[:, windows[0] <= windows[1]]


def _box_windows(low: Floats, high: Floats, axes: Floats, lattice: "Lattice") -> BeamWindows:
    """Windows of axis-aligned boxes in the ground frame, lowest and highest corners (N, 3) [m]."""
    x, y, z = rotate(axes.T, (low + high) / 2.0).T
    half = ((high - low) / 2.0).T
    flat = np.sqrt(x * x + y * y)
    c = x / np.maximum(flat, MIN_DISTANCE_M)
    s = y / np.maximum(flat, MIN_DISTANCE_M)
    depth = _sum3(h * np.abs(a[0] * c + a[1] * s) for h, a in zip(half, axes, strict=True))
    width = _sum3(h * np.abs(a[1] * c - a[0] * s) for h, a in zip(half, axes, strict=True))
    height = _sum3(h * abs(float(a[2])) for h, a in zip(half, axes, strict=True))
    depth, width, height = (w * (1.0 + MARGIN) + MIN_DISTANCE_M for w in (depth, width, height))
    off_axis = flat > depth * 1.1
    near = np.where(off_axis, flat - depth, 1.0)
    ball = flat + np.sqrt(_sum3(h * h for h in half)) * (1.0 + MARGIN) + MIN_DISTANCE_M
    far = np.where(off_axis, np.sqrt((flat + depth) ** 2 + width * width), ball)
    low_row, high_row = _rows(
        z - height, z + height, np.where(off_axis, near, 0.0), far, lattice=lattice
    )
    middle = np.arctan2(y, x)
    reach = np.where(off_axis, np.arctan2(width, near), np.pi)
    return np.stack([low_row, high_row, *_columns(middle - reach, middle + reach, lattice)])


def _triangle_windows(corners: Floats, lattice: "Lattice") -> BeamWindows:
    """Windows of triangles, corners (3 axes, 3, N) in the sensor frame [m]."""
    x, y, z = corners
    azimuth = np.arctan2(y, x)
    turned = azimuth - azimuth[0]
    turned -= 2.0 * np.pi * np.round(turned / (2.0 * np.pi))
    first = corner_min(turned)
    last = corner_max(turned)
    off_axis = last - first < np.pi * (1.0 - MARGIN)  # else it may surround the sensor's axis
    near = corner_min(np.stack([_edge_distance(x, y, i, (i + 1) % 3) for i in range(3)]))
    far = corner_max(np.sqrt(x * x + y * y))
    low, high = _rows(
        corner_min(z), corner_max(z), np.where(off_axis, near, 0.0), far, lattice=lattice
    )
    first = np.where(off_axis, azimuth[0] + first, -np.pi)
    last = np.where(off_axis, azimuth[0] + last, np.pi)
    return np.stack([low, high, *_columns(first, last, lattice)])


def _edge_distance(x: Floats, y: Floats, i: int, j: int) -> Floats:
    """Distance (N,) of the edges from corner i to corner j to the sensor's axis [m]."""
    along_x = x[j] - x[i]
    along_y = y[j] - y[i]
    size = np.maximum(along_x * along_x + along_y * along_y, MIN_DISTANCE_M**2)
    t = np.clip(-(x[i] * along_x + y[i] * along_y) / size, 0.0, 1.0)
    return np.hypot(x[i] + t * along_x, y[i] + t * along_y)


def _rows(
    low: Floats, high: Floats, near: Floats, far: Floats, lattice: "Lattice"
) -> tuple[Ints, Ints]:
    """First and last channel that pass between two heights at these distances from the axis."""
    assert lattice.slope_bounds is not None
    near = np.maximum(near * (1.0 - MARGIN) - MIN_DISTANCE_M, MIN_DISTANCE_M)
    far = far * (1.0 + MARGIN) + MIN_DISTANCE_M
    lowest = np.where(low < 0.0, low / near, low / far)
    highest = np.where(high > 0.0, high / near, high / far)
    lowest, highest = (
        np.clip(w, -MAX_SLOPE, MAX_SLOPE).astype(np.float32) for w in (lowest, highest)
    )
    slopes = lattice.slope_bounds
    first = slopes.below[slopes.bins(lowest)].astype(np.int64)
    return first, slopes.upto[slopes.bins(highest)].astype(np.int64) - 1


def _columns(first: Floats, last: Floats, lattice: "Lattice") -> tuple[Ints, Ints]:
    """First and last azimuth step between azimuths [rad]; the first step is in the first turn."""
    begin = np.ceil(first / lattice.step - MARGIN * lattice.count).astype(np.int64)
    end = np.floor(last / lattice.step + MARGIN * lattice.count).astype(np.int64)
    count = np.minimum(end - begin, lattice.count - 1)
    begin %= lattice.count
    return begin, begin + count


def _mark(marks: NDArray[np.int32], windows: BeamWindows) -> None:
    """Add windows to a table whose cumulative sums are the number of windows that hold a beam."""
    width = marks.shape[1]
    flat = marks.reshape(-1)
    low, high, first, last = windows[:, windows[2] <= windows[3]]
    for row, column, sign in (
        (low, first, 1),
        (low, last + 1, -1),
        (high + 1, first, -1),
        (high + 1, last + 1, 1),
    ):
        np.add.at(flat, row * width + column, sign)


def _sum3(terms: Iterator[Floats]) -> Floats:
    a, b, c = terms
    return a + b + c

"""Lower and upper bounds of the beams through single voxels, by table look-ups.

Seen from the sensor a cube lies inside an outer window of azimuth and elevation, and every beam of
an inner window passes through it. On a regular lattice the beams of a window are a product of two
counts. Where both windows hold the same number of beams, it is m; `voxel_beams` counts the rest.
All arithmetic is in single precision, with margins on the safe side.

The inner window is that of a slice of the cube: the plane through its centre that contains the
sensor frame's up direction and its two silhouette edges. docs/engine.md has a figure; docs/figures
works its voxel by hand.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Singles
from ...geometry.bins import blocks

Counts = NDArray[np.int32]

BOUND_BINS = 1 << 16
FIRST_BIN = np.float32(0)
LAST_BIN = np.float32(BOUND_BINS - 1)
BOUND_MARGIN = np.float32(4e-6)
"""Relative rounding of a slope that is bounded, with room to spare."""
MARGIN = np.float32(4e-6)
"""Outer windows are widened and inner ones narrowed by this, relative: more than the rounding of
single precision."""
SLACK = np.float32(1e-4)
"""Cubes are taken larger (outer) or smaller (inner) by this, in sides: twice the rounding, in
single precision, of a point a thousand sides away."""
BLOCK = 1 << 15  # Voxels computed together: their arrays fit the processor's cache
BALL = np.float32(0.867)
"""Radius of the ball around a cube, in sides, rounded up; bounds a cube on the sensor's axis."""
ON_AXIS = np.float32(1e-25)
"""Replaces the minimum distance from the sensor's axis of a cube that the axis may touch: a channel
along the axis has a slope of 1e16."""
MIN_FLAT = np.float32(1e-3)
"""Replaces smaller distances of an inner window from the axis."""
ONE = np.float32(1.0)
SIGN_BIT = np.uint32(1 << 31)
MIN_SHARE = np.float32(0.85)
MAX_SHARE = np.float32(1.0 - 1e-5)
"""Limits of the inner window's width, as a share of the slice's width."""
FIELDS = ("lower", "upper", "row", "rows", "column", "columns")


@dataclass(frozen=True, slots=True)
class SlopeBounds:
    """Bounds of the number of channels below a slope. Bin k begins at ``low + k / scale``. `below`
    counts the channels surely below the bin's lower edge, `upto` those that may be below its upper
    edge."""

    low: float
    scale: float
    below: Counts
    upto: Counts

    @classmethod
    def of(cls, elevations: Floats) -> "SlopeBounds":
        """Build the table of channels at elevations (C,) [rad]."""
        slopes = np.tan(np.sort(elevations))
        room = 1e-3 * (1.0 + np.abs(slopes).max())
        edges = np.linspace(slopes[0] - room, slopes[-1] + room, BOUND_BINS + 1)
        slack = float(BOUND_MARGIN) * (1.0 + np.abs(edges))
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        upto[-1] = len(slopes)
        below[0] = 0
        scale = BOUND_BINS / (edges[-1] - edges[0])
        return cls(float(edges[0]), float(scale), below.astype(np.int32), upto.astype(np.int32))

    def bins(self, slopes: Singles) -> NDArray[np.intp]:
        """Return the bin of each slope."""
        scaled = (slopes - np.float32(self.low)) * np.float32(self.scale)
        np.maximum(scaled, FIRST_BIN, out=scaled)
        np.minimum(scaled, LAST_BIN, out=scaled)
        return scaled.astype(np.intp)


@dataclass(frozen=True, slots=True)
class Bracket:
    """Bounds of the number of beams through voxels, and their outer windows; (V,) each.

    At least `lower` and at most `upper` beams pass. The outer window is channels `row` to
    ``row + rows - 1``, sorted by elevation, at azimuth steps `column` to ``column + columns - 1``,
    which may lie outside [0, azimuth_count).
    """

    lower: Counts
    upper: Counts
    row: Counts
    rows: Counts
    column: Counts
    columns: Counts


def bracket(
    points: Sequence[Singles], ground_from_sensor: Floats, slopes: SlopeBounds, azimuth_count: int
) -> Bracket:
    """Bound the number of beams through unit cubes, without a vehicle.

    For a full-circle LiDAR without azimuth offsets. Fast because each bound is a product of two
    counts: channels by table look-up, azimuths by arithmetic.

    `points` are the cubes' centres, seen from the sensor along the ground axes, in voxel sides:
    three arrays (V,), one an axis.
    """
    out = Bracket(*(np.empty(len(points[0]), np.int32) for _ in range(6)))
    rotation = ground_from_sensor.astype(np.float32)
    step = np.float32(2.0 * np.pi / azimuth_count)
    for block in blocks(len(points[0]), BLOCK):
        seen = Silhouettes.of([p[block] for p in points], rotation, step)
        bounds = _bounds(seen, slopes, azimuth_count)
        for key, part in zip(FIELDS, bounds, strict=True):
            getattr(out, key)[block] = part
    return out


@dataclass(frozen=True, slots=True)
class Silhouettes:
    """Unit cubes in the sensor frame; lengths in voxel sides, (V,) each.

    `flat` and `z` are the centre's distance from the sensor's axis and its height; `middle` is its
    azimuth, in steps of `step` [rad]. `radial`, `lateral` and `up` are the components of the
    cube's three half edges (one per ground axis) away from the axis, across and up. `depth`,
    `width` and `height` are the sums of their absolute values: half the cube's extents.
    """

    flat: Singles
    z: Singles
    middle: Singles
    step: np.float32
    radial: list[Singles]
    lateral: list[Singles]
    up: Singles
    depth: Singles
    width: Singles
    height: np.float32

    @classmethod
    def of(cls, points: Sequence[Singles], rotation: Singles, step: np.float32) -> "Silhouettes":
        """Project cubes with these centres, seen from the sensor along the ground axes."""
        x, y, z = (
            rotation[0, w] * points[0] + rotation[1, w] * points[1] + rotation[2, w] * points[2]
            for w in range(3)
        )
        flat = np.sqrt(x * x + y * y)
        inverse = ONE / np.maximum(flat, np.float32(0.1))
        c = x * inverse
        s = y * inverse
        if not flat.all():
            c[flat == 0.0] = 1.0  # a cube on the axis needs some azimuth; any will do
        half = rotation * np.float32(0.5)
        upright = np.zeros((), np.float32)  # of an axis along the sensor's own: fewer products
        radial, lateral = (
            [a * c + b * s if a or b else upright for a, b in pairs]
            for pairs in (half[:, :2], np.stack([half[:, 1], -half[:, 0]], axis=1))
        )
        depth, width = (np.abs(a) + np.abs(b) + np.abs(c) for a, b, c in (radial, lateral))
        middle = np.arctan2(y, x) / step
        up = half[:, 2]
        return cls(
            flat=flat,
            z=z,
            middle=middle,
            step=step,
            radial=radial,
            lateral=lateral,
            up=up,
            depth=depth,
            width=width,
            height=np.abs(up).sum(),
        )


def _bounds(seen: Silhouettes, slopes: SlopeBounds, count: int) -> tuple[Counts, ...]:
    """Compute the fields of a `Bracket`."""
    depth = seen.depth + SLACK
    width = seen.width + SLACK
    height = seen.height + SLACK
    near = np.maximum(seen.flat - depth, ON_AXIS)
    far = _hypotenuse(seen.flat + depth, width)
    on_axis = np.flatnonzero(seen.flat <= depth * np.float32(1.1))
    far[on_axis] = seen.flat[on_axis] + BALL
    near[on_axis] = ON_AXIS
    near = ONE / near
    far = ONE / far
    slack = np.abs(seen.middle) * MARGIN + MARGIN
    reach = np.minimum(width * near * ((1 + MARGIN) / seen.step) + slack, np.float32(count))
    first = np.ceil(seen.middle - reach)
    last = np.floor(seen.middle + reach)
    columns = np.minimum(last - first + ONE, np.float32(count)).astype(np.int32)
    columns[on_axis] = count  # the cube may surround the axis
    high = seen.z + height
    low = seen.z - height
    row = slopes.below[slopes.bins(np.minimum(low * near, low * far))]
    rows = slopes.upto[slopes.bins(np.maximum(high * near, high * far))]
    rows = np.maximum(rows - row, 0)
    upper = rows * columns
    lower = np.minimum(_inner_window(seen, slopes, slack), upper)
    lower[on_axis] = 0
    return lower, upper, row, rows, first.astype(np.int32), columns


def _hypotenuse(long: Singles, short: Singles) -> Singles:
    """Upper bound of the hypotenuse, close to it for a short second leg: no root is needed."""
    return long + short * short / (long + long)


def _inner_window(seen: Silhouettes, slopes: SlopeBounds, slack: Singles) -> Counts:
    """Numbers (V,) of beams of the inner windows; `slack` is the rounding of `middle`."""
    width, height, skew = slice_through(seen)
    recess = skew * width
    drift = np.abs(recess)
    near = ONE / np.maximum(seen.flat - drift, MIN_FLAT)
    far = ONE / _hypotenuse(seen.flat + drift + MIN_FLAT, width)
    high = seen.z + height
    low = seen.z - height
    rows = slopes.below[slopes.bins(np.minimum(high * near, high * far))]
    rows = np.maximum(rows - slopes.upto[slopes.bins(np.maximum(low * near, low * far))], 0)
    left, right = (
        width / np.maximum(reach, MIN_FLAT) for reach in (seen.flat + recess, seen.flat - recess)
    )
    # atan(t) >= t - t^3 / 3, so no arc tangent is needed
    third = np.float32(1.0 / 3.0)
    scale = (1 - MARGIN) / seen.step
    left, right = ((t - t * t * t * third) * scale for t in (left, right))
    columns = np.floor(seen.middle + left - slack) - np.ceil(seen.middle - right + slack) + ONE
    return rows * np.maximum(columns, 0).astype(np.int32)


def slice_through(seen: Silhouettes) -> tuple[Singles, Singles, Singles]:
    """Return half width and half height of a rectangle inside the slice, and the slice's skew. The
    skew is the distance by which the slice recedes from the axis for each side to the left."""
    a, b, c = (_signed(r, s) for r, s in zip(seen.radial, seen.lateral, strict=True))
    skew: Singles = (a + b + c) / seen.width
    tilt: list[Singles] = [
        np.abs(b + skew * a) for a, b in zip(seen.radial, seen.lateral, strict=True)
    ]
    rectangle = _rectangle(tilt, np.abs(2 * seen.up))
    width, height = (np.maximum(side - SLACK, 0) for side in rectangle)
    return width, height, skew


def _signed(values: Singles, signs: Singles) -> Singles:
    """Values times the signs of others: by bits, twelve times as fast as `np.copysign`."""
    product = values.view(np.uint32) ^ (signs.view(np.uint32) & SIGN_BIT)
    return product.view(np.float32)


def _rectangle(tilt: list[Singles], up: Singles) -> tuple[Singles, Singles]:
    """Half width and half height of a rectangle in the slice.

    A point of the slice, s to the left and u up, lies in the cube if ``|2 s tilt_k + u up_k| <=
    1/2`` for its three axes k. A tilted slice has no height at its full width; from the share
    ``1 - up_k`` of the width on, k being the second most upright axis, it has about the cube's.
    """
    half = np.float32(0.5)
    quarter = np.float32(0.25)
    tiny = np.float32(1e-9)
    widest = quarter / np.maximum(np.maximum(np.maximum(tilt[0], tilt[1]), tilt[2]), tiny)
    share = np.clip(np.float32(1.0) - np.sort(up)[1], MIN_SHARE, MAX_SHARE)
    width = widest * share
    heights = [
        (half - (width + width) * t) * (ONE / max(u, tiny)) for t, u in zip(tilt, up, strict=True)
    ]
    height = np.minimum(np.minimum(heights[0], heights[1]), heights[2])
    return width, np.maximum(height, 0)

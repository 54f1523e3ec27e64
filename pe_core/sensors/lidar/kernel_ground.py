"""The LiDAR's kernel for visible ground: squares of the ground that beams pass at a low height.

A beam meets a post of height h where the beam is between the ground and h. Seen from above that is
a straight segment, which ends earlier where the vehicle or the range ends the beam. The squares
that hold points of the segment are marked: both of its ends, and points between.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.arrays import Floats, Ints
from ...geometry.grids import GroundGrid
from ...geometry.indexing import count_up
from ...scene.rig import Sensor
from ..kernels import GroundKernel, GroundView, VisibleGround
from .beams import BeamCache
from .model import lidar_of

SPACING_M, MAX_SPACING_M = 0.05, 0.15
"""Distance between the points of a segment; larger if there were more than MAX_POINTS points."""
MAX_POINTS = 2_000_000
DIRECTION_BINS = 1e11
"""Segments whose directions agree to one part in this many lie on one ray."""
MIN_LENGTH = 1e-9
"""Replaces the horizontal length 0 of a vertical beam."""
MAX_LENGTH_M = 1e6
"""No segment is longer."""


class LidarGround(GroundKernel):
    """Marks the squares below the low parts of beams."""

    def __init__(self, view: GroundView) -> None:
        self._view = view
        self.cache = BeamCache(view.vehicle)

    def mark(self, sensor: Sensor, approximate: bool) -> VisibleGround:
        """Mark the squares of beams between the ground and the posts' height.

        With `approximate` the occlusion by the vehicle may be an approximation.
        """
        beams, rotated = self.cache.cast(sensor, approximate), self.cache.rotated(sensor)
        components = rotated.components(np.arange(lidar_of(sensor).beam_count))
        first, last = self._low_parts(sensor, components)
        low = np.flatnonzero(first <= last)
        occludable = low[beams.ends.occludable[low]]
        last[occludable] = np.minimum(last[occludable], beams.ends.take(occludable))
        low = low[first[low] <= last[low]]
        x, y, first, last = merged(*(w[low] for w in (*components[:2], first, last)))
        segments = GroundSegments.of(self._view.grid, sensor.pose.position, (x, y), first, last)
        grid = self._view.grid
        marked = np.zeros(grid.shape, bool)
        flat, finest = marked.reshape(-1), SPACING_M / grid.step
        spacing = np.clip(segments.length / MAX_POINTS, finest, MAX_SPACING_M / grid.step)
        flat[segments.subdivided(float(spacing)).squares(0.0, grid.shape)] = True
        flat[segments.squares(1.0, grid.shape)] = True
        return VisibleGround(sensor, marked, beams.approximate)

    def _low_parts(self, sensor: Sensor, components: list[Floats]) -> tuple[Floats, Floats]:
        """Distances (B,) between which beams are low enough, above the grid and in range [m]."""
        lidar, grid = lidar_of(sensor), self._view.grid
        first = np.full(lidar.beam_count, lidar.min_range)
        last = np.full(lidar.beam_count, lidar.max_range)
        low, high = (*grid.origin, 0.0), (*grid.end, self._view.height)
        axes = zip(components, sensor.pose.position, low, high, strict=True)
        for component, origin, a, b in axes:
            t0, t1 = (a - origin) / component, (b - origin) / component
            np.maximum(first, np.minimum(t0, t1), out=first)
            np.minimum(last, np.maximum(t0, t1), out=last)
        return first, last


def merged(x: Floats, y: Floats, first: Floats, last: Floats) -> tuple[Floats, ...]:
    """Merge overlapping segments on one ray: channels of one azimuth of an upright LiDAR.

    Segments (L,) lie from `first` to `last` times a direction (x, y) from the sensor. Returns fewer
    such segments, along unit vectors.
    """
    length = np.maximum(np.sqrt(x * x + y * y), MIN_LENGTH)
    x, y, first, last = x / length, y / length, first * length, last * length
    turned = y / (np.abs(x) + np.abs(y))  # rises with the azimuth where x > 0
    direction = np.round(np.where(x < 0.0, 2.0 - turned, turned) * DIRECTION_BINS)
    order = np.lexsort((first, direction))
    x, y, first, last, direction = (w[order] for w in (x, y, first, last, direction))
    # Each ray is moved beyond the last one, so that one running maximum serves all.
    shift = np.cumsum(np.diff(direction, prepend=direction[:1]) != 0.0) * MAX_LENGTH_M
    farthest = np.maximum.accumulate(last + shift)
    begins = np.ones(len(x), bool)
    begins[1:] = first[1:] + shift[1:] > farthest[:-1]
    begins = np.flatnonzero(begins)
    if not len(begins):
        return x, y, first, last
    return x[begins], y[begins], first[begins], np.maximum.reduceat(last, begins)


@dataclass(frozen=True, slots=True)
class GroundSegments:
    """Segments seen from above, (L,) each: start `x`, `y` and extent `dx`, `dy`.

    In squares of a grid, from its lowest corner.
    """

    x: Floats
    y: Floats
    dx: Floats
    dy: Floats

    @classmethod
    def of(
        cls,
        grid: GroundGrid,
        position: tuple[float, float, float],
        directions: tuple[Floats, Floats],
        first: Floats,
        last: Floats,
    ) -> GroundSegments:
        """Return the segments from `first` to `last` (L,) [m] along directions from a position."""
        start, extent = [], []
        for origin, low, direction in zip(position, grid.origin, directions, strict=False):
            start.append((origin - low + direction * first) / grid.step)
            extent.append(direction * (last - first) / grid.step)
        return cls(*start, *extent)

    @property
    def length(self) -> float:
        """Sum of the segments' lengths, in squares."""
        return float(np.sqrt(self.dx * self.dx + self.dy * self.dy).sum())

    def subdivided(self, spacing: float) -> GroundSegments:
        """Divide each segment into equal pieces, at most `spacing` squares long."""
        pieces = np.ceil(np.sqrt(self.dx * self.dx + self.dy * self.dy) / spacing).astype(np.int64)
        pieces = np.maximum(pieces, 1)
        dx, dy = (np.repeat(w / pieces, pieces) for w in (self.dx, self.dy))
        number = count_up(pieces)
        return GroundSegments(
            np.repeat(self.x, pieces) + number * dx, np.repeat(self.y, pieces) + number * dy, dx, dy
        )

    def squares(self, fraction: float, shape: tuple[int, int]) -> Ints:
        """Return the flat index (L,) of the square at a fraction of each segment."""
        i, j = (
            np.minimum((w + fraction * dw).astype(np.int32), n - 1)
            for w, dw, n in ((self.x, self.dx, shape[0]), (self.y, self.dy, shape[1]))
        )
        return np.asarray(i * shape[1] + j)

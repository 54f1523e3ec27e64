"""How many of a LiDAR's channels lie below a slope: two tables, looked up in single precision.

A slope is the tangent of an elevation: height over distance. A look-up costs the same for any
number of channels, and its rounding is allowed for: one table bounds the number, the other says it,
or that it is not sure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .model import Lidar

Singles = NDArray[np.float32]
Small = NDArray[np.int16]
Counts = NDArray[np.int32]

BOUND_BINS = 1 << 16
BOUND_MARGIN = np.float32(4e-6)
"""Rounding of a slope that is bounded, relative, with room to spare."""
COUNT_BINS = 1 << 17
COUNT_MARGIN = np.float32(2e-6)
"""Rounding of a slope whose channels are counted, relative, with room to spare."""
STEEPEST_RAD = math.radians(80.0)
"""Steeper channels are not counted by slope: the tangent takes all bins for itself."""


@dataclass(frozen=True, slots=True)
class SlopeBounds:
    """Bounds of the number of channels below a slope: never too many and never too few.

    `below` counts channels surely below a bin's lower edge, `upto` those not above its upper edge.
    """

    low: float
    scale: float
    below: Counts
    upto: Counts

    @classmethod
    def of(cls, lidar: Lidar) -> SlopeBounds:
        """Make the table over the tangents of a LiDAR's elevations."""
        slopes = np.tan(np.sort(lidar.elevations))
        room = 1e-3 * (1.0 + np.abs(slopes).max())
        edges = np.linspace(slopes[0] - room, slopes[-1] + room, BOUND_BINS + 1)
        slack = float(BOUND_MARGIN) * (1.0 + np.abs(edges))
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        below[0], upto[-1] = 0, len(slopes)
        scale = BOUND_BINS / (edges[-1] - edges[0])
        return cls(float(edges[0]), float(scale), below.astype(np.int32), upto.astype(np.int32))

    def bins(self, slopes: Singles) -> Counts:
        """Bin of each slope."""
        scaled = (slopes - np.float32(self.low)) * np.float32(self.scale)
        return np.clip(scaled, 0, BOUND_BINS - 1).astype(np.int32)


@dataclass(frozen=True, slots=True)
class SlopeCounts:
    """The number of channels of a regular LiDAR below a slope, or that it is not sure.

    `below` holds, for each bin of slopes, twice the number of channels below it, plus 1 where a
    channel may lie in the bin. A bin begins at slope 0, and a slope's sign is always right, so the
    horizontal channel is in no bin.
    """

    azimuth_count: int
    scale: np.float32
    first: int
    below: Small

    @classmethod
    def of(cls, lidar: Lidar) -> SlopeCounts | None:
        """Make the table, of elevations' tangents; None for a LiDAR it is not for."""
        if lidar.azimuth_count % 2 or np.abs(lidar.elevations).max() > STEEPEST_RAD:
            return None
        slopes = np.array([math.tan(e) for e in np.sort(lidar.elevations).tolist()])
        scale = float(np.float32(COUNT_BINS / (slopes[-1] - slopes[0] + 0.01)))
        first = math.floor(slopes[0] * scale) - 2
        edges = np.arange(first, math.floor(slopes[-1] * scale) + 4) / scale
        slack = float(COUNT_MARGIN) * np.abs(edges)
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        upto[edges[1:] == 0.0] = np.searchsorted(slopes, 0.0, side="left")
        below[edges[:-1] == 0.0] = np.searchsorted(slopes, 0.0, side="right")
        table = (2 * below + (upto > below)).astype(np.int16)
        return cls(lidar.azimuth_count, np.float32(scale), first, table)

    def look_up(self, slopes: Singles) -> Small:
        """`below` of each slope; the slopes are overwritten."""
        slopes *= self.scale
        bins = np.floor(slopes, out=slopes).astype(np.intp)
        bins -= self.first
        return np.take(self.below, bins, mode="clip")

"""Tables that count a LiDAR's channels below a slope.

A slope is the tangent of an elevation: height over horizontal distance. A look-up costs the same
for any number of channels, and its rounding is allowed for. `SlopeBounds` bounds the number from
below and above, `SlopeCounts` gives it or says that it is unsure; both work in single precision.
`ChannelSlopes` gives it in double precision for any channels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Singles

Small = NDArray[np.int16]
Counts = NDArray[np.int32]

BOUND_BINS = 1 << 16
BOUND_MARGIN = np.float32(4e-6)
"""Relative rounding of a slope that is bounded, with room to spare."""
COUNT_BINS = 1 << 17
COUNT_MARGIN = np.float32(2e-6)
"""Relative rounding of a slope whose channels are counted, with room to spare."""
MAX_ELEVATION_RAD = math.radians(80.0)
"""Steeper channels are not counted by slope: their tangents would leave too few bins to others."""
CHANNEL_BINS = 1 << 14
MAX_SLOPE = 5.0
"""Steeper slopes are compared one by one, without bins."""
ROUNDING = 1e-9
"""A slope this near to a channel's is unsure, relative: far more than rounding needs."""


@dataclass(frozen=True, slots=True)
class SlopeBounds:
    """Bounds of the number of channels below a slope.

    Bin k begins at ``low + k / scale``. `below` counts the channels surely below the bin's lower
    edge, `upto` those that may be below its upper edge.
    """

    low: float
    scale: float
    below: Counts
    upto: Counts

    @classmethod
    def of(cls, elevations: Floats) -> SlopeBounds:
        """Build the table of channels at elevations (C,) [rad]."""
        slopes = np.tan(np.sort(elevations))
        room = 1e-3 * (1.0 + np.abs(slopes).max())
        edges = np.linspace(slopes[0] - room, slopes[-1] + room, BOUND_BINS + 1)
        slack = float(BOUND_MARGIN) * (1.0 + np.abs(edges))
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        below[0], upto[-1] = 0, len(slopes)
        scale = BOUND_BINS / (edges[-1] - edges[0])
        return cls(float(edges[0]), float(scale), below.astype(np.int32), upto.astype(np.int32))

    def bins(self, slopes: Singles) -> Counts:
        """Return the bin of each slope."""
        scaled = (slopes - np.float32(self.low)) * np.float32(self.scale)
        return np.clip(scaled, 0, BOUND_BINS - 1).astype(np.int32)


@dataclass(frozen=True, slots=True)
class SlopeCounts:
    """The number of channels of a regular LiDAR below a slope, or that it is unsure.

    `below` holds a code for each bin of slopes: twice the number of channels below the bin, plus 1
    where a channel may lie in the bin. A bin begins at slope 0, and a slope's sign is always right,
    so the horizontal channel lies in no bin.
    """

    azimuth_count: int
    scale: np.float32
    first: int
    below: Small

    @classmethod
    def of(cls, elevations: Floats, azimuth_count: int) -> SlopeCounts | None:
        """Build the table of channels at elevations (C,) [rad].

        None for an odd number of azimuths or steep channels: the table does not serve them.
        """
        if azimuth_count % 2 or np.abs(elevations).max() > MAX_ELEVATION_RAD:
            return None
        slopes = np.array([math.tan(e) for e in np.sort(elevations).tolist()])
        scale = float(np.float32(COUNT_BINS / (slopes[-1] - slopes[0] + 0.01)))
        first = math.floor(slopes[0] * scale) - 2
        edges = np.arange(first, math.floor(slopes[-1] * scale) + 4) / scale
        slack = float(COUNT_MARGIN) * np.abs(edges)
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        upto[edges[1:] == 0.0] = np.searchsorted(slopes, 0.0, side="left")
        below[edges[:-1] == 0.0] = np.searchsorted(slopes, 0.0, side="right")
        table = (2 * below + (upto > below)).astype(np.int16)
        return cls(azimuth_count, np.float32(scale), first, table)

    def look_up(self, slopes: Singles) -> Small:
        """Return the codes `below` of slopes; overwrites the slopes."""
        slopes *= self.scale
        bins = np.floor(slopes, out=slopes).astype(np.intp)
        bins -= self.first
        return np.take(self.below, bins, mode="clip")


@dataclass(frozen=True, slots=True)
class ChannelSlopes:
    """Slopes (C,) of channels, ascending, and bins that count those below a slope.

    `codes` holds for each bin twice the number of channels below it, plus 1 where a channel may
    lie in it. The first bin holds all slopes below the others, the last one all above.
    """

    slopes: Floats
    low: float
    scale: float
    codes: Small

    @classmethod
    def of(cls, slopes: Floats) -> ChannelSlopes:
        """Build the bins."""
        low, high = np.clip(slopes[[0, -1]], -MAX_SLOPE, MAX_SLOPE) + np.array([-0.01, 0.01])
        inner = np.linspace(low, high, CHANNEL_BINS - 1)
        edges = np.concatenate([[-np.inf], inner, [np.inf]])
        margin = ROUNDING * 10.0
        below = np.searchsorted(slopes, edges[:-1] - margin, side="left")
        upto = np.searchsorted(slopes, edges[1:] + margin, side="right")
        codes = (2 * below + (upto > below)).astype(np.int16)
        return cls(slopes, float(low), (CHANNEL_BINS - 2) / float(high - low), codes)

    @property
    def steepest(self) -> float:
        """The largest absolute slope."""
        return float(np.abs(self.slopes).max())

    def below(self, scaled: Floats) -> tuple[Small, Flags]:
        """Count the channels below slopes of any shape, and flag unsure counts.

        `scaled` are the slopes times `scale`; they are overwritten.
        """
        scaled -= self.low * self.scale - 1.0
        inside = np.minimum(scaled, CHANNEL_BINS - 1.0)
        np.maximum(inside, 0.0, out=inside)
        codes = np.take(self.codes, inside.astype(np.int32))
        unsure = (codes & 1).astype(bool)
        codes >>= 1
        if unsure.any():
            slope = (scaled[unsure] - 1.0) / self.scale + self.low
            margin = ROUNDING * (1.0 + np.abs(slope))
            codes[unsure] = below = np.searchsorted(self.slopes, slope - margin, side="left")
            unsure[unsure] = below != np.searchsorted(self.slopes, slope + margin, side="right")
        return codes, unsure

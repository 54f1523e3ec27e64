"""A LiDAR's channels as fans: those of one azimuth offset, which lie in one plane at each azimuth.

In that plane a channel is known by its slope, so the channels between two slopes are a run, and two
look-ups find it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .model import Lidar

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

BINS = 1 << 14
STEEPEST = 5.0
"""Slopes beyond this are not told apart by bins but one by one."""
ROUNDING = 1e-9
"""A slope this near to a channel's is not sure, relative: far more than rounding leaves open."""
FANS_KEPT = 16


@dataclass(frozen=True, slots=True)
class ChannelSlopes:
    """Slopes (C,) of channels, ascending, and bins that say how many lie below one.

    `codes` holds, for each bin, twice the number of channels below it, plus 1 where one may be in
    it; the first bin is all that is below the others, the last one all that is above.
    """

    slopes: Floats
    low: float
    scale: float
    codes: NDArray[np.int16]

    @classmethod
    def of(cls, slopes: Floats) -> ChannelSlopes:
        """Make the bins."""
        low, high = np.clip(slopes[[0, -1]], -STEEPEST, STEEPEST) + np.array([-0.01, 0.01])
        inner = np.linspace(low, high, BINS - 1)
        edges = np.concatenate([[-np.inf], inner, [np.inf]])
        room = ROUNDING * 10.0
        below = np.searchsorted(slopes, edges[:-1] - room, side="left")
        upto = np.searchsorted(slopes, edges[1:] + room, side="right")
        codes = (2 * below + (upto > below)).astype(np.int16)
        return cls(slopes, float(low), (BINS - 2) / float(high - low), codes)

    @property
    def steepest(self) -> float:
        """The slope that is farthest from level."""
        return float(np.abs(self.slopes).max())

    def below(self, bins: Floats) -> tuple[NDArray[np.int16], Flags]:
        """How many channels lie below slopes, times `scale`, and where that is not sure.

        Of any shape; the slopes are overwritten.
        """
        bins -= self.low * self.scale - 1.0
        inside = np.minimum(bins, BINS - 1.0)
        np.maximum(inside, 0.0, out=inside)
        codes = np.take(self.codes, inside.astype(np.int32))
        odd = (codes & 1).astype(bool)
        codes >>= 1
        if odd.any():
            own = (bins[odd] - 1.0) / self.scale + self.low
            room = ROUNDING * (1.0 + np.abs(own))
            codes[odd] = below = np.searchsorted(self.slopes, own - room, side="left")
            odd[odd] = below != np.searchsorted(self.slopes, own + room, side="right")
        return codes, odd


@dataclass(frozen=True, slots=True)
class Fan:
    """Channels of one azimuth offset [rad]: their numbers, lowest first, and their slopes."""

    channels: Ints
    slopes: ChannelSlopes
    offset: float


@lru_cache(maxsize=FANS_KEPT)
def fans_of(model: Lidar) -> tuple[Fan, ...]:
    """Return a model's fans."""
    found = []
    for offset in np.unique(model.azimuth_offsets).tolist():
        channels = np.flatnonzero(model.azimuth_offsets == offset)
        channels = channels[np.argsort(model.elevations[channels], kind="stable")]
        slopes = ChannelSlopes.of(np.tan(model.elevations[channels]))
        found.append(Fan(channels, slopes, offset))
    return tuple(found)

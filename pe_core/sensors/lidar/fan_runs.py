"""A LiDAR's channels as fans, and runs of channels that pass through boxes.

A fan is the channels of one azimuth offset: at each azimuth they lie in one plane. There a channel
is known by its slope, so the channels between two slopes are a run, found by two look-ups.
`planar_clip` finds the slopes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints
from .model import Lidar

Small = NDArray[np.int16]

CHANNEL_BINS = 1 << 14
MAX_SLOPE = 5.0
"""Steeper slopes are compared one by one, without bins."""
ROUNDING = 1e-9
"""A slope this near to a channel's is unsure, relative: far more than rounding needs."""
CACHED_MODELS = 16  # Models whose fans are in the cache
RUN_BLOCK = 16_000  # Runs computed together: their arrays fit the processor's cache
AZIMUTH_MARGIN = 1e-9
"""Spans of azimuths are widened by this against rounding, in steps."""


@dataclass(frozen=True, slots=True)
class ChannelSlopes:
    """Slopes (C,) of channels, ascending, and bins that count those below a slope. `codes` holds
    for each bin twice the number of channels below it, plus 1 where a channel may lie in it. The
    first bin holds all slopes below the others, the last one all above."""

    slopes: Floats
    low: float
    scale: float
    codes: Small

    @classmethod
    def of(cls, slopes: Floats) -> "ChannelSlopes":
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
        """Count the channels below slopes of any shape, and flag unsure counts. `scaled` are the
        slopes times `scale`; they are overwritten."""
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


@dataclass(frozen=True, slots=True)
class Fan:
    """Channels of one azimuth offset [rad]: their numbers, lowest first, and their slopes."""

    channels: Ints
    slopes: ChannelSlopes
    offset: float


@lru_cache(maxsize=CACHED_MODELS)
def fans_of(model: Lidar) -> tuple[Fan, ...]:
    """Return a model's fans, from a cache."""
    fans = []
    for offset in np.unique(model.azimuth_offsets).tolist():
        channels = np.flatnonzero(model.azimuth_offsets == offset)
        channels = channels[np.argsort(model.elevations[channels], kind="stable")]
        slopes = ChannelSlopes.of(np.tan(model.elevations[channels]))
        fans.append(Fan(channels, slopes, offset))
    return tuple(fans)


@dataclass(frozen=True, slots=True)
class ChannelRuns:
    """Runs of a fan's channels through boxes, (R,) each.

    A run is the channels from `low` to below `high` at azimuth step `column`. `near` and `far` are
    the inverse horizontal distances at which the plane enters and leaves the box [1/m]; of a tilted
    LiDAR those of the box's nearest and farthest point. A run is `unsure` where rounding could
    decide which channels these are.
    """

    box: Ints
    column: NDArray[np.int32]
    low: Small
    high: Small
    near: Floats
    far: Floats
    unsure: Flags

    def take(self, index: NDArray) -> "ChannelRuns":
        """Return the runs with these indices or flags."""
        return replace(self, **{key: getattr(self, key)[index] for key in RUN_FIELDS})

    @classmethod
    def concatenated(cls, parts: "Sequence[ChannelRuns]") -> "ChannelRuns":
        """Join one or more parts."""
        return cls(*(np.concatenate([getattr(p, key) for p in parts]) for key in RUN_FIELDS))


RUN_FIELDS = tuple(field.name for field in fields(ChannelRuns))


@dataclass(frozen=True, slots=True)
class RunBlock(ChannelRuns):
    """Runs of boxes (N,) at consecutive azimuth steps: `box` is (N,), all else (A, N). Where a
    plane misses a box, `low` equals `high`."""

    def take(self, index: NDArray) -> ChannelRuns:
        """Return the runs with these flags (A, N)."""
        index = np.flatnonzero(index)
        columns = {key: getattr(self, key).reshape(-1)[index] for key in RUN_FIELDS[1:]}
        return ChannelRuns(box=self.box[index % len(self.box)], **columns)


@dataclass(frozen=True, slots=True)
class RotatedFan:
    """A fan at a yaw: its first azimuth `start` and its `step` [rad], `count` steps to a circle.
    `rays` (2, 2 A) are the unit vectors of the azimuths, over two turns."""

    slopes: ChannelSlopes
    start: float
    step: float
    count: int
    rays: Floats

    @classmethod
    def of(cls, fan: Fan, yaw: float, step: float, count: int) -> "RotatedFan":
        """Rotate a fan of `count` azimuths by a yaw [rad]."""
        angles = np.arange(count) * step + (fan.offset + yaw)
        one_turn = np.stack([np.cos(angles), np.sin(angles)])
        return cls(fan.slopes, fan.offset + yaw, step, count, rays=np.tile(one_turn, 2))

    def columns(self, begin: Floats, end: Floats) -> Iterator[tuple[Ints, NDArray[np.int32]]]:
        """Yield the azimuth steps that boxes span, in blocks of boxes with about as many steps.

        A box spans the azimuths `begin` to `end` (N,) [rad]. Yields indices of boxes (M,) and their
        steps (A, M), which go on into a second turn; for some boxes a few too many. Blocks are fast
        because no index is repeated for each run.
        """
        first = np.ceil((begin - self.start) / self.step - AZIMUTH_MARGIN).astype(np.int64)
        last = np.floor((end - self.start) / self.step + AZIMUTH_MARGIN).astype(np.int64)
        counts = np.minimum(last - first + 1, self.count)
        order = np.argsort(-counts, kind="stable")
        order = order[: np.count_nonzero(counts > 0)]
        first = first[order] % self.count
        counts = counts[order]
        start = 0
        while start < len(order):
            width = int(counts[start])
            block = slice(start, start + max(1, RUN_BLOCK // width))
            yield order[block], (first[block] + np.arange(width)[:, None]).astype(np.int32)
            start = block.stop

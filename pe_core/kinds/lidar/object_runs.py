"""Which beams of an upright LiDAR meet boxes that stand upright: runs of channels, by azimuth.

Seen from above, an azimuth's ray enters a box's rectangle at one distance and leaves it at another
(`from_above`); the channels that pass through the box have slopes between two quotients of height
and distance. What rounding could decide is said to be unsure, and left to an exact test.

Boxes are worked on together that have about as many azimuths: a row an azimuth, a column a box.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ..placed_boxes import PlacedBoxes
from .fans import ChannelSlopes, Fan
from .from_above import BoxesFromAbove, SideLines

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Small = NDArray[np.int16]

RUNS_AT_ONCE = 16_000
"""Their arrays fit the cache."""
GRAZING = 1e-10
"""A ray whose inverse distances to where it enters and leaves differ by less is unsure [1/m]."""
WIDER = 1e-9
"""Of azimuths, in steps."""


@dataclass(frozen=True, slots=True)
class ChannelRuns:
    """Runs of a fan's channels through boxes, (R,) each.

    `item` the box, `column` the azimuth step; channels `low` to `high`, not included, of the fan;
    `near` and `far` the inverse distances over ground at which the rectangle is entered and left
    [1/m]; `unsure` where rounding could decide which channels they are.
    """

    item: Ints
    column: NDArray[np.int32]
    low: Small
    high: Small
    near: Floats
    far: Floats
    unsure: Flags

    def some(self, which: NDArray) -> ChannelRuns:
        """Return some of them."""
        return replace(self, **{key: getattr(self, key)[which] for key in RUN_FIELDS})

    @classmethod
    def joined(cls, several: Sequence[ChannelRuns]) -> ChannelRuns:
        """Return one or more in one."""
        return cls(*(np.concatenate([getattr(r, key) for r in several]) for key in RUN_FIELDS))


RUN_FIELDS = tuple(field.name for field in fields(ChannelRuns))


@dataclass(frozen=True, slots=True)
class RunBlock:
    """The same of some boxes (N,) at azimuths that run on, (A, N) each; `item` (N,).

    Where a ray misses a box, no channel is between `low` and `high`.
    """

    item: Ints
    column: NDArray[np.int32]
    low: Small
    high: Small
    near: Floats
    far: Floats
    unsure: Flags

    def some(self, which: Flags) -> ChannelRuns:
        """Return those of flags (A, N)."""
        at = np.flatnonzero(which)
        own = {key: getattr(self, key).reshape(-1)[at] for key in RUN_FIELDS[1:]}
        return ChannelRuns(item=self.item[at % len(self.item)], **own)


@dataclass(frozen=True, slots=True)
class TurnedFan:
    """A fan at a yaw: unit vectors (2, 2 A) of its azimuths, ground frame, twice round."""

    slopes: ChannelSlopes
    start: float
    step: float
    count: int
    rays: Floats

    @classmethod
    def of(cls, fan: Fan, yaw: float, step: float, count: int) -> TurnedFan:
        """Turn a fan of so many azimuths a full circle."""
        angles = np.arange(count) * step + (fan.offset + yaw)
        once = np.stack([np.cos(angles), np.sin(angles)])
        return cls(fan.slopes, fan.offset + yaw, step, count, np.tile(once, 2))

    def runs(self, boxes: PlacedBoxes, seen: BoxesFromAbove, which: Ints) -> Iterator[RunBlock]:
        """Yield the runs through some boxes, which the sensor is `beside`."""
        for some, column in self.columns(seen.first[which], seen.last[which]):
            yield self._through(boxes, seen, which[some], column)

    def columns(self, begin: Floats, end: Floats) -> Iterator[tuple[Ints, NDArray[np.int32]]]:
        """Yield boxes (M,) that span azimuths [rad], and steps (A, M) that hold these azimuths.

        Steps go on into a second turn; of some boxes a few too many.
        """
        first = np.ceil((begin - self.start) / self.step - WIDER).astype(np.int64)
        last = np.floor((end - self.start) / self.step + WIDER).astype(np.int64)
        counts = np.minimum(last - first + 1, self.count)
        order = np.argsort(-counts, kind="stable")
        order = order[: np.count_nonzero(counts > 0)]
        first, counts, start = first[order] % self.count, counts[order], 0
        while start < len(order):
            width = int(counts[start])
            some = slice(start, start + max(1, RUNS_AT_ONCE // width))
            yield order[some], (first[some] + np.arange(width)[:, None]).astype(np.int32)
            start = some.stop

    def _through(
        self, boxes: PlacedBoxes, seen: BoxesFromAbove, which: Ints, column: NDArray[np.int32]
    ) -> RunBlock:
        x, y = (np.take(w, column) for w in self.rays)
        room = np.empty(column.shape)
        near, flank = (_inverse(side, which, x, y, room) for side in seen.near)
        np.minimum(near, flank, out=near)
        far, *others = (_inverse(side, which, x, y, room) for side in seen.far)
        for other in others:
            np.maximum(far, other, out=far)
        gap = near - far
        unsure = np.abs(gap) < GRAZING
        unsure |= seen.in_line[which]
        middle, half = boxes.offsets[which, 2], boxes.halves[which, 2]
        bottom, top = (z * self.slopes.scale for z in (middle - half, middle + half))
        one, other = bottom * near, bottom * far
        low, doubt = self.slopes.below(np.minimum(one, other, out=one))
        np.multiply(top, near, out=one)
        np.multiply(top, far, out=other)
        high, more = self.slopes.below(np.maximum(one, other, out=one))
        unsure |= doubt
        unsure |= more
        high[gap <= 0.0] = 0
        np.maximum(high, low, out=high)
        column[column >= self.count] -= self.count
        return RunBlock(which, column, low, high, near, far, unsure)


def _inverse(side: SideLines, which: Ints, x: Floats, y: Floats, room: Floats) -> Floats:
    """Inverse distances to sides along rays (A, N)."""
    a, b = (w[which] for w in side)
    found = a * x
    found += np.multiply(b, y, out=room)
    return found

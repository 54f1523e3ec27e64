"""Where the boxes of a class would stand, attempt after attempt, by a low-discrepancy sequence."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..prior.boxes import Boxes
from ..prior.classes import ObjectClass, places
from ..scene.space import PerceptionSpace
from ..scoring.sobol import DIMENSIONS, scrambled_sobol

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

X, Y, HEIGHT, LENGTH, WIDTH, HEADING, ANY = range(DIMENSIONS)
"""What the Sobol' sequence's dimensions draw; the first, which fill best, the place."""
GOLDEN = 0.6180339887498949
"""Scrambles of the sequence are multiples of this, modulo 1: no two are alike."""
DECIMALS = 4
"""Places and sizes are rounded to 0.1 mm, as placements are: the same bits everywhere."""
SPREADS = 2.0
"""Sizes scatter normally within so many standard deviations, and half of the mean at most."""
NORMAL = NormalDist()


class StandingBoxes(NamedTuple):
    """Boxes with a place: `centers` (N, 3) and `sizes` (N, 3) [m], `yaws` (N,) [rad]."""

    centers: Floats
    sizes: Floats
    yaws: Floats

    def some(self, which: NDArray) -> StandingBoxes:
        """Return some of them."""
        return StandingBoxes(*(values[which] for values in self))


class BoxSource(ABC):
    """Gives the boxes of a class that are to be set in scenes."""

    @abstractmethod
    def drawn(self, attempt: int) -> StandingBoxes:
        """Return the boxes where they would stand; each elsewhere at every attempt."""


class ModelBoxes(BoxSource):
    """Boxes of a class of a prior's model: their sizes and headings hold for all attempts."""

    def __init__(self, cls: ObjectClass, space: PerceptionSpace, count: int, shift: float) -> None:
        self._class, self._space, self._count, self._shift = cls, space, count, shift
        u = scrambled_sobol(count, scrambles(shift, 0))
        spreads = (cls.length_spread, cls.width_spread, cls.height_spread)
        by_axis = zip((LENGTH, WIDTH, HEIGHT), cls.size, spreads, strict=True)
        sizes = [_scattered(u[:, axis], mean, spread) for axis, mean, spread in by_axis]
        self._sizes = np.asarray(np.round(np.stack(sizes, axis=1), DECIMALS), dtype=np.float64)
        turned = u[:, ANY] < cls.any_heading
        facing = np.round(np.pi * (u[:, HEADING] - 0.5), DECIMALS)
        self._yaws: Floats = np.where(turned, facing, 0.0).astype(np.float64)

    def drawn(self, attempt: int) -> StandingBoxes:
        """Send points of the sequence through the inverse of the class's density."""
        u = scrambled_sobol(self._count, scrambles(self._shift, attempt)[: Y + 1])
        x, y = places(self._class, self._space, u[:, X], u[:, Y])
        centers = np.stack([x, y, self._sizes[:, 2] / 2.0], axis=1)
        return StandingBoxes(np.round(centers, DECIMALS + 1), self._sizes, self._yaws)


class LabelledBoxes(BoxSource):
    """Labelled boxes as they are: which of them stand in a scene is drawn, and nothing else."""

    def __init__(self, boxes: StandingBoxes, count: int, shift: float) -> None:
        x, y = boxes.centers[:, 0], boxes.centers[:, 1]
        self._boxes = boxes.some(np.argsort(x * x + y * y, kind="stable"))
        self._count, self._shift = count, shift

    def drawn(self, attempt: int) -> StandingBoxes:
        """Draw from the boxes, the nearest first; others at each attempt."""
        u = scrambled_sobol(self._count, scrambles(self._shift, attempt)[:1])[:, 0]
        return self._boxes.some((u * len(self._boxes.yaws)).astype(np.int64))


def labelled(boxes: Boxes, name: str, space: PerceptionSpace) -> StandingBoxes:
    """Return the labelled boxes of a class whose middles are in a space, seen from above."""
    inside = (boxes.names == name) & (boxes.x >= space.x[0]) & (boxes.x <= space.x[1])
    some = np.flatnonzero(inside & (boxes.y >= space.y[0]) & (boxes.y <= space.y[1]))
    centers = np.stack([boxes.x[some], boxes.y[some], boxes.z[some]], axis=1)
    sizes = np.stack([boxes.length[some], boxes.width[some], boxes.height[some]], axis=1)
    return StandingBoxes(centers, sizes, boxes.yaw[some])


def scrambles(shift: float, attempt: int) -> Sequence[float]:
    """Return the numbers in [0, 1) that scramble the sequence for an attempt."""
    return [(shift + GOLDEN * (attempt * DIMENSIONS + d)) % 1.0 for d in range(DIMENSIONS)]


def _scattered(u: Floats, mean: float, spread: float) -> Floats:
    """Send numbers in [0, 1) to sizes that scatter normally round a mean, none far from it."""
    if spread == 0.0:
        return np.full(len(u), mean)
    most = min(SPREADS, mean / 2.0 / spread)
    low, high = NORMAL.cdf(-most), NORMAL.cdf(most)
    inside = (low + u * (high - low)).tolist()
    return mean + spread * np.array([NORMAL.inv_cdf(v) for v in inside])

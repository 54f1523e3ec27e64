"""Which beams of a fan end on which box of a scene, where boxes hide each other.

At an azimuth of a scene boxes stand one behind the other: each has its beams as bits, and takes
those that no nearer one has taken. Where two overlap along the ray, or an order is not sure, the
beams' hits are left to be compared one by one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .box_beams import BoxBeams
from .fan_beams import FanBeams
from .object_definition import BoxHits
from .object_runs import ChannelRuns

Ints = NDArray[np.int64]
Bits = NDArray[np.uint64]
Flags = NDArray[np.bool_]

WORD = 64
BELOW = np.array([(1 << n) - 1 for n in range(WORD + 1)], np.uint64)
"""So many lowest bits."""
ONES = np.array([bin(n).count("1") for n in range(1 << 16)], np.uint8)
APART_M = 1e-5
"""Boxes nearer to each other than this along a ray are compared beam by beam."""


LEAST_INVERSE = 1e-9
"""Stands for an inverse distance of 0 or below, of a run that is unsure [1/m]."""


class FanTraffic:
    """The runs of one fan through the boxes of all scenes.

    Parameters
    ----------
    beams : BoxBeams
    fan : FanBeams
    scenes : (N,) int
    tangled : (T,) int
        Scenes whose beams are all to be compared one by one.
    """

    def __init__(self, beams: BoxBeams, fan: FanBeams, scenes: Ints, tangled: Ints) -> None:
        self._beams, self._fan, self._scenes, self._tangled = beams, fan, scenes, tangled
        self._runs: list[ChannelRuns] = []

    def add(self, runs: ChannelRuns) -> None:
        """Add runs at azimuths that exist."""
        self._runs.append(runs)

    def count(self) -> tuple[Ints, BoxHits]:
        """(N,) beams on each box, but for those whose hits are left to be compared."""
        runs = ChannelRuns.joined(self._runs)
        bits, counted = self._bits(runs)
        place = self._scenes[runs.item] * len(self._fan.place) + runs.column
        most = self._beams.lidar.max_range  # no beam ends beyond
        distance = np.minimum(1.0 / np.maximum(runs.near, LEAST_INVERSE), most)
        order = np.argsort(place + distance / (most + 1.0))
        left = self._unclear(runs, place, order)
        taken = np.zeros(len(self._scenes), np.int64)
        sure = order[~left[order]]
        seen = _first_to_take(place[sure], bits[sure]) & counted[sure]
        np.add.at(taken, runs.item[sure], _ones(seen))
        return taken, self._hits(runs.some(left))

    def _bits(self, runs: ChannelRuns) -> tuple[Bits, Bits]:
        """(R, W) beams of runs that end on their box, or before it in a box; and that count."""
        words = -(-len(self._fan.first) // WORD)
        bits = _between(runs.low, runs.high, words)
        if self._fan.stops is not None:
            bits &= ~_packed(self._fan.stops.flags, words)[runs.column]
        asked = np.flatnonzero(~self._fan.settled(runs)[0])
        counted = bits.copy()
        hits = self._fan.tested(self._beams, runs.some(asked))
        far = hits.enter >= self._beams.lidar.min_range
        for all_, own in ((bits, hits), (counted, hits.some(far))):
            flags = np.zeros((len(asked), len(self._fan.first)), bool)
            flags[own.run, own.channel] = True
            all_[asked] = _packed(flags, words)
        return bits, counted

    def _unclear(self, runs: ChannelRuns, place: Ints, order: Ints) -> Flags:
        """Which runs are at a place where the order is not sure."""
        one, next_ = order[:-1], order[1:]
        with np.errstate(divide="ignore"):  # of runs that are unsure
            apart = 1.0 / runs.far[one] + APART_M < 1.0 / runs.near[next_]
        apart &= ~(runs.unsure[one] | runs.unsure[next_])
        bad = place[one[(place[one] == place[next_]) & ~apart]]
        return np.isin(place, bad) | np.isin(self._scenes[runs.item], self._tangled)

    def _hits(self, runs: ChannelRuns) -> BoxHits:
        found = self._fan.tested(self._beams, runs)
        return BoxHits(runs.item[found.run], found.beam, found.enter)


def _between(low: NDArray, high: NDArray, words: int) -> Bits:
    """(R, W) bits from `low` to below `high`."""
    first = np.arange(words) * WORD
    ends = (np.clip(n[:, None] - first, 0, WORD) for n in (low.astype(np.int64), high))
    below_low, below_high = (BELOW[n] for n in ends)
    return below_high & ~below_low


def _packed(flags: Flags, words: int) -> Bits:
    """(R, W) flags (R, C) as bits."""
    wide = np.zeros((len(flags), words * WORD), bool)
    wide[:, : flags.shape[1]] = flags
    return np.packbits(wide, axis=1, bitorder="little").view("<u8").astype(np.uint64)


def _ones(bits: Bits) -> Ints:
    """(R,) number of bits that are set, (R, W)."""
    parts = np.ascontiguousarray(bits).view(np.uint16).reshape(len(bits), 4 * bits.shape[1])
    return ONES[parts].sum(axis=1, dtype=np.int64)


def _first_to_take(place: Ints, bits: Bits) -> Bits:
    """(R, W) bits that no run before has, at the same place; places ascend."""
    starts = np.flatnonzero(np.diff(place, prepend=-1))
    sizes = np.diff(starts, append=len(place))
    taken, seen = bits[starts].copy(), bits.copy()
    for rank in range(1, int(sizes.max(initial=0))):
        some = np.flatnonzero(sizes > rank)
        at = starts[some] + rank
        seen[at] &= ~taken[some]
        taken[some] |= bits[at]
    return seen

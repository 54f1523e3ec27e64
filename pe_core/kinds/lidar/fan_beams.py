"""A fan's beams by channel and azimuth step: which exist, and which the vehicle stops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.numbering import count_up
from .box_beams import BoxBeams
from .ends import AnyEnds
from .fans import Fan
from .lattice import Lattice
from .object_runs import ChannelRuns, RunBlock

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

ROOM_M = 1e-6
"""A box that begins this much beyond where the last stopped beam of its azimuth ends is behind it
for sure."""


@dataclass(frozen=True, slots=True)
class FanStops:
    """Beams of a fan that the vehicle stops.

    By azimuth step: `above` (A,) the first channel above all of them; `far` (A,) the farthest end
    of one [m]; `before` (A, C + 1) how many are among the lowest channels; `flags` (A, C).
    """

    above: NDArray[np.int16]
    far: Floats
    before: NDArray[np.int16]
    flags: Flags


@dataclass(frozen=True, slots=True)
class FanBeams:
    """A fan's beams: number `first` (C,) of each channel's, and place (A,) of each azimuth step.

    A step that does not exist has a place of -1. `unclear` (N,) says of which boxes a part may be
    out of range.
    """

    first: Ints
    place: Ints
    stops: FanStops | None
    unclear: Flags

    @classmethod
    def of(cls, fan: Fan, lattice: Lattice, ends: AnyEnds, unclear: Flags) -> FanBeams:
        """Number a fan's beams; those that the vehicle may stop are cast."""
        first, place = fan.channels * lattice.width, lattice.position
        return cls(first, place, _stops(first, place, ends), unclear)

    def asked(self, block: RunBlock) -> Flags:
        """(A, N) which runs of a block are not all their channels, or may not be."""
        asked = block.unsure | self.unclear[block.item]
        if self.stops is not None:
            asked |= block.low < np.take(self.stops.above, block.column)
        if len(self.place) > np.count_nonzero(self.place >= 0):
            asked |= np.take(self.place, block.column) < 0
        return asked

    def existing(self, runs: ChannelRuns) -> ChannelRuns:
        """Return the runs at azimuth steps that exist, and are not empty for sure."""
        exists = (self.place[runs.column] >= 0) & (runs.unsure | (runs.low < runs.high))
        return runs.some(np.flatnonzero(exists))

    def settled(self, runs: ChannelRuns) -> tuple[Flags, NDArray[np.int16]]:
        """Whether the beams of runs that end on their boxes are known without a test.

        All but those that the vehicle stops, and how many those are.
        """
        stopped = np.zeros(len(runs.item), np.int16)
        known = ~(self.unclear[runs.item] | runs.unsure)
        if self.stops is not None:
            stopped = self.stops.before[runs.column, runs.high]
            stopped -= self.stops.before[runs.column, runs.low]
            behind = runs.near * (np.take(self.stops.far, runs.column) + ROOM_M) < 1.0
            known &= (stopped == 0) | behind
        return known, stopped

    def tested(self, beams: BoxBeams, runs: ChannelRuns) -> RunHits:
        """Test all beams of runs; of unsure ones those of all channels."""
        low = np.where(runs.unsure, 0, runs.low).astype(np.int64)
        n = np.where(runs.unsure, len(self.first), runs.high - low)
        run, channel = np.repeat(np.arange(len(n)), n), np.repeat(low, n) + count_up(n)
        beam = self.first[channel] + self.place[runs.column[run]]
        at, enter = beams.met(runs.item[run], beam)
        return RunHits(run[at], channel[at], beam[at], enter)


@dataclass(frozen=True, slots=True)
class RunHits:
    """Beams of runs that are hits, (H,) each: run, channel of the fan, beam, where it enters."""

    run: Ints
    channel: Ints
    beam: Ints
    enter: Floats

    def some(self, which: Flags) -> RunHits:
        """Return some of them."""
        return RunHits(self.run[which], self.channel[which], self.beam[which], self.enter[which])


def _stops(first: Ints, place: Ints, ends: AnyEnds) -> FanStops | None:
    """Cast what may be stopped of a fan; None where nothing is."""
    exists = np.flatnonzero(place >= 0)
    channel, step = np.nonzero(ends.stopped[first[:, None] + place[exists]])
    end = ends.some(first[channel] + place[exists[step]])
    real = np.flatnonzero(end < ends.longest)
    if not len(real):
        return None
    step, channel, end = exists[step[real]], channel[real], end[real]
    flags, far = np.zeros((len(place), len(first)), bool), np.zeros(len(place))
    flags[step, channel] = True
    np.maximum.at(far, step, end)
    before = np.zeros((len(place), len(first) + 1), np.int16)
    np.cumsum(flags, axis=1, out=before[:, 1:])
    above = np.zeros(len(place), np.int16)
    np.maximum.at(above, step, (channel + 1).astype(np.int16))
    return FanStops(above, far, before, flags)

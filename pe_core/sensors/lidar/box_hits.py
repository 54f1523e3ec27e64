"""Which beams of a LiDAR hit boxes: exact tests of (box, beam) pairs, and which pairs need one.

`BoxTester` tests pairs with the arithmetic of the definition. `candidate_hits` tests the beams in
each box's window of azimuth and elevation, for any orientation and pattern. `FanBeams` knows the
beams of one fan by channel and azimuth step: for most runs of channels it says without a test how
many beams end on the box.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints, join_columns
from ...geometry.bins import blocks, count_up
from ...geometry.poses import rotate
from ...scene.rig import Sensor
from ..boxes import PlacedBoxes
from .definition import BoxHits
from .lattice import Windows, lattice_of, windows_of
from .model import Lidar, lidar_of

if TYPE_CHECKING:
    from .beams import BeamEnds, RotatedBeams
    from .fan_runs import ChannelRuns, Fan, RunBlock
    from .lattice import Lattice


PAIR_BLOCK = 1 << 15
"""(box, beam) pairs tested together: their arrays fit the processor's cache."""
BOX_BLOCK = 256
"""Boxes whose candidates are tested together: they fit the memory, however near the boxes are."""
BEHIND_MARGIN_M = 1e-6
"""A box is surely behind the vehicle if it begins this much beyond the farthest end of an occluded
beam at its azimuth."""


@dataclass(frozen=True, slots=True)
class BoxTester:
    """Tests which beams of a mounted LiDAR hit which of N boxes round it."""

    sensor: Sensor
    boxes: PlacedBoxes
    beams: RotatedBeams
    ends: BeamEnds

    @property
    def lidar(self) -> Lidar:
        """The sensor's model."""
        return lidar_of(self.sensor)

    def hit_pairs(self, box: Ints, beam: Ints) -> tuple[Ints, Floats]:
        """Test (box, beam) pairs (P,): a hit is a beam that enters the box before it ends. Returns
        the indices (H,) of the hits, and the distances (H,) at which they enter [m]."""
        parts = [(np.zeros(0, np.int64), np.zeros(0))]
        for block in blocks(len(box), PAIR_BLOCK):
            some = beam[block]
            enter, leave = self.boxes.crossing(box[block], self.beams.take(some))
            index = np.flatnonzero((enter < leave) & (enter <= self.lidar.max_range))
            some = some[index]
            enter = enter[index]
            occludable = np.flatnonzero(self.ends.occludable[some])
            if len(occludable):
                kept = np.ones(len(index), bool)
                kept[occludable] = enter[occludable] <= self.ends.take(some[occludable])
                index = index[kept]
                enter = enter[kept]
            parts.append((index + block.start, enter))
        index, enter = join_columns(parts)
        return index, enter

    def hits(self, box: Ints, beam: Ints) -> BoxHits:
        """Return the hits among (box, beam) pairs (P,)."""
        index, enter = self.hit_pairs(box, beam)
        return BoxHits(box[index], beam[index], enter)

    def hits_of_all_beams(self, boxes: Ints) -> BoxHits:
        """Return the hits of some boxes by all beams."""
        count = self.lidar.beam_count
        return concatenated(
            [self.hits(np.full(count, box), np.arange(count)) for box in boxes.tolist()]
        )

    def count(self, hits: BoxHits) -> Ints:
        """Return the number (N,) of hits of each box, beyond the minimum range."""
        in_range = hits.enter >= self.lidar.min_range
        return np.bincount(hits.box[in_range], minlength=len(self.boxes.offsets))


def concatenated(parts: list[BoxHits]) -> BoxHits:
    """Join hits."""
    none = BoxHits(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))
    keys = ("box", "beam", "enter")
    return BoxHits(*(np.concatenate([getattr(p, key) for p in [none, *parts]]) for key in keys))


def box_windows(tester: BoxTester) -> Windows:
    """Return the windows (N,) of all boxes."""
    boxes = tester.boxes
    axes = tester.sensor.pose.ground_from_sensor
    center = rotate(axes.T, boxes.in_ground(boxes.offsets)).T
    half_axes = zip(boxes.halves.T, boxes.axes_in(axes), strict=True)
    return windows_of(center, [half * axis for half, axis in half_axes])


def candidate_hits(tester: BoxTester) -> Iterator[BoxHits]:
    """Yield all hits of all boxes, by testing the beams in each box's window."""
    windows = box_windows(tester)
    lattice = lattice_of(tester.lidar)
    all_round = windows.half_azimuth > np.pi
    yield tester.hits_of_all_beams(np.flatnonzero(all_round))
    boxes = np.flatnonzero(~all_round)
    for block in blocks(len(boxes), BOX_BLOCK):
        item, beam = lattice.candidates(windows.take(boxes[block]))
        yield tester.hits(boxes[block][item], beam)


@dataclass(frozen=True, slots=True)
class FanOcclusion:
    """Beams of a fan that the vehicle occludes, by azimuth step. `above` (A,) is the first channel
    above all of them, `farthest` (A,) the farthest end of one [m], `cumulative` (A, C + 1) their
    number among the lowest channels, `flags` (A, C) which they are."""

    above: NDArray[np.int16]
    farthest: Floats
    cumulative: NDArray[np.int16]
    flags: Flags


@dataclass(frozen=True, slots=True)
class FanBeams:
    """The beams of one fan by channel and azimuth step. `first` (C,) is the index of each channel's
    first beam, `position` (A,) that of an azimuth step among a channel's beams (-1: the step has no
    beam). `range_unsure` (N,) flags the boxes of which a part may be out of range."""

    first: Ints
    position: Ints
    occlusion: FanOcclusion | None
    range_unsure: Flags

    @classmethod
    def of(cls, fan: Fan, lattice: Lattice, ends: BeamEnds, range_unsure: Flags) -> FanBeams:
        """Index a fan's beams, and cast those that the vehicle may occlude."""
        first = fan.channels * lattice.width
        position = lattice.position
        return cls(first, position, _occlusion(first, position, ends), range_unsure)

    def needs_check(self, block: RunBlock) -> Flags:
        """Flag the runs (A, N) of a block whose channels may not all be hits."""
        unsure = block.unsure | self.range_unsure[block.box]
        if self.occlusion is not None:
            unsure |= block.low < np.take(self.occlusion.above, block.column)
        if len(self.position) > np.count_nonzero(self.position >= 0):
            unsure |= np.take(self.position, block.column) < 0
        return unsure

    def existing(self, runs: ChannelRuns) -> ChannelRuns:
        """Return the runs that may hold a beam: at existing azimuth steps, and not empty."""
        exists = (self.position[runs.column] >= 0) & (runs.unsure | (runs.low < runs.high))
        return runs.take(np.flatnonzero(exists))

    def decided(self, runs: ChannelRuns) -> tuple[Flags, NDArray[np.int16]]:
        """Return whether runs (R,) are decided without a test, and their occluded beams (R,). All
        beams of a decided run hit its box, except those that the vehicle occludes."""
        occluded = np.zeros(len(runs.box), np.int16)
        decided = ~(self.range_unsure[runs.box] | runs.unsure)
        if self.occlusion is not None:
            occluded = self.occlusion.cumulative[runs.column, runs.high]
            occluded -= self.occlusion.cumulative[runs.column, runs.low]
            farthest = np.take(self.occlusion.farthest, runs.column)
            behind = runs.near * (farthest + BEHIND_MARGIN_M) < 1.0
            decided &= (occluded == 0) | behind
        return decided, occluded

    def hits_of_runs(self, tester: BoxTester, runs: ChannelRuns) -> RunHits:
        """Test all beams of runs; for an unsure run the beams of all channels."""
        low = np.where(runs.unsure, 0, runs.low).astype(np.int64)
        n = np.where(runs.unsure, len(self.first), runs.high - low)
        run = np.repeat(np.arange(len(n)), n)
        channel = np.repeat(low, n) + count_up(n)
        beam = self.first[channel] + self.position[runs.column[run]]
        index, enter = tester.hit_pairs(runs.box[run], beam)
        return RunHits(run[index], channel[index], beam[index], enter)


@dataclass(frozen=True, slots=True)
class RunHits:
    """Hits of runs, (H,) each: run, channel of the fan, beam, distance where it enters [m]."""

    run: Ints
    channel: Ints
    beam: Ints
    enter: Floats


def _occlusion(first: Ints, position: Ints, ends: BeamEnds) -> FanOcclusion | None:
    """Cast a fan's beams that may be occluded; None where none is."""
    exists = np.flatnonzero(position >= 0)
    channel, step = np.nonzero(ends.occludable[first[:, None] + position[exists]])
    end = ends.take(first[channel] + position[exists[step]])
    occluded = np.flatnonzero(end < ends.max_range)
    if not len(occluded):
        return None
    step = exists[step[occluded]]
    channel = channel[occluded]
    end = end[occluded]
    flags = np.zeros((len(position), len(first)), bool)
    farthest = np.zeros(len(position))
    flags[step, channel] = True
    np.maximum.at(farthest, step, end)
    cumulative = np.zeros((len(position), len(first) + 1), np.int16)
    np.cumsum(flags, axis=1, out=cumulative[:, 1:])
    above = np.zeros(len(position), np.int16)
    np.maximum.at(above, step, (channel + 1).astype(np.int16))
    return FanOcclusion(above, farthest, cumulative, flags)

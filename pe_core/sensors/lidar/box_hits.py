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

from ...base.arrays import Flags, Floats, Ints
from ...geometry.indexing import blocks, count_up, stable_order
from ...geometry.poses import dot, rotate
from ...scene.rig import Sensor
from ..boxes import PlacedBoxes
from .definition import BoxHits
from .lattice import WINDOW_MARGIN, Windows, lattice_of
from .model import Lidar, lidar_of

if TYPE_CHECKING:
    from .beams import BeamEnds, RotatedBeams
    from .fan_runs import ChannelRuns, Fan, RunBlock
    from .lattice import Lattice


PAIR_BLOCK = 1 << 15
"""(box, beam) pairs tested together: their arrays fit the processor's cache."""
NO_BOX = np.iinfo(np.int64).max
BOX_BLOCK = 256
"""Boxes whose candidates are tested together: they fit the memory, however near the boxes are."""
MIN_AXIS_DISTANCE_M = 1e-3
"""A box nearer than this to the LiDAR's axis has all beams tested."""
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
        """Test (box, beam) pairs (P,): a hit is a beam that enters the box before it ends.

        Returns the indices (H,) of the hits, and the distances (H,) at which they enter [m].
        """
        parts = []
        for block in blocks(len(box), PAIR_BLOCK):
            index, enter = self._hit_block(box[block], beam[block])
            parts.append((index + block.start, enter))
        if not parts:
            return np.zeros(0, np.int64), np.zeros(0)
        index, enter = (np.concatenate(w) for w in zip(*parts, strict=True))
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

    def max_distances(self) -> Floats:
        """Return upper bounds (N,) of the distance of any point of each box [m]."""
        corner = np.abs(self.boxes.offsets) + self.boxes.halves
        return np.asarray(np.sqrt(dot(corner, corner)))

    def _hit_block(self, box: Ints, beam: Ints) -> tuple[Ints, Floats]:
        enter, leave = self.boxes.crossing(box, self.beams.take(beam))
        index = np.flatnonzero((enter < leave) & (enter <= self.lidar.max_range))
        beam, enter = beam[index], enter[index]
        occludable = np.flatnonzero(self.ends.occludable[beam])
        if len(occludable):
            kept = np.ones(len(index), bool)
            kept[occludable] = enter[occludable] <= self.ends.take(beam[occludable])
            index, enter = index[kept], enter[kept]
        return index, enter


def concatenated(parts: list[BoxHits]) -> BoxHits:
    """Join hits."""
    if not parts:
        return BoxHits(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))
    keys = ("box", "beam", "enter")
    return BoxHits(*(np.concatenate([getattr(p, key) for p in parts]) for key in keys))


def nearest_hits(hits: BoxHits, scenes: Ints, beam_count: int) -> BoxHits:
    """Return the hits of `definition.first_of_scene`, in any order; `scenes` (N,) by box.

    Fast because it takes minima over `beam_count` beams, scene by scene, and sorts no distances.
    """
    scene = scenes[hits.box]
    order = stable_order(scene)
    starts = np.flatnonzero(np.diff(scene[order], prepend=-1))
    nearest, nearest_box = np.full(beam_count, np.inf), np.full(beam_count, NO_BOX)
    kept = [np.zeros(0, np.int64)]
    for in_scene in np.split(order, starts[1:]):
        beam = hits.beam[in_scene]
        np.minimum.at(nearest, beam, hits.enter[in_scene])
        first = in_scene[hits.enter[in_scene] == nearest[beam]]
        np.minimum.at(nearest_box, hits.beam[first], hits.box[first])
        kept.append(first[nearest_box[hits.beam[first]] == hits.box[first]])
        nearest[beam], nearest_box[beam] = np.inf, NO_BOX
    index = np.concatenate(kept)
    return BoxHits(hits.box[index], hits.beam[index], hits.enter[index])


def candidate_hits(tester: BoxTester) -> Iterator[BoxHits]:
    """Yield all hits of all boxes, by testing the beams in each box's window."""
    windows, off_axis = _windows(tester)
    lattice = lattice_of(tester.lidar)
    yield tester.hits_of_all_beams(np.flatnonzero(~off_axis))
    boxes = np.flatnonzero(off_axis)
    for block in blocks(len(boxes), BOX_BLOCK):
        box = boxes[block]
        item, beam = lattice.candidates(Windows(*(w[box] for w in windows)))
        yield tester.hits(box[item], beam)


def azimuth_spans(tester: BoxTester) -> tuple[tuple[Floats, Floats], Flags]:
    """Return the first and last azimuth (N,) of boxes [rad], and which may be hit, by elevation."""
    (middle, half, low, high), off_axis = _windows(tester)
    half, channels = np.where(off_axis, half, np.pi), tester.lidar.elevations
    among = (low <= channels.max()) & (high >= channels.min())
    return (middle - half, middle + half), among | ~off_axis


def _windows(tester: BoxTester) -> tuple[tuple[Floats, Floats, Floats, Floats], Flags]:
    """Fields of `Windows` (N,) of all boxes, and whether each is off the sensor's axis."""
    boxes, ground_axes = tester.boxes, tester.sensor.pose.ground_from_sensor
    c, s = boxes.headings.T
    x, y, z = boxes.offsets.T
    x, y, z = rotate(ground_axes.T, np.stack([c * x - s * y, s * x + c * y, z], axis=1)).T
    flat = np.sqrt(x * x + y * y)
    safe = np.maximum(flat, MIN_AXIS_DISTANCE_M)
    cos, sin = x / safe, y / safe
    zero = np.zeros(len(c))
    in_ground = ((c, s, zero), (-s, c, zero), (zero, zero, zero + 1.0))
    box_axes = [rotate(ground_axes.T, np.stack(w, axis=1)).T for w in in_ground]  # in the sensor's
    halves = boxes.halves.T
    depth = sum(h * np.abs(w[0] * cos + w[1] * sin) for h, w in zip(halves, box_axes, strict=True))
    width = sum(h * np.abs(w[1] * cos - w[0] * sin) for h, w in zip(halves, box_axes, strict=True))
    height = sum(h * np.abs(w[2]) for h, w in zip(halves, box_axes, strict=True))
    near, far = flat - depth, np.sqrt((flat + depth) ** 2 + width**2)
    off_axis = near > MIN_AXIS_DISTANCE_M
    safe_near = np.where(off_axis, near, 1.0)
    high = np.arctan2(z + height, np.where(z + height > 0.0, safe_near, far)) + WINDOW_MARGIN
    low = np.arctan2(z - height, np.where(z - height > 0.0, far, safe_near)) - WINDOW_MARGIN
    half = np.arctan2(width, safe_near) + WINDOW_MARGIN
    return (np.arctan2(y, x), half, low, high), off_axis


@dataclass(frozen=True, slots=True)
class FanOcclusion:
    """Beams of a fan that the vehicle occludes, by azimuth step.

    `above` (A,) is the first channel above all of them, `farthest` (A,) the farthest end of one
    [m], `cumulative` (A, C + 1) their number among the lowest channels, `flags` (A, C) which they
    are.
    """

    above: NDArray[np.int16]
    farthest: Floats
    cumulative: NDArray[np.int16]
    flags: Flags


@dataclass(frozen=True, slots=True)
class FanBeams:
    """The beams of one fan by channel and azimuth step.

    `first` (C,) is the index of each channel's first beam, `position` (A,) that of an azimuth step
    among a channel's beams (-1: the step has no beam). `range_unsure` (N,) flags the boxes of which
    a part may be out of range.
    """

    first: Ints
    position: Ints
    occlusion: FanOcclusion | None
    range_unsure: Flags

    @classmethod
    def of(cls, fan: Fan, lattice: Lattice, ends: BeamEnds, range_unsure: Flags) -> FanBeams:
        """Index a fan's beams, and cast those that the vehicle may occlude."""
        first, position = fan.channels * lattice.width, lattice.position
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
        """Return whether runs (R,) are decided without a test, and their occluded beams (R,).

        All beams of a decided run hit its box, except those that the vehicle occludes.
        """
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
        run, channel = np.repeat(np.arange(len(n)), n), np.repeat(low, n) + count_up(n)
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

    def take(self, index: Flags) -> RunHits:
        """Return the hits with these flags."""
        return RunHits(self.run[index], self.channel[index], self.beam[index], self.enter[index])


def _occlusion(first: Ints, position: Ints, ends: BeamEnds) -> FanOcclusion | None:
    """Cast a fan's beams that may be occluded; None where none is."""
    exists = np.flatnonzero(position >= 0)
    channel, step = np.nonzero(ends.occludable[first[:, None] + position[exists]])
    end = ends.take(first[channel] + position[exists[step]])
    occluded = np.flatnonzero(end < ends.max_range)
    if not len(occluded):
        return None
    step, channel, end = exists[step[occluded]], channel[occluded], end[occluded]
    flags, farthest = np.zeros((len(position), len(first)), bool), np.zeros(len(position))
    flags[step, channel] = True
    np.maximum.at(farthest, step, end)
    cumulative = np.zeros((len(position), len(first) + 1), np.int16)
    np.cumsum(flags, axis=1, out=cumulative[:, 1:])
    above = np.zeros(len(position), np.int16)
    np.maximum.at(above, step, (channel + 1).astype(np.int16))
    return FanOcclusion(above, farthest, cumulative, flags)

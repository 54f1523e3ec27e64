"""The LiDAR's kernel for objects: beams that end on boxes that stay while sensors move.

An upright LiDAR's beams are counted azimuth by azimuth, as runs of channels (`planar_clip`). Where
rounding, the range or the vehicle could decide, the beams are tested one by one, as the definition
does. A tilted LiDAR is counted in the same way. With too many fans every beam that may hit a box is
tested.

In traffic the boxes of a scene occlude each other. At one azimuth they stand one behind the other:
the beams of each box are bits, and each box takes the bits that no nearer box has taken
(`FanTraffic`). Where two boxes overlap along the ray, or their order is unsure, the hits are
compared beam by beam. Of a tilted LiDAR the order is that of whole boxes: of those that are as far
away as each other, the hits are compared, too.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints
from ...scene.rig import Sensor
from ..boxes import BodyParts, PlacedBoxes
from ..kernels import ObjectKernel, ObjectView
from .beams import BeamCache
from .box_hits import BoxTester, FanBeams, azimuth_spans, candidate_hits, concatenated, nearest_hits
from .definition import BoxHits, counts_in_bands
from .fan_runs import ChannelRuns, Fan, RotatedFan, RunBlock, fans_of
from .lattice import lattice_of
from .model import lidar_of
from .planar_clip import PlanarBoxes, TiltedBoxes, tilted_runs, upright_runs

Bits = NDArray[np.uint64]

MAX_FANS = 16
"""With more fans, testing beams one by one is as fast."""
MAX_SLOPE = 1e3
"""A LiDAR with a steeper channel, along its own axis, has its beams tested one by one."""
WORD = 64
LOW_BITS = np.array([(1 << n) - 1 for n in range(WORD + 1)], np.uint64)
"""Words whose n lowest bits are set, by n."""
BIT_COUNTS = np.array([bin(n).count("1") for n in range(1 << 16)], np.uint8)
"""Number of set bits of each 16-bit word."""
MIN_GAP_M = 1e-5
"""Boxes nearer to each other than this along a ray are compared beam by beam."""
MIN_INVERSE = 1e-9
"""Replaces an inverse distance of 0 or below, of an unsure run [1/m]."""


class LidarObjects(ObjectKernel):
    """Counts beams that end on objects."""

    def __init__(self, view: ObjectView) -> None:
        self._view, self.cache = view, BeamCache(view.vehicle)

    def measure(self, sensor: Sensor) -> Floats:
        """Count the beams (N,) that end on each object; equal to the definition."""
        scenes = self._view.objects.scenes if self._view.traffic else None
        return _count(self._tester(sensor), scenes).astype(float)

    def measure_parts(self, sensor: Sensor, parts: BodyParts) -> Floats:
        """Count the beams that meet cells of bodies (N,) in the band in which they surely end."""
        hits = concatenated(list(candidate_hits(self._tester(sensor))))
        return counts_in_bands(hits, parts, lidar_of(sensor).min_range)

    def _tester(self, sensor: Sensor) -> BoxTester:
        boxes = PlacedBoxes.of(self._view.objects, sensor.pose.position)
        ends = self.cache.cast(sensor, approximate=False).ends
        return BoxTester(sensor, boxes, self.cache.rotated(sensor), ends)

    def unoccluded(self, sensor: Sensor) -> Floats:
        """Count the beams (N,) that pass through each object."""
        return LidarObjects(ObjectView(self._view.objects)).measure(sensor)


def _count(tester: BoxTester, scenes: Ints | None) -> Ints:
    """Count the beams (N,) on all boxes in the fastest way; None for `scenes`: no traffic."""
    fans = fans_of(tester.lidar)
    few = len(fans) <= MAX_FANS and all(fan.slopes.steepest < MAX_SLOPE for fan in fans)
    roll, pitch, _ = tester.sensor.pose.rpy
    if not few:
        return _count_candidates(tester, scenes)
    if roll == 0.0 and pitch == 0.0:
        planar = PlanarBoxes.of(tester.boxes)
        outside, blocks = planar.beside, _upright(tester, planar)
    else:
        tilted = TiltedBoxes.of(tester.boxes, tester.sensor.pose.ground_from_sensor)
        outside, blocks = tilted.outside, _tilted(tester, tilted)
    others = tester.hits_of_all_beams(np.flatnonzero(~outside))
    if scenes is None:
        return tester.count(others) + _count_alone(tester, blocks)
    return _count_traffic(tester, blocks, others, scenes, np.unique(scenes[~outside]))


def _count_candidates(tester: BoxTester, scenes: Ints | None) -> Ints:
    """Count by testing every beam that may hit a box."""
    hits = candidate_hits(tester)
    if scenes is None:
        return np.add.reduce([tester.count(part) for part in hits])
    return tester.count(nearest_hits(concatenated(list(hits)), scenes, tester.lidar.beam_count))


def _count_alone(tester: BoxTester, blocks: Iterator[tuple[FanBeams, RunBlock]]) -> Ints:
    """Count from blocks of runs, where no box occludes another."""
    counts = np.zeros(len(tester.boxes.offsets), np.int64)
    unchecked: dict[int, tuple[FanBeams, list[ChannelRuns]]] = {}
    for fan, block in blocks:
        needs_check, number = fan.needs_check(block), block.high - block.low
        number[needs_check] = 0
        counts[block.box] += number.sum(axis=0)
        unchecked.setdefault(id(fan), (fan, []))[1].append(block.take(needs_check))
    for fan, parts in unchecked.values():
        runs = fan.existing(ChannelRuns.concatenated(parts))
        decided, occluded = fan.decided(runs)
        np.add.at(counts, runs.box[decided], (runs.high - runs.low - occluded)[decided])
        runs = runs.take(~decided)
        hits = fan.hits_of_runs(tester, runs)
        counts += tester.count(BoxHits(runs.box[hits.run], hits.beam, hits.enter))
    return counts


def _count_traffic(
    tester: BoxTester,
    blocks: Iterator[tuple[FanBeams, RunBlock]],
    others: BoxHits,
    scenes: Ints,
    unsorted_scenes: Ints,
) -> Ints:
    """Count from blocks of runs, where the boxes of a scene occlude each other.

    `others` are hits of boxes that have no runs: those above, below or round the sensor. Their
    scenes, `unsorted_scenes`, are compared beam by beam.
    """
    counts = np.zeros(len(scenes), np.int64)
    hits = [others]
    traffic: dict[int, FanTraffic] = {}
    for fan, block in blocks:
        of_fan = traffic.setdefault(id(fan), FanTraffic(tester, fan, scenes, unsorted_scenes))
        of_fan.add(fan.existing(block.take(block.unsure | (block.low < block.high))))
    for of_fan in traffic.values():
        fan_counts, undecided = of_fan.count()
        counts += fan_counts
        hits.append(undecided)
    nearest = nearest_hits(concatenated(hits), scenes, tester.lidar.beam_count)
    return counts + tester.count(nearest)


def _upright(tester: BoxTester, planar: PlanarBoxes) -> Iterator[tuple[FanBeams, RunBlock]]:
    """Yield the runs of an upright LiDAR through all boxes it is beside, fan by fan."""
    lidar, yaw = tester.lidar, tester.sensor.pose.rpy[2]
    boxes = np.flatnonzero(planar.beside & (planar.distance <= lidar.max_range))
    for fan, beams in _fans(tester, planar.distance):
        rotated = RotatedFan.of(fan, yaw, lidar.azimuth_step, lidar.azimuth_count)
        for block in upright_runs(rotated, tester.boxes, planar, boxes):
            yield beams, block


def _tilted(tester: BoxTester, tilted: TiltedBoxes) -> Iterator[tuple[FanBeams, RunBlock]]:
    """Yield the runs of a tilted LiDAR through all boxes it is outside of, fan by fan."""
    lidar, distance = tester.lidar, 1.0 / tilted.near
    spans, among = azimuth_spans(tester)
    boxes = np.flatnonzero(tilted.outside & (distance <= lidar.max_range) & among)
    for fan, beams in _fans(tester, distance):
        in_sensor = RotatedFan.of(fan, 0.0, lidar.azimuth_step, lidar.azimuth_count)
        for block in tilted_runs(in_sensor, tilted, spans, boxes):
            yield beams, block


def _fans(tester: BoxTester, distance: Floats) -> Iterator[tuple[Fan, FanBeams]]:
    """Yield the fans and their beams; boxes (N,) at a `distance` may be out of range in part."""
    lidar = tester.lidar
    unsure = (distance <= lidar.min_range) | (tester.max_distances() >= lidar.max_range)
    for fan in fans_of(lidar):
        yield fan, FanBeams.of(fan, lattice_of(lidar), tester.ends, unsure)


class FanTraffic:
    """Counts the beams of one fan on the boxes of all scenes, nearest box first.

    Fast because the beams of a box at one azimuth are the bits of a few words. `scenes` (N,) holds
    the scene of each box; in `unsorted_scenes` all hits are to be compared beam by beam.
    """

    def __init__(
        self, tester: BoxTester, fan: FanBeams, scenes: Ints, unsorted_scenes: Ints
    ) -> None:
        self._tester, self._fan = tester, fan
        self._scenes, self._unsorted_scenes = scenes, unsorted_scenes
        self._runs: list[ChannelRuns] = []

    def add(self, runs: ChannelRuns) -> None:
        """Add runs at existing azimuth steps."""
        self._runs.append(runs)

    def count(self) -> tuple[Ints, BoxHits]:
        """Return the beams (N,) on each box, and the hits that are still to be compared."""
        runs = ChannelRuns.concatenated(self._runs)
        bits, countable = self._bits(runs)
        ray = self._scenes[runs.box] * len(self._fan.position) + runs.column
        max_range = self._tester.lidar.max_range  # no beam ends beyond
        distance = np.minimum(1.0 / np.maximum(runs.near, MIN_INVERSE), max_range)
        order = np.argsort(ray + distance / (max_range + 1.0))
        undecided = self._undecided(runs, ray, order)
        counts = np.zeros(len(self._scenes), np.int64)
        sorted_runs = order[~undecided[order]]
        visible = _not_taken_before(ray[sorted_runs], bits[sorted_runs]) & countable[sorted_runs]
        np.add.at(counts, runs.box[sorted_runs], _bit_count(visible))
        runs = runs.take(undecided)
        hits = self._fan.hits_of_runs(self._tester, runs)
        return counts, BoxHits(runs.box[hits.run], hits.beam, hits.enter)

    def _bits(self, runs: ChannelRuns) -> tuple[Bits, Bits]:
        """Bits (R, W) of the beams that hit a run's box, and of those beyond the minimum range."""
        words = -(-len(self._fan.first) // WORD)
        bits = _bits_between(runs.low, runs.high, words)
        if self._fan.occlusion is not None:
            bits &= ~_packed(self._fan.occlusion.flags, words)[runs.column]
        tested = np.flatnonzero(~self._fan.decided(runs)[0])
        countable = bits.copy()
        hits = self._fan.hits_of_runs(self._tester, runs.take(tested))
        in_range = hits.enter >= self._tester.lidar.min_range
        for target, target_hits in ((bits, hits), (countable, hits.take(in_range))):
            flags = np.zeros((len(tested), len(self._fan.first)), bool)
            flags[target_hits.run, target_hits.channel] = True
            target[tested] = _packed(flags, words)
        return bits, countable

    def _undecided(self, runs: ChannelRuns, ray: Ints, order: Ints) -> Flags:
        """Flag the runs (R,) on rays along which the order of boxes is unsure."""
        nearer, farther = order[:-1], order[1:]
        with np.errstate(divide="ignore"):  # of unsure runs
            separate = 1.0 / runs.far[nearer] + MIN_GAP_M < 1.0 / runs.near[farther]
        separate &= ~(runs.unsure[nearer] | runs.unsure[farther])
        unsure_rays = ray[nearer[(ray[nearer] == ray[farther]) & ~separate]]
        in_unsorted = np.isin(self._scenes[runs.box], self._unsorted_scenes)
        return np.isin(ray, unsure_rays) | in_unsorted


def _bits_between(low: NDArray, high: NDArray, words: int) -> Bits:
    """Words (R, W) with the bits from `low` to below `high` set."""
    first = np.arange(words) * WORD
    ends = (np.clip(n[:, None] - first, 0, WORD) for n in (low.astype(np.int64), high))
    below_low, below_high = (LOW_BITS[n] for n in ends)
    return below_high & ~below_low


def _packed(flags: Flags, words: int) -> Bits:
    """Pack flags (R, C) into words (R, W)."""
    padded = np.zeros((len(flags), words * WORD), bool)
    padded[:, : flags.shape[1]] = flags
    return np.packbits(padded, axis=1, bitorder="little").view("<u8").astype(np.uint64)


def _bit_count(bits: Bits) -> Ints:
    """Count the set bits (R,) of words (R, W)."""
    parts = np.ascontiguousarray(bits).view(np.uint16).reshape(len(bits), 4 * bits.shape[1])
    return BIT_COUNTS[parts].sum(axis=1, dtype=np.int64)


def _not_taken_before(ray: Ints, bits: Bits) -> Bits:
    """Bits (R, W) that no earlier run of the same ray has; rays ascend."""
    starts = np.flatnonzero(np.diff(ray, prepend=-1))
    sizes = np.diff(starts, append=len(ray))
    taken, visible = bits[starts].copy(), bits.copy()
    for rank in range(1, int(sizes.max(initial=0))):
        longer = np.flatnonzero(sizes > rank)
        run = starts[longer] + rank
        visible[run] &= ~taken[longer]
        taken[longer] |= bits[run]
    return visible

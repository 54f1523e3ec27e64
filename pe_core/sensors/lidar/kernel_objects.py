"""The LiDAR's kernel for objects: beams that end on boxes that stay while sensors move.

An upright LiDAR's beams are counted azimuth by azimuth, as runs of channels (`planar_clip`). Where
rounding, the range or the vehicle could decide, the beams are tested one by one, as the definition
does. A tilted LiDAR is counted in the same way. With too many fans every beam that may hit a box is
tested.

In traffic the boxes of a scene occlude each other. At one azimuth they stand one behind the other:
the beams of each box are bits, and each box takes the bits that no nearer box has taken
(`_count_sorted`). Where two boxes overlap along the ray, or their order is unsure, the hits are
compared beam by beam. Of a tilted LiDAR the order is that of whole boxes: of those that are as far
away as each other, the hits are compared, too.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints
from ...geometry.poses import dot
from ...scene.rig import Sensor
from ..boxes import BodyParts, PlacedBoxes
from ..kernels import ObjectKernel, ObjectView
from .beams import BeamCache
from .box_hits import BoxTester, FanBeams, box_windows, candidate_hits, concatenated
from .definition import BoxHits, counts_in_bands, first_of_scene, with_returns
from .fan_runs import ChannelRuns, Fan, RotatedFan, RunBlock, fans_of
from .lattice import lattice_of
from .model import ROAD, lidar_of
from .planar_clip import PlanarBoxes, TiltedBoxes, tilted_runs, upright_runs
from .returns import expected_points

Bits = NDArray[np.uint64]
FanBlock = tuple[FanBeams, RunBlock]

MAX_FANS = 16  # With more fans, testing beams one by one is as fast
MAX_SLOPE = 1e3
"""A LiDAR with a steeper channel, along its own axis, has its beams tested one by one."""
WORD = 64
LOW_BITS = np.array([(1 << n) - 1 for n in range(WORD + 1)], np.uint64)
"""Words whose n lowest bits are set, by n."""
WORDS = np.arange(1 << 16, dtype=np.uint16)
BIT_COUNTS = np.unpackbits(WORDS.view(np.uint8)).reshape(-1, 16).sum(axis=1, dtype=np.uint8)
"""Number of set bits of each 16-bit word."""
MIN_GAP_M = 1e-5
"""Boxes nearer to each other than this along a ray are compared beam by beam."""
MIN_INVERSE = 1e-9  # Replaces an inverse distance of 0 or below, of an unsure run [1/m]


class LidarObjects(ObjectKernel):
    """Counts beams that end on objects."""

    def __init__(self, view: ObjectView) -> None:
        self._view = view
        self.cache = BeamCache(view.vehicle)

    def measure(self, sensor: Sensor) -> Floats:
        """Count the beams (N,) that end on each object; equal to the definition."""
        lidar = lidar_of(sensor)
        objects = self._view.objects
        scenes = objects.scenes if self._view.traffic else None
        if lidar.returns == ROAD:
            hits = self.crossings(sensor)
            alone = np.arange(len(objects))
            beams = hits.box, hits.beam, hits.enter
            scenes = alone if scenes is None else scenes
            return expected_points(beams, objects, scenes, lidar.min_range)
        return _count(self._tester(sensor), scenes).astype(float)

    def measure_parts(self, sensor: Sensor, parts: BodyParts) -> Floats:
        """Count the beams that meet cells of bodies (N,) in the band in which they surely end."""
        counts = counts_in_bands(self.crossings(sensor), parts, lidar_of(sensor).min_range)
        return with_returns(sensor, counts, parts.cells.centers, parts.cells)

    def crossings(self, sensor: Sensor) -> BoxHits:
        """Return all hits of beams and objects, whatever is before them."""
        return concatenated(list(candidate_hits(self._tester(sensor))))

    def _tester(self, sensor: Sensor) -> BoxTester:
        boxes = PlacedBoxes.of(self._view.objects, sensor.pose.position)
        beams = self.cache.cast(sensor)
        return BoxTester(sensor, boxes, beams.rotated, beams.ends)


def _count(tester: BoxTester, scenes: Ints | None) -> Ints:
    """Count the beams (N,) on all boxes in the fastest way; None for `scenes`: no traffic."""
    fans = fans_of(tester.lidar)
    if len(fans) > MAX_FANS or any(fan.slopes.steepest >= MAX_SLOPE for fan in fans):
        hits = candidate_hits(tester)
        if scenes is None:
            return np.add.reduce([tester.count(part) for part in hits])
        return tester.count(first_of_scene(concatenated(list(hits)), scenes))
    outside, runs = _runs(tester, fans)
    others = tester.hits_of_all_beams(np.flatnonzero(~outside))
    if scenes is None:
        return tester.count(others) + _count_alone(tester, runs)
    return _count_traffic(tester, runs, others, scenes, unsorted_scenes=np.unique(scenes[~outside]))


def _runs(tester: BoxTester, fans: Sequence[Fan]) -> tuple[Flags, Iterator[FanBlock]]:
    """Return which boxes (N,) the LiDAR is clearly outside of, and all runs through them by fan."""
    lidar = tester.lidar
    boxes = tester.boxes
    step = lidar.azimuth_step
    count = lidar.azimuth_count
    roll, pitch, yaw = tester.sensor.pose.rpy
    if roll == 0.0 and pitch == 0.0:
        planar = PlanarBoxes.of(boxes)
        outside = planar.beside
        distance = planar.distance
        among = outside

        def blocks_of(fan: Fan) -> Iterator[RunBlock]:
            return upright_runs(RotatedFan.of(fan, yaw, step, count), boxes, planar, which)
    else:
        tilted = TiltedBoxes.of(boxes, tester.sensor.pose.ground_from_sensor)
        outside = tilted.outside
        distance = 1.0 / tilted.near
        windows = box_windows(tester)
        spans = windows.azimuth - windows.half_azimuth, windows.azimuth + windows.half_azimuth
        lowest = lidar.elevations.min()
        highest = lidar.elevations.max()
        among = outside & (windows.low <= highest) & (windows.high >= lowest)

        def blocks_of(fan: Fan) -> Iterator[RunBlock]:
            return tilted_runs(RotatedFan.of(fan, 0.0, step, count), tilted, spans, which)

    which = np.flatnonzero(among & (distance <= lidar.max_range))
    corner = np.abs(boxes.offsets) + boxes.halves
    beyond = np.sqrt(dot(corner, corner)) >= lidar.max_range
    unsure = (distance <= lidar.min_range) | beyond  # out of range in part

    def by_fan() -> Iterator[FanBlock]:
        for fan in fans:
            beams = FanBeams.of(fan, lattice_of(lidar), tester.ends, unsure)
            for block in blocks_of(fan):
                yield beams, block

    return outside, by_fan()


def _count_alone(tester: BoxTester, blocks: Iterator[FanBlock]) -> Ints:
    """Count from blocks of runs, where no box occludes another."""
    counts = np.zeros(len(tester.boxes.offsets), np.int64)
    unchecked: dict[int, tuple[FanBeams, list[ChannelRuns]]] = {}
    for fan, block in blocks:
        needs_check = fan.needs_check(block)
        number = block.high - block.low
        number[needs_check] = 0
        counts[block.box] += number.sum(axis=0)
        unchecked.setdefault(id(fan), (fan, []))[1].append(block.take(needs_check))
    for fan, parts in unchecked.values():
        runs = fan.existing(ChannelRuns.concatenated(parts))
        decided, occluded = fan.decided(runs)
        np.add.at(counts, runs.box[decided], (runs.high - runs.low - occluded)[decided])
        counts += tester.count(_tested(tester, fan, runs.take(~decided)))
    return counts


def _tested(tester: BoxTester, fan: FanBeams, runs: ChannelRuns) -> BoxHits:
    """Return the hits of runs, beam by beam."""
    hits = fan.hits_of_runs(tester, runs)
    return BoxHits(runs.box[hits.run], hits.beam, hits.enter)


def _count_traffic(
    tester: BoxTester,
    blocks: Iterator[FanBlock],
    others: BoxHits,
    scenes: Ints,
    unsorted_scenes: Ints,
) -> Ints:
    """Count from blocks of runs, where the boxes of a scene occlude each other. `scenes` (N,) holds
    the scene of each box. `others` are hits of boxes that have no runs: those above, below or round
    the sensor. Their scenes, `unsorted_scenes`, are compared beam by beam."""
    counts = np.zeros(len(scenes), np.int64)
    hits = [others]
    traffic = dict[int, tuple[FanBeams, list[ChannelRuns]]]()
    for fan, block in blocks:
        runs = fan.existing(block.take(block.unsure | (block.low < block.high)))
        traffic.setdefault(id(fan), (fan, []))[1].append(runs)
    for fan, parts in traffic.values():
        runs = ChannelRuns.concatenated(parts)
        in_unsorted = np.isin(scenes[runs.box], unsorted_scenes)
        undecided = _count_sorted(tester, fan, runs, scenes, in_unsorted=in_unsorted, counts=counts)
        hits.append(_tested(tester, fan, runs.take(undecided)))
    return counts + tester.count(first_of_scene(concatenated(hits), scenes))


def _count_sorted(
    tester: BoxTester,
    fan: FanBeams,
    runs: ChannelRuns,
    scenes: Ints,
    in_unsorted: Flags,
    counts: Ints,
) -> Flags:
    """Add the beams of one fan on the boxes of all scenes to counts (N,), nearest box first.

    Returns the runs (R,) whose hits are still to be compared: those `in_unsorted` scenes, and those
    on rays along which the order of boxes is unsure. Fast because the beams of a box at one azimuth
    are the bits of a few words.
    """
    bits, countable = _bits(tester, fan, runs)
    ray = scenes[runs.box] * len(fan.position) + runs.column
    max_range = tester.lidar.max_range  # no beam ends beyond
    distance = np.minimum(1.0 / np.maximum(runs.near, MIN_INVERSE), max_range)
    order = np.argsort(ray + distance / (max_range + 1.0))
    nearer = order[:-1]
    farther = order[1:]
    with np.errstate(divide="ignore"):  # of unsure runs
        separate = 1.0 / runs.far[nearer] + MIN_GAP_M < 1.0 / runs.near[farther]
    separate &= ~(runs.unsure[nearer] | runs.unsure[farther])
    unsure_rays = ray[nearer[(ray[nearer] == ray[farther]) & ~separate]]
    undecided: Flags = np.isin(ray, unsure_rays) | in_unsorted
    sorted_runs = order[~undecided[order]]
    visible = _not_taken_before(ray[sorted_runs], bits[sorted_runs]) & countable[sorted_runs]
    parts = np.ascontiguousarray(visible).view(np.uint16)
    np.add.at(counts, runs.box[sorted_runs], BIT_COUNTS[parts].sum(axis=1, dtype=np.int64))
    return undecided


def _bits(tester: BoxTester, fan: FanBeams, runs: ChannelRuns) -> tuple[Bits, Bits]:
    """Bits (R, W) of the beams that hit a run's box, and of those beyond the minimum range."""
    words = -(-len(fan.first) // WORD)
    first = np.arange(words) * WORD
    ends = (np.clip(n[:, None] - first, 0, WORD) for n in (runs.low.astype(np.int64), runs.high))
    below_low, below_high = (LOW_BITS[n] for n in ends)
    bits = below_high & ~below_low
    if fan.occlusion is not None:
        bits &= ~_packed(fan.occlusion.flags, words)[runs.column]
    tested = np.flatnonzero(~fan.decided(runs)[0])
    countable = bits.copy()
    hits = fan.hits_of_runs(tester, runs.take(tested))
    in_range = hits.enter >= tester.lidar.min_range
    for target, some in ((bits, slice(None)), (countable, in_range)):
        flags = np.zeros((len(tested), len(fan.first)), bool)
        flags[hits.run[some], hits.channel[some]] = True
        target[tested] = _packed(flags, words)
    return bits, countable


def _packed(flags: Flags, words: int) -> Bits:
    """Pack flags (R, C) into words (R, W)."""
    padded = np.zeros((len(flags), words * WORD), bool)
    padded[:, : flags.shape[1]] = flags
    return np.packbits(padded, axis=1, bitorder="little").view("<u8").astype(np.uint64)


def _not_taken_before(ray: Ints, bits: Bits) -> Bits:
    """Bits (R, W) that no earlier run of the same ray has; rays ascend."""
    starts = np.flatnonzero(np.diff(ray, prepend=-1))
    sizes = np.diff(starts, append=len(ray))
    taken = bits[starts].copy()
    visible = bits.copy()
    for rank in range(1, int(sizes.max(initial=0))):
        longer = np.flatnonzero(sizes > rank)
        run = starts[longer] + rank
        visible[run] &= ~taken[longer]
        taken[longer] |= bits[run]
    return visible

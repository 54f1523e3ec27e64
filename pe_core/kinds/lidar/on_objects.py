"""LiDARs on objects that stay while sensors move.

An upright LiDAR's beams are taken azimuth by azimuth (`object_runs`); what rounding, the range, or
a part of the vehicle that is not before the box for sure could decide has its beams tested one by
one, as the definition does. So is a tilted LiDAR (`tilted_runs`), but for traffic: there, and of
one with too many fans, all beams that may meet a box are tested.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np
from numpy.typing import NDArray

from ...scene.sensors import Sensor
from ..object_kernel import ObjectKernel, ObjectView
from ..placed_boxes import PlacedBoxes
from .box_beams import BoxBeams, joined
from .box_windows import azimuth_spans, candidate_hits
from .fan_beams import FanBeams
from .fans import fans_of
from .from_above import BoxesFromAbove
from .known import KnownBeams
from .lattice import lattice_of
from .nearest_hits import nearest_hits
from .object_definition import BoxHits
from .object_runs import ChannelRuns, RunBlock, TurnedFan
from .tilted_runs import TiltedBoxes, tilted_runs
from .traffic import FanTraffic

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

MOST_FANS = 16
"""With more, testing one by one is as fast."""
STEEPEST = 1e3
"""A LiDAR with a beam along its own axis has all tested one by one."""


class LidarObjects(ObjectKernel):
    """Counts beams that end on objects."""

    def __init__(self, view: ObjectView) -> None:
        self._view, self._known = view, KnownBeams(view.vehicle)

    def measure(self, sensor: Sensor) -> Floats:
        """Count the beams that end on each object, as the definition does."""
        known, view = self._known, self._view
        boxes = PlacedBoxes.of(view.objects, sensor.pose.position)
        ends = known.ended(sensor, draft=False).ends
        beams = BoxBeams(sensor, boxes, known.turned(sensor), ends)
        scenes = view.objects.scenes if view.traffic else None
        return _counts(beams, scenes).astype(float)

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        self._known.forget_all_but(sensors)


def _counts(beams: BoxBeams, scenes: Ints | None) -> Ints:
    """Count beams on all boxes the quickest way there is."""
    fans = fans_of(beams.lidar)
    few = len(fans) <= MOST_FANS and all(fan.slopes.steepest < STEEPEST for fan in fans)
    roll, pitch, _ = beams.sensor.pose.rpy
    if few and roll == 0.0 and pitch == 0.0:
        seen = BoxesFromAbove.of(beams.boxes)
        over = beams.all_hits(np.flatnonzero(~seen.beside))
        if scenes is None:
            return beams.counted(over) + _alone(beams, _blocks(beams, seen))
        return _in_traffic(beams, seen, over, scenes)
    if few and scenes is None:
        tilted = TiltedBoxes.of(beams.boxes, beams.sensor.pose.ground_from_sensor)
        within = beams.all_hits(np.flatnonzero(~tilted.outside))
        return beams.counted(within) + _alone(beams, _tilted_blocks(beams, tilted))
    return _one_by_one(beams, scenes)


def _one_by_one(beams: BoxBeams, scenes: Ints | None) -> Ints:
    """Count beams by testing all that may meet a box."""
    found = candidate_hits(beams)
    if scenes is None:
        return np.add.reduce([beams.counted(hits) for hits in found])
    return beams.counted(nearest_hits(joined(list(found)), scenes, beams.lidar.beam_count))


def _alone(beams: BoxBeams, blocks: Iterator[tuple[FanBeams, RunBlock]]) -> Ints:
    """Count beams on boxes whose runs are known, where none hides another."""
    counts = np.zeros(len(beams.boxes.offsets), np.int64)
    left: dict[int, tuple[FanBeams, list[ChannelRuns]]] = {}
    for fan, block in blocks:
        asked, number = fan.asked(block), block.high - block.low
        number[asked] = 0
        counts[block.item] += number.sum(axis=0)
        left.setdefault(id(fan), (fan, []))[1].append(block.some(asked))
    for fan, several in left.values():
        runs = fan.existing(ChannelRuns.joined(several))
        known, stopped = fan.settled(runs)
        np.add.at(counts, runs.item[known], (runs.high - runs.low - stopped)[known])
        runs = runs.some(~known)
        hits = fan.tested(beams, runs)
        counts += beams.counted(BoxHits(runs.item[hits.run], hits.beam, hits.enter))
    return counts


def _in_traffic(beams: BoxBeams, seen: BoxesFromAbove, over: BoxHits, scenes: Ints) -> Ints:
    """Count beams where boxes of a scene hide each other; `over` are hits of boxes not beside."""
    counts = np.zeros(len(scenes), np.int64)
    hits, tangled = [over], np.unique(scenes[~seen.beside])
    traffic: dict[int, FanTraffic] = {}
    for fan, block in _blocks(beams, seen):
        own = traffic.setdefault(id(fan), FanTraffic(beams, fan, scenes, tangled))
        own.add(fan.existing(block.some(block.unsure | (block.low < block.high))))
    for own in traffic.values():
        found, unclear = own.count()
        counts += found
        hits.append(unclear)
    return counts + beams.counted(nearest_hits(joined(hits), scenes, beams.lidar.beam_count))


def _blocks(beams: BoxBeams, seen: BoxesFromAbove) -> Iterator[tuple[FanBeams, RunBlock]]:
    """Yield runs of channels through all boxes that the LiDAR is beside, fan by fan."""
    lidar, yaw = beams.lidar, beams.sensor.pose.rpy[2]
    which = np.flatnonzero(seen.beside & (seen.distance <= lidar.max_range))
    unclear = (seen.distance <= lidar.min_range) | (beams.reach() >= lidar.max_range)
    for fan in fans_of(lidar):
        own = FanBeams.of(fan, lattice_of(lidar), beams.ends, unclear)
        turned = TurnedFan.of(fan, yaw, lidar.azimuth_step, lidar.azimuth_count)
        for block in turned.runs(beams.boxes, seen, which):
            yield own, block


def _tilted_blocks(beams: BoxBeams, seen: TiltedBoxes) -> Iterator[tuple[FanBeams, RunBlock]]:
    """Yield runs of channels of a tilted LiDAR through all boxes that it is not in."""
    lidar, distance = beams.lidar, 1.0 / seen.near
    which = np.flatnonzero(seen.outside & (distance <= lidar.max_range))
    unclear = (distance <= lidar.min_range) | (beams.reach() >= lidar.max_range)
    spans = azimuth_spans(beams)
    for fan in fans_of(lidar):
        own = FanBeams.of(fan, lattice_of(lidar), beams.ends, unclear)
        turned = TurnedFan.of(fan, 0.0, lidar.azimuth_step, lidar.azimuth_count)
        for block in tilted_runs(turned, seen, spans, which):
            yield own, block

"""LiDARs on objects that stay while sensors move.

An upright LiDAR's beams are taken azimuth by azimuth (`object_runs`); what rounding, the range, or
a part of the vehicle that is not before the box for sure could decide has its beams tested one by
one, as the definition does. So have all boxes of a LiDAR that is tilted, or has too many fans.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.sensors import Sensor
from ..object_kernel import ObjectKernel, ObjectView
from ..placed_boxes import PlacedBoxes
from .box_beams import BoxBeams, joined
from .box_windows import candidate_hits
from .fan_beams import FanBeams
from .fans import fans_of
from .from_above import BoxesFromAbove
from .known import KnownBeams
from .lattice import lattice_of
from .model import Lidar
from .object_definition import BoxHits, first_of_scene
from .object_runs import ChannelRuns, RunBlock, TurnedFan
from .traffic import FanTraffic

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

MOST_FANS = 16
"""With more, testing one by one is as fast."""


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
        counts = _by_fans(beams, scenes) if _is_upright(sensor) else _one_by_one(beams, scenes)
        return counts.astype(float)

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        self._known.forget_all_but(sensors)


def _is_upright(sensor: Sensor) -> bool:
    roll, pitch, _ = sensor.pose.rpy
    return roll == 0.0 and pitch == 0.0 and len(fans_of(cast(Lidar, sensor.model))) <= MOST_FANS


def _one_by_one(beams: BoxBeams, scenes: Ints | None) -> Ints:
    """Count beams by testing all that may meet a box."""
    found = candidate_hits(beams)
    if scenes is None:
        return np.add.reduce([beams.counted(hits) for hits in found])
    return beams.counted(first_of_scene(joined(list(found)), scenes))


def _by_fans(beams: BoxBeams, scenes: Ints | None) -> Ints:
    """Count beams of an upright LiDAR."""
    seen = BoxesFromAbove.of(beams.boxes)
    over = beams.all_hits(np.flatnonzero(~seen.beside))
    if scenes is None:
        return beams.counted(over) + _alone(beams, seen)
    return _in_traffic(beams, seen, over, scenes)


def _alone(beams: BoxBeams, seen: BoxesFromAbove) -> Ints:
    """Count beams on boxes that the LiDAR is beside, where none hides another."""
    counts = np.zeros(len(seen.beside), np.int64)
    left: dict[int, tuple[FanBeams, list[ChannelRuns]]] = {}
    for fan, block in _blocks(beams, seen):
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
    return counts + beams.counted(first_of_scene(joined(hits), scenes))


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

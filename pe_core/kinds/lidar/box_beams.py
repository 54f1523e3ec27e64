"""A LiDAR's beams and boxes round it: pairs of them tested as the definition does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot
from ...scene.numbering import blocks
from ...scene.sensors import Sensor
from ..placed_boxes import PlacedBoxes
from .beams import TurnedBeams
from .ends import AnyEnds
from .model import Lidar
from .object_definition import BoxHits

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PAIRS_AT_ONCE = 1 << 15


@dataclass(frozen=True, slots=True)
class BoxBeams:
    """A mounted LiDAR, the boxes round it, its beams as they are turned, and where they end."""

    sensor: Sensor
    boxes: PlacedBoxes
    turned: TurnedBeams
    ends: AnyEnds

    @property
    def lidar(self) -> Lidar:
        """The intrinsics."""
        return cast(Lidar, self.sensor.model)

    def met(self, item: Ints, beam: Ints) -> tuple[Ints, Floats]:
        """Which of (box, beam) pairs (P,) are hits: the beam enters the box before it ends.

        Returns their numbers (H,) and where they enter [m].
        """
        found = []
        for some in blocks(len(item), PAIRS_AT_ONCE):
            at, enter = self._met(item[some], beam[some])
            found.append((at + some.start, enter))
        if not found:
            return np.zeros(0, np.int64), np.zeros(0)
        at, enter = (np.concatenate(w) for w in zip(*found, strict=True))
        return at, enter

    def hits(self, item: Ints, beam: Ints) -> BoxHits:
        """Return those of (box, beam) pairs that are hits."""
        at, enter = self.met(item, beam)
        return BoxHits(item[at], beam[at], enter)

    def all_hits(self, which: Ints) -> BoxHits:
        """Return the hits of some boxes by all beams."""
        count = self.lidar.beam_count
        return joined([self.hits(np.full(count, one), np.arange(count)) for one in which.tolist()])

    def counted(self, hits: BoxHits) -> Ints:
        """(N,) hits of each box, no nearer than the minimum range."""
        far = hits.enter >= self.lidar.min_range
        return np.bincount(hits.item[far], minlength=len(self.boxes.offsets))

    def reach(self) -> Floats:
        """(N,) distances of boxes' farthest corners, or more [m]."""
        far = np.abs(self.boxes.offsets) + self.boxes.halves
        return np.asarray(np.sqrt(dot(far, far)))

    def _met(self, item: Ints, beam: Ints) -> tuple[Ints, Floats]:
        enter, leave = self.boxes.crossing(item, self.turned.some(beam))
        at = np.flatnonzero((enter < leave) & (enter <= self.lidar.max_range))
        beam, enter = beam[at], enter[at]
        stopped = np.flatnonzero(self.ends.stopped[beam])
        if len(stopped):
            kept = np.ones(len(at), bool)
            kept[stopped] = enter[stopped] <= self.ends.some(beam[stopped])
            at, enter = at[kept], enter[kept]
        return at, enter


def joined(found: list[BoxHits]) -> BoxHits:
    """Return hits in one."""
    if not found:
        return BoxHits(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))
    item, beam = (np.concatenate([getattr(h, key) for h in found]) for key in ("item", "beam"))
    return BoxHits(item, beam, np.concatenate([h.enter for h in found]))

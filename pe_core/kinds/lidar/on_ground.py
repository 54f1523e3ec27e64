"""LiDARs and what stands on the ground: beams seen from above, as far as they are low enough.

A beam meets a post that is h tall where it is between the ground and h. Seen from above that is a
piece of a straight line, which ends earlier where the vehicle or the range ends the beam. Squares
are marked that points of this line lie in: both of its ends, and others between.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.ground_grid import GroundGrid
from ...scene.numbering import count_up
from ...scene.sensors import Sensor
from ..ground_kernel import Flags, GroundKernel, GroundView, VisibleGround
from .known import KnownBeams
from .model import Lidar

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

APART_M, MOST_APART_M = 0.05, 0.15
"""Points of a line are so far apart; farther where there are more than `MOST_POINTS`."""
MOST_POINTS = 2_000_000
SAME_WAY = 1e11
"""Lines whose directions agree to this many parts are one behind the other."""
SHORTEST = 1e-9
"""Stands for the length of a beam that is a point from above."""
FARTHEST_M = 1e6
"""No line is longer."""


class LidarGround(GroundKernel):
    """Marks squares under the low parts of beams."""

    def __init__(self, view: GroundView) -> None:
        self._view = view
        self.known = KnownBeams(view.vehicle)

    def see(self, sensor: Sensor, draft: bool) -> VisibleGround:
        """Follow beams between the ground and the posts' height; a draft has quick ends."""
        ended, turned = self.known.ended(sensor, draft), self.known.turned(sensor)
        speeds = turned.speeds(np.arange(cast(Lidar, sensor.model).beam_count))
        first, last = self._low_parts(sensor, speeds)
        beams = np.flatnonzero(first <= last)
        asked = beams[ended.ends.stopped[beams]]
        last[asked] = np.minimum(last[asked], ended.ends.some(asked))
        beams = beams[first[beams] <= last[beams]]
        x, y, first, last = merged(*(w[beams] for w in (*speeds[:2], first, last)))
        lines = GroundLines.of(self._view.grid, sensor.pose.position, (x, y), first, last)
        return VisibleGround(sensor, _under_lines(self._view.grid, lines), ended.is_draft)

    def share(self, known: KnownBeams) -> None:
        """Use beams that other kernels know as well."""
        self.known = known

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        self.known.forget_all_but(sensors)

    def _low_parts(self, sensor: Sensor, speeds: list[Floats]) -> tuple[Floats, Floats]:
        """Distances (B,) between which beams are low enough, over the grid and in range [m]."""
        lidar, grid = cast(Lidar, sensor.model), self._view.grid
        first = np.full(lidar.beam_count, lidar.min_range)
        last = np.full(lidar.beam_count, lidar.max_range)
        low, high = (*grid.origin, 0.0), (*grid.end, self._view.height)
        for speed, at, a, b in zip(speeds, sensor.pose.position, low, high, strict=True):
            t0, t1 = (a - at) / speed, (b - at) / speed
            np.maximum(first, np.minimum(t0, t1), out=first)
            np.minimum(last, np.maximum(t0, t1), out=last)
        return first, last


def merged(x: Floats, y: Floats, first: Floats, last: Floats) -> tuple[Floats, ...]:
    """Join lines that overlap: channels of one azimuth of an upright LiDAR.

    Lines (L,) lead from one point along (x, y), from `first` to `last` times that. Returned are
    fewer such lines, along unit vectors.
    """
    length = np.maximum(np.sqrt(x * x + y * y), SHORTEST)
    x, y, first, last = x / length, y / length, first * length, last * length
    turned = y / (np.abs(x) + np.abs(y))  # rises with the azimuth, ahead of the LiDAR
    way = np.round(np.where(x < 0.0, 2.0 - turned, turned) * SAME_WAY)
    order = np.lexsort((first, way))
    x, y, first, last, way = (w[order] for w in (x, y, first, last, way))
    turn = np.cumsum(np.diff(way, prepend=way[:1]) != 0.0) * FARTHEST_M
    farthest = np.maximum.accumulate(last + turn)
    begins = np.ones(len(x), bool)
    begins[1:] = first[1:] + turn[1:] > farthest[:-1]
    begins = np.flatnonzero(begins)
    if not len(begins):
        return x, y, first, last
    return x[begins], y[begins], first[begins], np.maximum.reduceat(last, begins)


@dataclass(frozen=True, slots=True)
class GroundLines:
    """Straight lines seen from above: where they start, and where they lead from there, in squares.

    `x`, `y`, `dx`, `dy`: (L,) each, from the lowest corner of a grid.
    """

    x: Floats
    y: Floats
    dx: Floats
    dy: Floats

    @classmethod
    def of(
        cls,
        grid: GroundGrid,
        position: tuple[float, float, float],
        speeds: tuple[Floats, Floats],
        first: Floats,
        last: Floats,
    ) -> GroundLines:
        """Take what beams from a position cover from `first` to `last` (L,) [m]."""
        start, way = [], []
        for at, low, speed in zip(position, grid.origin, speeds, strict=False):
            start.append((at - low + speed * first) / grid.step)
            way.append(speed * (last - first) / grid.step)
        return cls(*start, *way)

    @property
    def length(self) -> float:
        """Of all together, in squares."""
        return float(np.sqrt(self.dx * self.dx + self.dy * self.dy).sum())

    def cut(self, apart: float) -> GroundLines:
        """Cut each line into pieces of equal length, at most `apart` squares long."""
        pieces = np.ceil(np.sqrt(self.dx * self.dx + self.dy * self.dy) / apart).astype(np.int64)
        pieces = np.maximum(pieces, 1)
        dx, dy = (np.repeat(w / pieces, pieces) for w in (self.dx, self.dy))
        number = count_up(pieces)
        return GroundLines(
            np.repeat(self.x, pieces) + number * dx, np.repeat(self.y, pieces) + number * dy, dx, dy
        )

    def squares(self, share: float, shape: tuple[int, int]) -> Ints:
        """(L,) number of the square that each line is in after a share of its way."""
        i, j = (
            np.minimum((w + share * dw).astype(np.int32), n - 1)
            for w, dw, n in ((self.x, self.dx, shape[0]), (self.y, self.dy, shape[1]))
        )
        return np.asarray(i * shape[1] + j)


def _under_lines(grid: GroundGrid, lines: GroundLines) -> Flags:
    """Mark squares (NX, NY) under points of lines."""
    marked = np.zeros(grid.shape, bool)
    flat = marked.reshape(-1)
    apart = np.clip(lines.length / MOST_POINTS, APART_M / grid.step, MOST_APART_M / grid.step)
    flat[lines.cut(float(apart)).squares(0.0, grid.shape)] = True
    flat[lines.squares(1.0, grid.shape)] = True
    return marked

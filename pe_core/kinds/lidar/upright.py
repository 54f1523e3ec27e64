"""Beams through single voxels by an upright LiDAR: each azimuth's cut through the voxel by itself.

A LiDAR that stands upright (no roll, no pitch, any yaw) has all channels of an azimuth in one
vertical plane. Seen from above, the azimuth's ray cuts the voxel's square between two distances,
and the channels that pass are those whose slope lies between two quotients of height and distance:
two look-ups in a table. Azimuths are counted from the axis next to the voxel, in a frame folded
into the first quadrant, so that small angles keep all their digits.

All in single precision. Where rounding could decide, or the count is large, the voxel is said to be
unsure, and left to the exact test in `lidar_points`: a few in a hundred.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .model import Lidar

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Indices = NDArray[np.intp]
Small = NDArray[np.int16]
Counts = NDArray[np.int32]
Flags = NDArray[np.bool_]

BINS = 1 << 17
MARGIN = np.float32(2e-6)
"""Relative rounding of a slope or an angle in single precision, with room to spare."""
AT_ONCE = 1 << 15
"""Voxels worked on together: their arrays fit the cache."""
MOST_AZIMUTHS = 10
"""A voxel that more azimuths meet stands near the sensor, and is left to `lidar_bracket`."""
TOO_NEAR = np.float32(4.0)
"""So is one that is not farther from the axis than this, in sides."""
REACH = 2.0
"""A voxel farther than this beyond where a stopped beam ends is not met by it, in sides."""
NO_TURN = 1e-9
"""A yaw nearer than this to a whole number of azimuth steps is one."""


@dataclass(frozen=True, slots=True)
class SlopeTable:
    """A regular LiDAR's channels by slope.

    `below` holds, for each bin of slopes, twice the number of channels below it, plus 1 where a
    channel may lie in the bin. A bin begins at slope 0, and a slope's sign is always right, so the
    horizontal channel is in no bin.
    """

    azimuth_count: int
    scale: np.float32
    first: int
    below: Small

    @classmethod
    def of(cls, lidar: Lidar) -> SlopeTable | None:
        """Make the table, of elevations' tangents; None for a LiDAR this kernel is not for."""
        limit = math.radians(80.0)
        if lidar.azimuth_count % 2 or np.abs(lidar.elevations).max() > limit:
            return None
        slopes = np.array([math.tan(e) for e in np.sort(lidar.elevations).tolist()])
        scale = float(np.float32(BINS / (slopes[-1] - slopes[0] + 0.01)))
        first = math.floor(slopes[0] * scale) - 2
        edges = np.arange(first, math.floor(slopes[-1] * scale) + 4) / scale
        slack = float(MARGIN) * np.abs(edges)
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        upto[edges[1:] == 0.0] = np.searchsorted(slopes, 0.0, side="left")
        below[edges[:-1] == 0.0] = np.searchsorted(slopes, 0.0, side="right")
        table = (2 * below + (upto > below)).astype(np.int16)
        return cls(lidar.azimuth_count, np.float32(scale), first, table)

    def look_up(self, slopes: Singles) -> Small:
        """`below` of each slope."""
        slopes *= self.scale
        bins = np.floor(slopes, out=slopes).astype(np.intp)
        bins -= self.first
        return np.take(self.below, bins, mode="clip")


@dataclass(frozen=True, slots=True)
class Circle:
    """The azimuths of a LiDAR turned by `rest` of a step: reciprocals of cosine and sine.

    Entry j is at azimuth ``j - 2 * count``: two turns below to two above, so no index wraps.
    """

    rest: float
    per_x: Singles
    per_y: Singles


@lru_cache(maxsize=16)
def circle(count: int, rest: float) -> Circle:
    """Tabulate `count` azimuths."""
    angles = [(j + rest) * (2.0 * math.pi / count) for j in range(count)]
    per_x = np.array([1.0 / (math.cos(a) or 1e-30) for a in angles], np.float32)
    per_y = np.array([1.0 / (math.sin(a) or 1e-30) for a in angles], np.float32)
    return Circle(rest, np.tile(per_x, 4), np.tile(per_y, 4))


@dataclass(frozen=True, slots=True)
class Stops:
    """Beams that end on the vehicle.

    `free` (A, C + 1) counts, at each ground azimuth, the beams that do not among the lowest
    channels; channels from `above` on are all free; `reach` is the farthest end, in sides.
    """

    free: Small
    above: int
    reach: float

    @classmethod
    def of(cls, stopped: Flags, farthest: float, yaw_steps: int) -> Stops | None:
        """Sum up (C, A) flags, lowest channel first; None where nothing is stopped."""
        rows = np.flatnonzero(stopped.any(axis=1))
        if not len(rows):
            return None
        free = np.zeros((stopped.shape[1], stopped.shape[0] + 1), np.int16)
        np.cumsum(~np.roll(stopped, yaw_steps, axis=1).T, axis=1, out=free[:, 1:])
        return cls(free, int(rows[-1]) + 1, farthest + REACH)


@dataclass(frozen=True, slots=True)
class Cubes:
    """Lower and upper faces of voxels along each axis, seen from the sensor, in sides.

    Right to their last digit, however near: ties are decided by how little a face is off.
    """

    x0: Singles
    x1: Singles
    y0: Singles
    y1: Singles
    z0: Singles
    z1: Singles

    @classmethod
    def of(cls, corners: Sequence[Singles], position: Floats) -> Cubes:
        """See lower corners, whole sides from the grid's corner, from a position there."""
        faces = []
        for corner, place in zip(corners, position.tolist(), strict=True):
            whole = round(place)
            lower = corner - np.float32(whole)  # exact
            upper = lower + np.float32(1.0)
            lower -= np.float32(place - whole)
            upper -= np.float32(place - whole)
            faces += [lower, upper]
        return cls(*faces)

    def some(self, which: slice) -> Cubes:
        """Return some of the voxels."""
        x0, x1, y0, y1, z0, z1 = self.x0, self.x1, self.y0, self.y1, self.z0, self.z1
        return Cubes(x0[which], x1[which], y0[which], y1[which], z0[which], z1[which])


@dataclass(frozen=True, slots=True)
class Azimuths:
    """Azimuths that meet voxels: ``entry + turn * n``, entries of `Circle`, for n below `left`."""

    entry: Singles
    turn: Singles
    left: Singles

    def some(self, which: slice | Indices) -> Azimuths:
        """Return those of some voxels."""
        return Azimuths(self.entry[which], self.turn[which], self.left[which])

    @classmethod
    def joined(cls, parts: Sequence[Azimuths]) -> Azimuths:
        """Put the parts in a row."""
        columns = zip(*((p.entry, p.turn, p.left) for p in parts), strict=True)
        return cls(*(np.concatenate(column) for column in columns))


@dataclass(frozen=True, slots=True)
class Upright:
    """A LiDAR that stands upright: its tables and what stops its beams."""

    table: SlopeTable
    circle: Circle
    stops: Stops | None

    @classmethod
    def of(
        cls, table: SlopeTable, ground_from_sensor: Floats, stopped: Flags, farthest: float
    ) -> Upright:
        """Make ready for an upright orientation and stopped beams (C, A), lowest channel first."""
        yaw = math.atan2(ground_from_sensor[1, 0], ground_from_sensor[0, 0])
        steps = yaw * table.azimuth_count / (2.0 * math.pi)
        rest = steps - round(steps)
        if abs(rest) < NO_TURN:
            rest = 0.0
        stops = Stops.of(stopped, farthest, round(steps))
        return cls(table, circle(table.azimuth_count, rest), stops)

    def count(self, corners: Sequence[Singles], position: Floats) -> tuple[Counts, Flags]:
        """Count the beams through unit cubes.

        Parameters
        ----------
        corners : three (V,) float32
            Lower corners of the cubes, whole numbers.
        position : (3,) float
            The sensor, in the same frame (`ties.position_in_voxels`).

        Returns
        -------
        counts : (V,) int32
        unsure : (V,) bool
            Where the count is to be taken from elsewhere.
        """
        total = len(corners[0])
        counts, unsure = np.empty(total, np.int32), np.empty(total, bool)
        with np.errstate(all="ignore"):  # of voxels that turn out unsure
            later: list[tuple[Indices, Azimuths]] = []
            for some in _blocks(total):
                cubes = Cubes.of([c[some] for c in corners], position)
                azimuths, doubt = self._window(cubes)
                found, unclear = self._passing(cubes, azimuths.entry)
                np.multiply(found, azimuths.left > 0, out=counts[some])
                np.logical_or(doubt, unclear, out=unsure[some])
                more = np.flatnonzero((azimuths.left > 1) & ~unsure[some])
                later.append((more + some.start, azimuths.some(more)))
            azimuths = Azimuths.joined([a for _, a in later])
            order = np.argsort((MOST_AZIMUTHS - azimuths.left).astype(np.int8), kind="stable")
            voxel = np.concatenate([v for v, _ in later])[order]
            cubes = Cubes.of([c[voxel] for c in corners], position)
            more_found, doubt = self._others(cubes, azimuths.some(order))
        counts[voxel] += more_found
        unsure[voxel] = doubt
        return counts, unsure

    def _others(self, cubes: Cubes, azimuths: Azimuths) -> tuple[Counts, Flags]:
        """Count at the second azimuth and all further ones; voxels with the most come first."""
        counts, unsure = np.zeros(len(cubes.x0), np.int32), np.zeros(len(cubes.x0), bool)
        having = np.bincount(azimuths.left.astype(np.intp), minlength=MOST_AZIMUTHS + 1)
        for n in range(2, MOST_AZIMUTHS + 1):
            for some in _blocks(int(having[n:].sum())):
                own = azimuths.some(some)
                np.add(own.entry, own.turn, out=own.entry)
                found, doubt = self._passing(cubes.some(some), own.entry)
                counts[some] += found
                unsure[some] |= doubt
        return counts, unsure

    def _window(self, cubes: Cubes) -> tuple[Azimuths, Flags]:
        """Find the azimuths that meet each square, by its outermost corners; say where unsure."""
        behind = cubes.x1 < -cubes.x0
        turn = np.multiply(behind ^ (cubes.y1 < -cubes.y0), np.float32(-2.0))
        turn += np.float32(1.0)
        low, high, unsure = _corner_angles(cubes)
        count = self.table.azimuth_count
        per_radian = np.float32(count / (2.0 * math.pi))
        low *= per_radian
        high *= per_radian
        rest = np.float32(self.circle.rest)
        if rest:
            low -= turn * rest
            high -= turn * rest
        for angle in (low, high):
            room = np.abs(angle)
            if rest:
                room += np.float32(2.0)
            room *= MARGIN
            off = np.rint(angle)
            off -= angle
            np.abs(off, out=off)
            unsure |= off <= room
        np.ceil(low, out=low)
        left = np.floor(high, out=high)
        left -= low
        left += np.float32(1.0)
        unsure |= left > MOST_AZIMUTHS
        low *= turn
        entry = np.multiply(behind, np.float32(count // 2))
        entry += np.float32(2 * count)
        entry += low
        return Azimuths(entry, turn, left), unsure

    def _passing(self, cubes: Cubes, entry: Singles) -> tuple[Small, Flags]:
        """Count the channels of one azimuth a voxel that pass it, and say where that is unsure."""
        at = entry.astype(np.intp)
        per = np.take(self.circle.per_x, at, mode="clip")
        a, b = cubes.x0 * per, cubes.x1 * per
        np.take(self.circle.per_y, at, mode="clip", out=per)
        c, d = cubes.y0 * per, cubes.y1 * per
        enter = np.minimum(c, d, out=per)
        np.maximum(enter, np.minimum(a, b), out=enter)
        leave = np.maximum(c, d, out=c)
        np.minimum(leave, np.maximum(a, b), out=leave)
        near = np.divide(np.float32(1.0), enter, out=a)
        far = np.divide(np.float32(1.0), leave, out=leave)
        low = self.table.look_up(np.minimum(cubes.z0 * near, cubes.z0 * far, out=b))
        high = self.table.look_up(np.maximum(cubes.z1 * near, cubes.z1 * far, out=b))
        unsure: Flags = ((low | high) & 1).astype(bool)
        low >>= 1
        high >>= 1
        found = high - low
        if self.stops is not None:
            self._stop(self.stops, at, enter, low, high, found, unsure)
        return found, unsure

    def _stop(
        self,
        stops: Stops,
        at: Indices,
        enter: Singles,
        low: Small,
        high: Small,
        found: Small,
        unsure: Flags,
    ) -> None:
        """Take off the stopped beams; a voxel no farther than they reach is unsure."""
        some = np.flatnonzero((low < stops.above) & (found > 0))
        row = (at[some] % self.table.azimuth_count) * stops.free.shape[1]
        free = np.take(stops.free, row + high[some]) - np.take(stops.free, row + low[some])
        unsure[some] |= (free != found[some]) & (enter[some] < stops.reach)
        found[some] = free


def _corner_angles(cubes: Cubes) -> tuple[Singles, Singles, Flags]:
    """Angles [rad] of the squares' outermost corners, and which squares are too near.

    The squares are mirrored into the first quadrant; they may stick out of it.
    """
    x0, x1 = np.maximum(cubes.x0, -cubes.x1), np.maximum(cubes.x1, -cubes.x0)
    y0, y1 = np.maximum(cubes.y0, -cubes.y1), np.maximum(cubes.y1, -cubes.y0)
    near: Flags = np.maximum(x0, y0) <= TOO_NEAR
    np.copyto(x1, x0, where=y0 <= 0)
    np.copyto(y1, y0, where=x0 <= 0)
    return np.arctan2(y0, x1, out=x1), np.arctan2(y1, x0, out=x0), near


def _blocks(total: int) -> Iterator[slice]:
    """Cut a row of voxels into runs of AT_ONCE."""
    for start in range(0, total, AT_ONCE):
        yield slice(start, min(start + AT_ONCE, total))

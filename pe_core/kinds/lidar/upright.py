"""Beams through single voxels by an upright LiDAR: each azimuth's cut through the voxel by itself.

A LiDAR that stands upright (no roll, no pitch, any yaw) has all channels of an azimuth in one
vertical plane. Seen from above, the azimuth's ray cuts the voxel's square between two distances,
and the channels that pass are those whose slope lies between two quotients of height and distance:
two look-ups in a table (`slopes`). Which azimuths meet the square is found first (`azimuths`).

All in single precision. Where rounding could decide, or the count is large, the voxel is said to be
unsure, and left to the exact test in `points`: a few in a hundred. docs/engine.md has a figure, and
a voxel worked by hand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.numbering import blocks
from .azimuths import MOST_AZIMUTHS, Azimuths, Circle, Cubes, circle
from .slopes import SlopeCounts

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Indices = NDArray[np.intp]
Small = NDArray[np.int16]
Counts = NDArray[np.int32]
Flags = NDArray[np.bool_]

AT_ONCE = 1 << 15
"""Voxels worked on together: their arrays fit the cache."""
REACH = 2.0
"""A voxel farther than this beyond where a stopped beam ends is not met by it, in sides."""
NO_TURN = 1e-9
"""A yaw nearer than this to a whole number of azimuth steps is one."""


@dataclass(frozen=True, slots=True)
class Cut:
    """What an azimuth each cuts out of voxels, (V,) each.

    `entry` of `Circle`; the distance over ground where it enters the square, in sides; and how many
    channels are below the lowest and the highest slope inside.
    """

    entry: Indices
    enter: Singles
    below_low: Small
    below_high: Small


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

    def take_off(self, cut: Cut, found: Small, unsure: Flags) -> None:
        """Take stopped beams off what was found; a voxel no farther than they reach is unsure."""
        azimuths, width = self.free.shape
        some = np.flatnonzero((cut.below_low < self.above) & (found > 0))
        row = (cut.entry[some] % azimuths) * width
        free = np.take(self.free, row + cut.below_high[some])
        free -= np.take(self.free, row + cut.below_low[some])
        unsure[some] |= (free != found[some]) & (cut.enter[some] < self.reach)
        found[some] = free


@dataclass(frozen=True, slots=True)
class Upright:
    """A LiDAR that stands upright: its tables and what stops its beams."""

    slopes: SlopeCounts
    circle: Circle
    stops: Stops | None

    @classmethod
    def of(
        cls, slopes: SlopeCounts, ground_from_sensor: Floats, stopped: Flags, farthest: float
    ) -> Upright:
        """Make ready for an upright orientation and stopped beams (C, A), lowest channel first."""
        yaw = math.atan2(ground_from_sensor[1, 0], ground_from_sensor[0, 0])
        steps = yaw * slopes.azimuth_count / (2.0 * math.pi)
        rest = steps - round(steps)
        if abs(rest) < NO_TURN:
            rest = 0.0
        stops = Stops.of(stopped, farthest, round(steps))
        return cls(slopes, circle(slopes.azimuth_count, rest), stops)

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
            for some in blocks(total, AT_ONCE):
                cubes = Cubes.of([c[some] for c in corners], position)
                azimuths, doubt = self.circle.meeting(cubes)
                found, unclear = self._passing(cubes, azimuths.entry)
                np.multiply(found, azimuths.left > 0, out=counts[some])
                np.logical_or(doubt, unclear, out=unsure[some])
                more = np.flatnonzero((azimuths.left > 1) & ~unsure[some])
                later.append((more + some.start, azimuths.some(more)))
            azimuths = Azimuths.of([a for _, a in later])
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
            for some in blocks(int(having[n:].sum()), AT_ONCE):
                own = azimuths.some(some)
                np.add(own.entry, own.turn, out=own.entry)
                found, doubt = self._passing(cubes.some(some), own.entry)
                counts[some] += found
                unsure[some] |= doubt
        return counts, unsure

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
        low = self.slopes.look_up(np.minimum(cubes.z0 * near, cubes.z0 * far, out=b))
        high = self.slopes.look_up(np.maximum(cubes.z1 * near, cubes.z1 * far, out=b))
        unsure: Flags = ((low | high) & 1).astype(bool)
        low >>= 1
        high >>= 1
        found = high - low
        if self.stops is not None:
            self.stops.take_off(Cut(at, enter, low, high), found, unsure)
        return found, unsure

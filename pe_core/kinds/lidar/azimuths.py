"""Which azimuths of an upright LiDAR meet voxels, seen from above.

From above a voxel is a square, and the outermost two of its corners bound the azimuths that meet
it. Azimuths are counted from the axis next to the square, in a frame folded into the first
quadrant, so that small angles keep all their digits. All in single precision; where rounding could
decide, a voxel is said to be unsure.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]

MARGIN = np.float32(2e-6)
"""Relative rounding of an angle in single precision, with room to spare."""
MOST_AZIMUTHS = 10
"""A voxel that more azimuths meet stands near the sensor, and is left to `bracket`."""
TOO_NEAR = np.float32(4.0)
"""So is one that is not farther from the axis than this, in sides."""
CIRCLES_KEPT = 16
"""Circles kept, by their number of azimuths and the rest of a step: one a model and yaw."""


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

    @classmethod
    def of(cls, parts: Sequence[Azimuths]) -> Azimuths:
        """Put parts in a row."""
        columns = zip(*((p.entry, p.turn, p.left) for p in parts), strict=True)
        return cls(*(np.concatenate(column) for column in columns))

    def some(self, which: slice | Indices) -> Azimuths:
        """Return those of some voxels."""
        return Azimuths(self.entry[which], self.turn[which], self.left[which])


@dataclass(frozen=True, slots=True)
class Circle:
    """The azimuths of a LiDAR turned by `rest` of a step: reciprocals of cosine and sine.

    Entry j is at azimuth ``j - 2 * count``: two turns below to two above, so no index wraps.
    """

    count: int
    rest: float
    per_x: Singles
    per_y: Singles

    @classmethod
    def of(cls, count: int, rest: float) -> Circle:
        """Tabulate `count` azimuths."""
        angles = [(j + rest) * (2.0 * math.pi / count) for j in range(count)]
        per_x = np.array([1.0 / (math.cos(a) or 1e-30) for a in angles], np.float32)
        per_y = np.array([1.0 / (math.sin(a) or 1e-30) for a in angles], np.float32)
        return cls(count, rest, np.tile(per_x, 4), np.tile(per_y, 4))

    def meeting(self, cubes: Cubes) -> tuple[Azimuths, Flags]:
        """Find the azimuths that meet each square; and say where that is unsure."""
        behind = cubes.x1 < -cubes.x0
        turn = np.multiply(behind ^ (cubes.y1 < -cubes.y0), np.float32(-2.0))
        turn += np.float32(1.0)
        low, high, unsure = _corner_angles(cubes)
        per_radian = np.float32(self.count / (2.0 * math.pi))
        low *= per_radian
        high *= per_radian
        if self.rest:
            low -= turn * np.float32(self.rest)
            high -= turn * np.float32(self.rest)
        for angle in (low, high):
            unsure |= self._is_close_to_whole(angle)
        np.ceil(low, out=low)
        left = np.floor(high, out=high)
        left -= low
        left += np.float32(1.0)
        unsure |= left > MOST_AZIMUTHS
        low *= turn
        entry = np.multiply(behind, np.float32(self.count // 2))
        entry += np.float32(2 * self.count)
        entry += low
        return Azimuths(entry, turn, left), unsure

    def _is_close_to_whole(self, angle: Singles) -> Flags:
        """Whether angles, in steps, are so close to an azimuth that rounding could decide."""
        room = np.abs(angle)
        if self.rest:
            room += np.float32(2.0)
        room *= MARGIN
        off = np.rint(angle)
        off -= angle
        np.abs(off, out=off)
        close: Flags = off <= room
        return close


@lru_cache(maxsize=CIRCLES_KEPT)
def circle(count: int, rest: float) -> Circle:
    """Return the circle of `count` azimuths and a rest of a step."""
    return Circle.of(count, rest)


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

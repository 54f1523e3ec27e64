"""Beams of an upright LiDAR through single voxels, azimuth by azimuth.

An upright LiDAR (no roll, no pitch, any yaw) has all channels of an azimuth in one vertical plane.
Seen from above a voxel is a square, and two of its corners bound the azimuths that meet it. In the
frame folded into the first quadrant azimuths are counted from the nearest axis, so that small
angles keep all their digits. Each azimuth's ray cuts the square between two distances; the
channels that pass the voxel are those with a slope between two quotients of height and distance:
two look-ups in a table (`slopes`).

All arithmetic is in single precision. Where rounding could decide, or the count is large, the voxel
is unsure and left to the exact test in `voxel_beams`: a few in a hundred. docs/engine.md has a
figure, and a voxel worked by hand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Singles
from ...geometry.indexing import blocks
from .slopes import SlopeCounts

Indices = NDArray[np.intp]
Small = NDArray[np.int16]
Counts = NDArray[np.int32]

MARGIN = np.float32(2e-6)
"""Relative rounding of an angle in single precision, with room to spare."""
MAX_AZIMUTHS = 10
"""A voxel that more azimuths meet is near the sensor, and left to `bracket`."""
MIN_DISTANCE = np.float32(4.0)
"""A voxel not farther from the sensor's axis than this is left to `bracket` as well, in sides."""
CACHED_CIRCLES = 16
"""Circles in the cache, by number of azimuths and fraction of a step: one a model and yaw."""
BLOCK = 1 << 15
"""Voxels computed together: their arrays fit the processor's cache."""
CUBE_SPAN = 2.0
"""More than the extent of a cube: an occluded beam meets no voxel that begins this much beyond its
end, in sides."""
YAW_TOLERANCE = 1e-9
"""A yaw nearer than this to a whole number of azimuth steps counts as whole, in steps."""


@dataclass(frozen=True, slots=True)
class Cubes:
    """Lower and upper faces of cubes along each ground axis, seen from the sensor, in sides.

    Offsets are exact to the last digit, because the offset of a face decides ties.
    """

    x0: Singles
    x1: Singles
    y0: Singles
    y1: Singles
    z0: Singles
    z1: Singles

    @classmethod
    def of(cls, corners: Sequence[Singles], position: Floats) -> Cubes:
        """Subtract a position from lower corners, which are whole numbers in the same frame."""
        faces = []
        for corner, coordinate in zip(corners, position.tolist(), strict=True):
            whole = round(coordinate)
            lower = corner - np.float32(whole)  # exact
            upper = lower + np.float32(1.0)
            lower -= np.float32(coordinate - whole)
            upper -= np.float32(coordinate - whole)
            faces += [lower, upper]
        return cls(*faces)

    def take(self, index: slice) -> Cubes:
        """Return the cubes with these indices."""
        x0, x1, y0, y1, z0, z1 = self.x0, self.x1, self.y0, self.y1, self.z0, self.z1
        return Cubes(x0[index], x1[index], y0[index], y1[index], z0[index], z1[index])


@dataclass(frozen=True, slots=True)
class Azimuths:
    """Azimuths that meet voxels, (V,): entries ``entry + turn * n`` of `Circle` for n < `count`."""

    entry: Singles
    turn: Singles
    count: Singles

    @classmethod
    def concatenated(cls, parts: Sequence[Azimuths]) -> Azimuths:
        """Join parts."""
        columns = zip(*((p.entry, p.turn, p.count) for p in parts), strict=True)
        return cls(*(np.concatenate(column) for column in columns))

    def take(self, index: slice | Indices) -> Azimuths:
        """Return the azimuths of the voxels with these indices."""
        return Azimuths(self.entry[index], self.turn[index], self.count[index])


@dataclass(frozen=True, slots=True)
class Circle:
    """Reciprocals of cosine and sine at the azimuths of a LiDAR turned by a `fraction` of a step.

    Entry j is azimuth step ``j - 2 * count``. The table spans four turns, so no index wraps.
    """

    count: int
    fraction: float
    per_x: Singles
    per_y: Singles

    @classmethod
    def of(cls, count: int, fraction: float) -> Circle:
        """Tabulate `count` azimuths."""
        angles = [(j + fraction) * (2.0 * math.pi / count) for j in range(count)]
        per_x = np.array([1.0 / (math.cos(a) or 1e-30) for a in angles], np.float32)
        per_y = np.array([1.0 / (math.sin(a) or 1e-30) for a in angles], np.float32)
        return cls(count, fraction, np.tile(per_x, 4), np.tile(per_y, 4))

    def meeting(self, cubes: Cubes) -> tuple[Azimuths, Flags]:
        """Return the azimuths that meet each cube, and where (V,) they are unsure."""
        behind = cubes.x1 < -cubes.x0
        turn = np.multiply(behind ^ (cubes.y1 < -cubes.y0), np.float32(-2.0))
        turn += np.float32(1.0)
        low, high, unsure = _corner_angles(cubes)
        per_radian = np.float32(self.count / (2.0 * math.pi))
        low *= per_radian
        high *= per_radian
        if self.fraction:
            low -= turn * np.float32(self.fraction)
            high -= turn * np.float32(self.fraction)
        for angle in (low, high):
            unsure |= self._is_close_to_whole(angle)
        np.ceil(low, out=low)
        count = np.floor(high, out=high)
        count -= low
        count += np.float32(1.0)
        unsure |= count > MAX_AZIMUTHS
        low *= turn
        entry = np.multiply(behind, np.float32(self.count // 2))
        entry += np.float32(2 * self.count)
        entry += low
        return Azimuths(entry, turn, count), unsure

    def _is_close_to_whole(self, angle: Singles) -> Flags:
        """Whether angles, in steps, are so near to a whole number that rounding could decide."""
        margin = np.abs(angle)
        if self.fraction:
            margin += np.float32(2.0)
        margin *= MARGIN
        distance = np.rint(angle)
        distance -= angle
        np.abs(distance, out=distance)
        close: Flags = distance <= margin
        return close


@lru_cache(maxsize=CACHED_CIRCLES)
def circle(count: int, fraction: float) -> Circle:
    """Return the circle of `count` azimuths turned by a fraction of a step, from a cache."""
    return Circle.of(count, fraction)


def _corner_angles(cubes: Cubes) -> tuple[Singles, Singles, Flags]:
    """Angles (V,) of the squares' two outermost corners [rad], and which squares are too near.

    The squares are mirrored into the first quadrant; they may extend beyond it.
    """
    x0, x1 = np.maximum(cubes.x0, -cubes.x1), np.maximum(cubes.x1, -cubes.x0)
    y0, y1 = np.maximum(cubes.y0, -cubes.y1), np.maximum(cubes.y1, -cubes.y0)
    near: Flags = np.maximum(x0, y0) <= MIN_DISTANCE
    np.copyto(x1, x0, where=y0 <= 0)
    np.copyto(y1, y0, where=x0 <= 0)
    return np.arctan2(y0, x1, out=x1), np.arctan2(y1, x0, out=x0), near


@dataclass(frozen=True, slots=True)
class Cut:
    """How one azimuth each cuts voxels, (V,) each.

    `entry` is the azimuth's entry of `Circle`; `enter` the horizontal distance at which its ray
    enters the square, in sides; `below_low` and `below_high` the numbers of channels below the
    lowest and the highest slope inside the voxel.
    """

    entry: Indices
    enter: Singles
    below_low: Small
    below_high: Small


@dataclass(frozen=True, slots=True)
class OccludedBeams:
    """Beams that the vehicle may occlude, summed up.

    `free` (A, C + 1) counts, at each ground azimuth, the free beams among the lowest channels. From
    channel `above` on all are free. No occluded beam meets a voxel that begins beyond `reach`, in
    sides.
    """

    free: Small
    above: int
    reach: float

    @classmethod
    def of(cls, occludable: Flags, max_occlusion: float, yaw_steps: int) -> OccludedBeams | None:
        """Sum up flags (C, A), lowest channel first; None where no beam is flagged."""
        rows = np.flatnonzero(occludable.any(axis=1))
        if not len(rows):
            return None
        free = np.zeros((occludable.shape[1], occludable.shape[0] + 1), np.int16)
        np.cumsum(~np.roll(occludable, yaw_steps, axis=1).T, axis=1, out=free[:, 1:])
        return cls(free, int(rows[-1]) + 1, max_occlusion + CUBE_SPAN)

    def subtract(self, cut: Cut, counts: Small, unsure: Flags) -> None:
        """Subtract occluded beams from counts (V,), in place.

        A voxel within `reach` that loses beams becomes unsure: they may end behind it.
        """
        azimuths, width = self.free.shape
        low = np.flatnonzero((cut.below_low < self.above) & (counts > 0))
        row = (cut.entry[low] % azimuths) * width
        free = np.take(self.free, row + cut.below_high[low])
        free -= np.take(self.free, row + cut.below_low[low])
        unsure[low] |= (free != counts[low]) & (cut.enter[low] < self.reach)
        counts[low] = free


@dataclass(frozen=True, slots=True)
class Upright:
    """An upright LiDAR: its tables, and the beams that the vehicle may occlude."""

    slopes: SlopeCounts
    circle: Circle
    occlusion: OccludedBeams | None

    @classmethod
    def of(
        cls,
        slopes: SlopeCounts,
        ground_from_sensor: Floats,
        occludable: Flags,
        max_occlusion: float,
    ) -> Upright:
        """Prepare for an upright orientation and beams (C, A) that the vehicle may occlude.

        The lowest channel is first. None of them ends farther away than `max_occlusion`, in sides.
        """
        yaw = math.atan2(ground_from_sensor[1, 0], ground_from_sensor[0, 0])
        steps = yaw * slopes.azimuth_count / (2.0 * math.pi)
        fraction = steps - round(steps)
        if abs(fraction) < YAW_TOLERANCE:
            fraction = 0.0
        occlusion = OccludedBeams.of(occludable, max_occlusion, round(steps))
        return cls(slopes, circle(slopes.azimuth_count, fraction), occlusion)

    def count(self, corners: Sequence[Singles], position: Floats) -> tuple[Counts, Flags]:
        """Count the beams through unit cubes.

        Fast because most cubes are met by one or two azimuths, each settled by two look-ups. The
        first azimuth of all cubes is computed block by block; further ones follow for the cubes
        that have them, those with the most azimuths first.

        `corners` are the cubes' lower corners, whole numbers: three arrays (V,), one an axis;
        `position` (3,) is the sensor's in the same frame (`tie_rules.position_in_voxels`). Returns
        the counts (V,), and flags (V,) of unsure ones, which are to be found in another way.
        """
        total = len(corners[0])
        counts, unsure = np.empty(total, np.int32), np.empty(total, bool)
        with np.errstate(all="ignore"):  # divisions of voxels that become unsure
            further: list[tuple[Indices, Azimuths]] = []
            for block in blocks(total, BLOCK):
                cubes = Cubes.of([c[block] for c in corners], position)
                azimuths, unsure_azimuths = self.circle.meeting(cubes)
                passing, unsure_channels = self._passing(cubes, azimuths.entry)
                np.multiply(passing, azimuths.count > 0, out=counts[block])
                np.logical_or(unsure_azimuths, unsure_channels, out=unsure[block])
                more = np.flatnonzero((azimuths.count > 1) & ~unsure[block])
                further.append((more + block.start, azimuths.take(more)))
            azimuths = Azimuths.concatenated([a for _, a in further])
            order = np.argsort((MAX_AZIMUTHS - azimuths.count).astype(np.int8), kind="stable")
            voxel = np.concatenate([v for v, _ in further])[order]
            cubes = Cubes.of([c[voxel] for c in corners], position)
            further_counts, further_unsure = self._further(cubes, azimuths.take(order))
        counts[voxel] += further_counts
        unsure[voxel] = further_unsure
        return counts, unsure

    def _further(self, cubes: Cubes, azimuths: Azimuths) -> tuple[Counts, Flags]:
        """Count at the second and further azimuths; cubes with the most azimuths come first."""
        counts, unsure = np.zeros(len(cubes.x0), np.int32), np.zeros(len(cubes.x0), bool)
        cubes_by_count = np.bincount(azimuths.count.astype(np.intp), minlength=MAX_AZIMUTHS + 1)
        for n in range(2, MAX_AZIMUTHS + 1):
            for block in blocks(int(cubes_by_count[n:].sum()), BLOCK):
                nth = azimuths.take(block)
                np.add(nth.entry, nth.turn, out=nth.entry)
                passing, unsure_channels = self._passing(cubes.take(block), nth.entry)
                counts[block] += passing
                unsure[block] |= unsure_channels
        return counts, unsure

    def _passing(self, cubes: Cubes, entry: Singles) -> tuple[Small, Flags]:
        """Count the channels of one azimuth per cube that pass it, and flag unsure counts."""
        index = entry.astype(np.intp)
        per = np.take(self.circle.per_x, index, mode="clip")
        a, b = cubes.x0 * per, cubes.x1 * per
        np.take(self.circle.per_y, index, mode="clip", out=per)
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
        counts = high - low
        if self.occlusion is not None:
            self.occlusion.subtract(Cut(index, enter, low, high), counts, unsure)
        return counts, unsure

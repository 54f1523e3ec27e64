"""Beams of an upright LiDAR through single voxels, azimuth by azimuth.

An upright LiDAR (no roll, no pitch, any yaw) has all channels of an azimuth in one vertical plane.
Seen from above a voxel is a square, and two of its corners bound the azimuths that meet it. In the
frame folded into the first quadrant azimuths are counted from the nearest axis, so that small
angles keep all their digits. Each azimuth's ray cuts the square between two distances; the
channels that pass the voxel are those with a slope between two quotients of height and distance:
two look-ups in a table (`SlopeCounts`).

All arithmetic is in single precision. Where rounding could decide, or the count is large, the voxel
is unsure and left to `bracket` and the exact test in `voxel_beams`: a few in a hundred.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Singles
from ...geometry.bins import blocks

Indices = NDArray[np.intp]
Small = NDArray[np.int16]
Counts = NDArray[np.int32]

COUNT_BINS = 1 << 17
COUNT_MARGIN = np.float32(2e-6)
"""Relative rounding of a slope whose channels are counted, with room to spare."""
MAX_ELEVATION_RAD = math.radians(80.0)
"""Steeper channels are not counted by slope: their tangents would leave too few bins to others."""
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
class SlopeCounts:
    """The number of channels of a regular LiDAR below a slope, or that it is unsure.

    `below` holds a code for each bin of slopes: twice the number of channels below the bin, plus 1
    where a channel may lie in the bin. A bin begins at slope 0, and a slope's sign is always right,
    so the horizontal channel lies in no bin.
    """

    azimuth_count: int
    scale: np.float32
    first: int
    below: Small

    @classmethod
    def of(cls, elevations: Floats, azimuth_count: int) -> "SlopeCounts | None":
        """Build the table of channels at elevations (C,) [rad].

        None for an odd number of azimuths or steep channels: the table does not serve them.
        """
        if azimuth_count % 2 or np.abs(elevations).max() > MAX_ELEVATION_RAD:
            return None
        slopes = np.array([math.tan(e) for e in np.sort(elevations).tolist()])
        scale = float(np.float32(COUNT_BINS / (slopes[-1] - slopes[0] + 0.01)))
        first = math.floor(slopes[0] * scale) - 2
        edges = np.arange(first, math.floor(slopes[-1] * scale) + 4) / scale
        slack = float(COUNT_MARGIN) * np.abs(edges)
        below = np.searchsorted(slopes, edges[:-1] - slack[:-1], side="left")
        upto = np.searchsorted(slopes, edges[1:] + slack[1:], side="right")
        upto[edges[1:] == 0.0] = np.searchsorted(slopes, 0.0, side="left")
        below[edges[:-1] == 0.0] = np.searchsorted(slopes, 0.0, side="right")
        table = (2 * below + (upto > below)).astype(np.int16)
        return cls(azimuth_count, np.float32(scale), first, table)

    def look_up(self, slopes: Singles) -> Small:
        """Return the codes `below` of slopes; overwrites the slopes."""
        slopes *= self.scale
        bins = np.floor(slopes, out=slopes).astype(np.intp)
        bins -= self.first
        return np.take(self.below, bins, mode="clip")


def faces_of(corners: Sequence[Singles], position: Floats) -> Singles:
    """Return the faces (6, V) of cubes seen from the sensor, in sides: x0, x1, y0, y1, z0, z1.

    `corners` are lower corners, whole numbers in the frame of the position. Offsets are exact to
    the last digit, because the offset of a face decides ties.
    """
    faces = np.empty((6, len(corners[0])), np.float32)
    for axis, (corner, coordinate) in enumerate(zip(corners, position.tolist(), strict=True)):
        whole = round(coordinate)
        lower, upper = faces[2 * axis : 2 * axis + 2]
        np.subtract(corner, np.float32(whole), out=lower)  # exact
        np.add(lower, np.float32(1.0), out=upper)
        faces[2 * axis : 2 * axis + 2] -= np.float32(coordinate - whole)
    return faces


@dataclass(frozen=True, slots=True)
class Circle:
    """Reciprocals of cosine and sine at the azimuths of a LiDAR turned by a `fraction` of a step.

    Entry j is azimuth step ``j - 2 * count``. The table spans four turns, so no index wraps. The
    azimuths that meet voxels (V,) are rows (3, V): `entry`, `turn` and `count`, which stand for the
    entries ``entry + turn * n`` of n < `count`.
    """

    count: int
    fraction: float
    per_x: Singles
    per_y: Singles

    @classmethod
    def of(cls, count: int, fraction: float) -> "Circle":
        """Tabulate `count` azimuths."""
        angles = [(j + fraction) * (2.0 * math.pi / count) for j in range(count)]
        per_x = np.array([1.0 / (math.cos(a) or 1e-30) for a in angles], np.float32)
        per_y = np.array([1.0 / (math.sin(a) or 1e-30) for a in angles], np.float32)
        return cls(count, fraction, np.tile(per_x, 4), np.tile(per_y, 4))

    def meeting(self, faces: Singles) -> tuple[Singles, Flags]:
        """Return the azimuths (3, V) that meet each cube, and where (V,) they are unsure."""
        x0, x1, y0, y1 = faces[:4]
        behind = x1 < -x0
        turn = np.multiply(behind ^ (y1 < -y0), np.float32(-2.0))
        turn += np.float32(1.0)
        # The squares are mirrored into the first quadrant; they may extend beyond it.
        x0, x1 = np.maximum(x0, -x1), np.maximum(x1, -x0)
        y0, y1 = np.maximum(y0, -y1), np.maximum(y1, -y0)
        unsure: Flags = np.maximum(x0, y0) <= MIN_DISTANCE
        np.copyto(x1, x0, where=y0 <= 0)
        np.copyto(y1, y0, where=x0 <= 0)
        low = np.arctan2(y0, x1, out=x1)  # outermost corners
        high = np.arctan2(y1, x0, out=x0)
        per_radian = np.float32(self.count / (2.0 * math.pi))
        low *= per_radian
        high *= per_radian
        if self.fraction:
            low -= turn * np.float32(self.fraction)
            high -= turn * np.float32(self.fraction)
        for angle in (low, high):  # so near to a whole number that rounding could decide
            margin = np.abs(angle)
            if self.fraction:
                margin += np.float32(2.0)
            margin *= MARGIN
            distance = np.rint(angle)
            distance -= angle
            unsure |= np.abs(distance, out=distance) <= margin
        np.ceil(low, out=low)
        count = np.floor(high, out=high)
        count -= low
        count += np.float32(1.0)
        unsure |= count > MAX_AZIMUTHS
        low *= turn
        entry = np.multiply(behind, np.float32(self.count // 2))
        entry += np.float32(2 * self.count)
        entry += low
        return np.stack([entry, turn, count]), unsure


@lru_cache(maxsize=CACHED_CIRCLES)
def circle(count: int, fraction: float) -> "Circle":
    """Return the circle of `count` azimuths turned by a fraction of a step, from a cache."""
    return Circle.of(count, fraction)


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
    def of(cls, occludable: Flags, max_occlusion: float, yaw_steps: int) -> "OccludedBeams | None":
        """Sum up flags (C, A), lowest channel first; None where no beam is flagged."""
        rows = np.flatnonzero(occludable.any(axis=1))
        if not len(rows):
            return None
        free = np.zeros((occludable.shape[1], occludable.shape[0] + 1), np.int16)
        np.cumsum(~np.roll(occludable, yaw_steps, axis=1).T, axis=1, out=free[:, 1:])
        return cls(free, int(rows[-1]) + 1, max_occlusion + CUBE_SPAN)

    def subtract(
        self, entry: Indices, enter: Singles, channels: tuple[Small, Small], unsure: Flags
    ) -> Small:
        """Return the number (V,) of free beams of one azimuth that pass each voxel.

        `entry` (V,) is the azimuth in `Circle`, `enter` the horizontal distance at which its ray
        enters the square, in sides; `channels` are the numbers of channels below the lowest and
        the highest slope inside the voxel. A voxel within `reach` that loses beams becomes unsure:
        they may end behind it.
        """
        below_low, below_high = channels
        counts = below_high - below_low
        azimuths, width = self.free.shape
        low = np.flatnonzero((below_low < self.above) & (counts > 0))
        row = (entry[low] % azimuths) * width
        free = np.take(self.free, row + below_high[low])
        free -= np.take(self.free, row + below_low[low])
        unsure[low] |= (free != counts[low]) & (enter[low] < self.reach)
        counts[low] = free
        return counts


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
    ) -> "Upright":
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
        `position` (3,) is the sensor's in the same frame (`definition.position_in_voxels`). Returns
        the counts (V,), and flags (V,) of unsure ones, which are to be found in another way.
        """
        total = len(corners[0])
        counts = np.empty(total, np.int32)
        unsure = np.empty(total, bool)
        with np.errstate(all="ignore"):  # divisions of voxels that become unsure
            further: list[tuple[Indices, Singles]] = []
            for block in blocks(total, BLOCK):
                faces = faces_of([c[block] for c in corners], position)
                azimuths, unsure_azimuths = self.circle.meeting(faces)
                passing, unsure_channels = self._passing(faces, azimuths[0])
                np.multiply(passing, azimuths[2] > 0, out=counts[block])
                np.logical_or(unsure_azimuths, unsure_channels, out=unsure[block])
                more = np.flatnonzero((azimuths[2] > 1) & ~unsure[block])
                further.append((more + block.start, azimuths[:, more]))
            azimuths = np.concatenate([a for _, a in further], axis=1)
            order = np.argsort((MAX_AZIMUTHS - azimuths[2]).astype(np.int8), kind="stable")
            voxel = np.concatenate([v for v, _ in further])[order]
            faces = faces_of([c[voxel] for c in corners], position)
            further_counts, further_unsure = self._further(faces, azimuths[:, order])
        counts[voxel] += further_counts
        unsure[voxel] = further_unsure
        return counts, unsure

    def _further(self, faces: Singles, azimuths: Singles) -> tuple[Counts, Flags]:
        """Count at the second and further azimuths; cubes with the most azimuths come first."""
        counts = np.zeros(faces.shape[1], np.int32)
        unsure = np.zeros(faces.shape[1], bool)
        entry, turn, count = azimuths
        cubes_by_count = np.bincount(count.astype(np.intp), minlength=MAX_AZIMUTHS + 1)
        for n in range(2, MAX_AZIMUTHS + 1):
            for block in blocks(int(cubes_by_count[n:].sum()), BLOCK):
                entry[block] += turn[block]
                passing, unsure_channels = self._passing(faces[:, block], entry[block])
                counts[block] += passing
                unsure[block] |= unsure_channels
        return counts, unsure

    def _passing(self, faces: Singles, entry: Singles) -> tuple[Small, Flags]:
        """Count the channels of one azimuth per cube that pass it, and flag unsure counts."""
        x0, x1, y0, y1, z0, z1 = faces
        index = entry.astype(np.intp)
        per = np.take(self.circle.per_x, index, mode="clip")
        a = x0 * per
        b = x1 * per
        np.take(self.circle.per_y, index, mode="clip", out=per)
        c = y0 * per
        d = y1 * per
        enter = np.minimum(c, d, out=per)
        np.maximum(enter, np.minimum(a, b), out=enter)
        leave = np.maximum(c, d, out=c)
        np.minimum(leave, np.maximum(a, b), out=leave)
        near = np.divide(np.float32(1.0), enter, out=a)
        far = np.divide(np.float32(1.0), leave, out=leave)
        low = self.slopes.look_up(np.minimum(z0 * near, z0 * far, out=b))
        high = self.slopes.look_up(np.maximum(z1 * near, z1 * far, out=b))
        unsure: Flags = ((low | high) & 1).astype(bool)
        low >>= 1
        high >>= 1
        if self.occlusion is None:
            return high - low, unsure
        return self.occlusion.subtract(index, enter, (low, high), unsure), unsure

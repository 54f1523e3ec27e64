"""Beams through single voxels, counted exactly.

The beams of a voxel's window (`lattice`) are tested with the arithmetic of the definition, so the
count equals the definition's to the last beam. For regular LiDARs `upright` or `bracket` decides
most voxels without any test. `bracket` counts voxels as if there were no vehicle first; only those
whose window holds a beam that the vehicle may occlude are counted again.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints, Singles, join_columns
from ...geometry.bins import blocks
from ...geometry.poses import rotate
from .bracket import Bracket, bracket
from .lattice import windows_of
from .upright import Upright

if TYPE_CHECKING:
    from .beams import BeamEnds, RotatedBeams
    from .lattice import Lattice

PAIR_BLOCK = 1 << 16
"""(voxel, beam) pairs tested together: their arrays fit the processor's cache."""
CUBE_RADIUS = 2.0
"""No point of a unit cube is farther from its centre than this, rounding included, in sides."""


class VoxelPoints:
    """Voxels of a grid, by index (V, 3): `centers` and lower `corners`, in sides."""

    def __init__(self, index: Ints) -> None:
        self.centers = index + 0.5
        self.corners = [np.ascontiguousarray(c, dtype=np.float32) for c in index.T]
        self._low = self.centers.min(axis=0, initial=0.0)
        self._high = self.centers.max(axis=0, initial=0.0)

    def __len__(self) -> int:
        return len(self.centers)

    def max_distance(self, position: Floats) -> float:
        """Return an upper bound of the distance of any voxel's centre from a position."""
        gaps = np.maximum(np.abs(self._low - position), np.abs(self._high - position))
        return math.hypot(*gaps.tolist())

    def offsets(self, position: Floats, index: Ints | slice = slice(None)) -> Floats:
        """Return the centres (N, 3) of voxels, seen from a position (3,)."""
        return self.centers[index] - position

    def offsets_float32(self, position: Floats, index: Ints | slice = slice(None)) -> list[Singles]:
        """Return the centres seen from a position in single precision, an array (N,) an axis.
        Centres are exact in single precision. The position's whole part is subtracted first, so
        that its fraction keeps its digits."""
        whole = np.floor(position)
        fraction = (position - whole).astype(np.float32)
        return [
            (corner[index] - np.float32(w - 0.5)) - f
            for corner, w, f in zip(self.corners, whole, fraction, strict=True)
        ]


@dataclass(frozen=True, slots=True)
class PlacedLidar:
    """A LiDAR among the voxels of a grid. `position` (3,) is seen from the grid's lowest corner, in
    voxel sides (`definition.position_in_voxels`); `side` is a voxel's side [m]."""

    lattice: "Lattice"
    position: Floats
    ground_from_sensor: Floats
    beams: "RotatedBeams"
    ends: "BeamEnds"
    side: float

    def candidates(self, offsets: Floats) -> tuple[Ints, Ints]:
        """Return (voxel, beam) pairs of beams that may pass cubes at offsets (V, 3), in sides."""
        center = rotate(self.ground_from_sensor.T, offsets).T
        return self.lattice.candidates(windows_of(center, list(0.5 * self.ground_from_sensor)))

    @property
    def max_range(self) -> float:
        """Maximum range, in sides."""
        return self.ends.max_range / self.side

    @property
    def is_upright(self) -> bool:
        """Whether it has no roll, no pitch, and tables of its channels by slope."""
        return self.lattice.slope_counts is not None and self.ground_from_sensor[2, 2] == 1.0

    @property
    def occludable(self) -> NDArray[np.bool_]:
        """(C, A) beams that the vehicle may occlude, lowest channel first."""
        return self.ends.occludable.reshape(-1, self.lattice.width)[self.lattice.channels]


def count_voxel_beams(
    voxels: VoxelPoints, lidar: PlacedLidar, saturation_count: int | None = None
) -> NDArray[np.signedinteger]:
    """Count the beams (V,) through voxels that the vehicle does not occlude before. A count of
    `saturation_count` or more need not be exact: any number from this up to the count may be
    returned."""
    if lidar.lattice.slope_bounds is None:
        offsets = voxels.offsets(lidar.position)
        return count_pairs(offsets, lidar, *lidar.candidates(offsets))
    if not (lidar.is_upright and len(voxels)):
        return _count_bracketed(voxels, lidar, saturation_count, np.arange(len(voxels)))
    counts, unsure = _count_upright(voxels, lidar)
    undecided = np.flatnonzero(unsure)
    counts[undecided] = _count_bracketed(voxels, lidar, saturation_count, undecided)
    return counts


def _count_upright(
    voxels: VoxelPoints, lidar: PlacedLidar
) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Count for an upright LiDAR, and flag unsure counts (V,)."""
    assert lidar.lattice.slope_counts is not None
    upright = Upright.of(
        lidar.lattice.slope_counts,
        lidar.ground_from_sensor,
        lidar.occludable,
        lidar.ends.max_occlusion / lidar.side,
    )
    counts, unsure = upright.count(voxels.corners, lidar.position)
    if voxels.max_distance(lidar.position) > lidar.max_range - CUBE_RADIUS:
        unsure |= _may_exceed(voxels.offsets_float32(lidar.position), lidar.max_range)
    return counts, unsure


def _count_bracketed(
    voxels: VoxelPoints, lidar: PlacedLidar, saturation_count: int | None, index: Ints
) -> Ints:
    """Count the beams (N,) through the voxels `index` (N,): by bounds, and beam by beam where these
    differ."""
    lattice = lidar.lattice
    assert lattice.slope_bounds is not None
    points = voxels.offsets_float32(lidar.position, index)
    bounds = bracket(points, lidar.ground_from_sensor, lattice.slope_bounds, lattice.count)
    counts = bounds.lower.astype(np.int64)
    counts[_may_exceed(points, lidar.max_range)] = 0
    limit = np.iinfo(np.int64).max if saturation_count is None else saturation_count
    undecided = (counts < bounds.upper) & (counts < limit)
    affected = _affected(lidar.occludable, bounds)
    undecided[affected] = False
    for some, without_vehicle in ((np.flatnonzero(undecided), True), (affected, False)):
        offsets = voxels.offsets(lidar.position, index[some])
        voxel, beam = lattice.window_beams(bounds, some)
        counts[some] = count_pairs(offsets, lidar, voxel, beam, without_vehicle=without_vehicle)
    return counts


def _affected(occludable: NDArray[np.bool_], bounds: Bracket) -> Ints:
    """Return the voxels (N,) whose windows hold a beam that the vehicle may occlude, of flags (C,
    A), lowest channel first."""
    rows = np.flatnonzero(occludable.any(axis=1))
    if not len(rows):
        return np.zeros(0, np.intp)
    possible = np.flatnonzero((bounds.row <= rows[-1]) & (bounds.upper > 0))
    return possible[_any_in_window(occludable, bounds, possible)]


def _may_exceed(points: Sequence[Singles], max_range: float) -> NDArray[np.bool_]:
    """Whether voxels (V,) may extend beyond the maximum range, in sides."""
    x, y, z = points
    exceeds: NDArray[np.bool_] = x * x + y * y + z * z > max(max_range - CUBE_RADIUS, 0.0) ** 2
    return exceeds


def _any_in_window(flags: NDArray[np.bool_], bounds: Bracket, voxels: Ints) -> NDArray[np.bool_]:
    """Whether the windows of voxels hold a flagged beam: four look-ups in a summed-area table."""
    channels, width = flags.shape
    sums = np.zeros((channels + 1, 2 * width + 1), np.int32)  # of flags before, over two turns
    np.cumsum(flags, axis=1, dtype=np.int32, out=sums[1:, 1 : width + 1])
    for row, before in zip(sums[1:], sums, strict=False):
        row += before  # five times as fast as np.cumsum along the first axis
    np.add(sums[:, 1 : width + 1], sums[:, width : width + 1], out=sums[:, width + 1 :])
    row, rows, column, columns = (
        w.take(voxels) for w in (bounds.row, bounds.rows, bounds.column, bounds.columns)
    )
    first = row * sums.shape[1] + column % width
    last = first + rows * sums.shape[1]
    flat = sums.reshape(-1)
    before = flat.take(last) - flat.take(first)
    any_flag: NDArray[np.bool_] = flat.take(last + columns) - flat.take(first + columns) > before
    return any_flag


def count_pairs(
    offsets: Floats, lidar: PlacedLidar, voxel: Ints, beam: Ints, without_vehicle: bool = False
) -> Ints:
    """Count for each voxel (V,) the (voxel, beam) pairs (P,) whose beam passes it; exact. `offsets`
    (V, 3) are the voxels' centres seen from the sensor, in sides."""
    counts = np.zeros(len(offsets), np.int64)
    occludable = []
    axes = [np.ascontiguousarray(w) for w in offsets.T]
    for block in blocks(len(voxel), PAIR_BLOCK):
        through, enter = _through(axes, lidar, voxel[block], beam[block])
        pairs = voxel[block][through], beam[block][through]
        counts += np.bincount(pairs[0], minlength=len(counts))
        if not without_vehicle:
            at = np.flatnonzero(lidar.ends.occludable[pairs[1]])
            occludable.append((pairs[0][at], pairs[1][at], enter[at]))
    if occludable:
        voxel, beam, distance = join_columns(occludable)
        occluded = distance > lidar.ends.take(beam) / lidar.side
        counts -= np.bincount(voxel[occluded], minlength=len(counts))
    return counts


def _through(
    offsets: Sequence[Floats], lidar: PlacedLidar, voxel: Ints, beam: Ints
) -> tuple[Ints, Floats]:
    """Pairs whose beam enters its cube in range, and the distance there, in sides. The arithmetic
    of `definition.cube_crossing`, axis by axis; `offsets` are three arrays (V,), one an axis."""
    enter = np.zeros(len(voxel))
    leave = np.full(len(voxel), np.inf)
    for center, step in zip(offsets, lidar.beams.components(beam), strict=True):
        upper = np.take(center, voxel)
        lower = upper - 0.5
        upper += 0.5
        lower /= step
        upper /= step
        np.maximum(enter, np.minimum(lower, upper, out=step), out=enter)
        np.minimum(leave, np.maximum(lower, upper, out=step), out=leave)
    through = np.flatnonzero((enter < leave) & (enter <= lidar.max_range))
    return through, enter[through]

"""Beams through single voxels: for each voxel the few beams that may touch it, tested exactly.

The beams of a voxel's window (`lattice`) are put to the test of the definition with the same
arithmetic, so the count is the definition's to the last beam. For regular LiDARs `upright` or
`bracket` settles most voxels without any test.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.numbering import blocks
from .bracket import Bracket, Singles, bracket
from .lattice import Lattice, windows_of
from .upright import Upright

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Counts = NDArray[np.int32]

PAIRS_AT_ONCE = 1 << 16
CUBE_REACH = 2.0
"""No point of a unit cube is farther from its centre than this, rounding included."""


class VoxelPoints:
    """Voxels of a grid as points to count beams through.

    Parameters
    ----------
    index : (V, 3) int
        Which voxels.
    """

    def __init__(self, index: Ints) -> None:
        self.centers = index + 0.5
        self.corners = [np.ascontiguousarray(c, dtype=np.float32) for c in index.T]
        self._low = self.centers.min(axis=0, initial=0.0)
        self._high = self.centers.max(axis=0, initial=0.0)

    def __len__(self) -> int:
        return len(self.centers)

    def farthest(self, position: Floats) -> float:
        """Return a distance no voxel's centre is farther than, from a position, in sides."""
        gaps = np.maximum(np.abs(self._low - position), np.abs(self._high - position))
        return math.hypot(*gaps.tolist())

    def offsets(self, position: Floats, some: Ints | slice = slice(None)) -> Floats:
        """Centres (V, 3) of some voxels seen from a position (3,), in voxel sides."""
        return self.centers[some] - position

    def offsets_single(self, position: Floats, some: Ints | slice = slice(None)) -> list[Singles]:
        """The same in single precision, a (V,) array an axis.

        Centres are exact in single precision; the position's whole part is taken off first, so
        that its fraction keeps its digits.
        """
        whole = np.floor(position)
        rest = (position - whole).astype(np.float32)
        return [
            (corner[some] - np.float32(w - 0.5)) - r
            for corner, w, r in zip(self.corners, whole, rest, strict=True)
        ]


@dataclass(frozen=True, slots=True)
class PlacedLidar:
    """A LiDAR among the voxels of a grid: lengths in voxel sides.

    `position` (3,) is seen from the grid's lowest corner (`ties.position_in_voxels`),
    `ground_from_sensor` (3, 3) how it is turned. `directions` (B, 3) are all beams of the lattice
    in the ground frame, without zeros; `ends` (B,) where each of them ends.
    """

    lattice: Lattice
    position: Floats
    ground_from_sensor: Floats
    directions: Floats
    ends: Floats


def count_through(
    voxels: VoxelPoints, lidar: PlacedLidar, enough: int | None = None
) -> NDArray[np.signedinteger]:
    """Count a LiDAR's beams through voxels.

    Parameters
    ----------
    voxels : VoxelPoints
    lidar : PlacedLidar
    enough : int, optional
        A count of this or more need not be exact: it may be told as any number from `enough` up to
        the count.

    Returns
    -------
    (V,) int
    """
    lattice = lidar.lattice
    if lattice.slope_bounds is None:
        offsets = voxels.offsets(lidar.position)
        windows = windows_of(offsets, 0.5, lidar.ground_from_sensor)
        return _count_pairs(offsets, lidar, *lattice.candidates(windows))
    if lattice.slope_counts is None or lidar.ground_from_sensor[2, 2] != 1.0 or not len(voxels):
        return _bracketed(voxels, lidar, enough, slice(None))
    counts, unsure = _upright(voxels, lidar)
    doubtful = np.flatnonzero(unsure)
    counts[doubtful] = _bracketed(voxels, lidar, enough, doubtful)
    return counts


def _upright(voxels: VoxelPoints, lidar: PlacedLidar) -> tuple[Counts, NDArray[np.bool_]]:
    """Count for an upright LiDAR, and say where that is unsure."""
    lattice, ends = lidar.lattice, lidar.ends
    assert lattice.slope_counts is not None
    longest = float(ends.max())
    early = ends < longest
    farthest = float(ends.max(where=early, initial=0.0))
    stopped = early.reshape(-1, lattice.width)[lattice.channels]
    upright = Upright.of(lattice.slope_counts, lidar.ground_from_sensor, stopped, farthest)
    counts, unsure = upright.count(voxels.corners, lidar.position)
    if voxels.farthest(lidar.position) > longest - CUBE_REACH:
        x, y, z = voxels.offsets_single(lidar.position)
        unsure |= x * x + y * y + z * z > max(longest - CUBE_REACH, 0.0) ** 2
    return counts, unsure


def _bracketed(
    voxels: VoxelPoints, lidar: PlacedLidar, enough: int | None, some: Ints | slice
) -> Ints:
    """Count the beams through some voxels: by bounds, and one by one where they differ."""
    points = voxels.offsets_single(lidar.position, some)
    lattice = lidar.lattice
    assert lattice.slope_bounds is not None
    bounds = bracket(points, lidar.ground_from_sensor, lattice.slope_bounds, lattice.count)
    counts = bounds.least.astype(np.int64)
    counts[_may_end_early(points, bounds, lidar)] = 0
    limit = np.iinfo(np.int64).max if enough is None else enough
    doubtful = np.flatnonzero((counts < bounds.most) & (counts < limit))
    where = doubtful if isinstance(some, slice) else some[doubtful]
    offsets = voxels.offsets(lidar.position, where)
    counts[doubtful] = _count_pairs(offsets, lidar, *lattice.window_beams(bounds, doubtful))
    return counts


def _may_end_early(
    points: Sequence[Singles], bounds: Bracket, lidar: PlacedLidar
) -> NDArray[np.bool_]:
    """Whether a beam of the voxel's window may end before it: at its range, or on the vehicle."""
    lattice, ends = lidar.lattice, lidar.ends
    longest = float(ends.max())
    x, y, z = points
    early: NDArray[np.bool_] = x * x + y * y + z * z > max(longest - CUBE_REACH, 0.0) ** 2
    stopped = (ends < longest).reshape(-1, lattice.width)[lattice.channels]
    rows = np.flatnonzero(stopped.any(axis=1))
    if len(rows):
        touched = np.flatnonzero((bounds.row <= rows[-1]) & (bounds.most > 0))
        early[touched] |= _holds_any(stopped, bounds, touched)
    return early


def _holds_any(stopped: NDArray[np.bool_], bounds: Bracket, voxels: Ints) -> NDArray[np.bool_]:
    """Whether the windows of some voxels hold a stopped beam: four look-ups in a table of sums."""
    channels, width = stopped.shape
    sums = np.zeros((channels + 1, 2 * width + 1), np.int32)  # twice round, so no window wraps
    np.cumsum(np.cumsum(np.tile(stopped, 2), axis=0, dtype=np.int32), axis=1, out=sums[1:, 1:])
    r0, c0 = bounds.row[voxels], bounds.column[voxels] % width
    r1, c1 = r0 + bounds.rows[voxels], c0 + bounds.columns[voxels]
    held: NDArray[np.bool_] = sums[r1, c1] - sums[r0, c1] > sums[r1, c0] - sums[r0, c0]
    return held


def _count_pairs(offsets: Floats, lidar: PlacedLidar, voxel: Ints, beam: Ints) -> Ints:
    """(V,) how many of the (voxel, beam) pairs are beams through their voxel."""
    counts = np.zeros(len(offsets), np.int64)
    for some in blocks(len(voxel), PAIRS_AT_ONCE):
        through = _through(offsets, lidar, voxel[some], beam[some])
        counts += np.bincount(voxel[some][through], minlength=len(counts))
    return counts


def _through(offsets: Floats, lidar: PlacedLidar, voxel: Ints, beam: Ints) -> NDArray[np.bool_]:
    """Whether each beam passes its cube: `definition.cube_crossing`, an axis at a time."""
    enter, leave = np.zeros(len(voxel)), np.full(len(voxel), np.inf)
    for axis in range(3):
        step, center = lidar.directions[beam, axis], offsets[voxel, axis]
        t0, t1 = (center - 0.5) / step, (center + 0.5) / step
        np.maximum(enter, np.minimum(t0, t1), out=enter)
        np.minimum(leave, np.maximum(t0, t1), out=leave)
    return (enter < leave) & (enter <= lidar.ends[beam])

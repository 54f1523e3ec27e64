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
from .beams import TurnedBeams
from .bracket import Bracket, Singles, bracket
from .ends import AnyEnds
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
    `ground_from_sensor` (3, 3) how it is turned, `beams` are its beams, turned so; `ends` where
    they end [m], `side` a voxel's side [m].
    """

    lattice: Lattice
    position: Floats
    ground_from_sensor: Floats
    beams: TurnedBeams
    ends: AnyEnds
    side: float

    @property
    def longest(self) -> float:
        """The range, in sides."""
        return self.ends.longest / self.side

    @property
    def stopped(self) -> NDArray[np.bool_]:
        """(C, A) beams that the vehicle may stop, lowest channel first."""
        return self.ends.stopped.reshape(-1, self.lattice.width)[self.lattice.channels]


@dataclass(frozen=True, slots=True)
class Unhidden:
    """Beams through voxels as if there were no vehicle: `counts` (V,), and windows if tilted."""

    counts: NDArray[np.signedinteger]
    bounds: Bracket | None = None


def count_through(
    voxels: VoxelPoints,
    lidar: PlacedLidar,
    enough: int | None = None,
    unhidden: Unhidden | None = None,
) -> NDArray[np.signedinteger]:
    """Count a LiDAR's beams through voxels.

    Parameters
    ----------
    voxels : VoxelPoints
    lidar : PlacedLidar
    enough : int, optional
        A count of this or more need not be exact: it may be told as any number from `enough` up to
        the count.
    unhidden : Unhidden, optional
        What `count_unhidden` finds with the same arguments, if that is known.

    Returns
    -------
    (V,) int
    """
    lattice = lidar.lattice
    if lattice.slope_bounds is None:
        offsets = voxels.offsets(lidar.position)
        windows = windows_of(offsets, 0.5, lidar.ground_from_sensor)
        return count_pairs(offsets, lidar, *lattice.candidates(windows))
    if _is_upright(lidar) and len(voxels):
        counts, unsure = _upright(voxels, lidar, lidar.stopped, lidar.ends.farthest / lidar.side)
        doubtful = np.flatnonzero(unsure)
        free = _bracketed(voxels, lidar, enough, doubtful)
        counts[doubtful] = _hidden(voxels, lidar, free, doubtful)
        return counts
    free = unhidden or count_unhidden(voxels, lidar, enough)
    return _hidden(voxels, lidar, free, slice(None))


def count_unhidden(voxels: VoxelPoints, lidar: PlacedLidar, enough: int | None = None) -> Unhidden:
    """Count a LiDAR's beams through voxels as if there were no vehicle; `enough` as above."""
    lattice = lidar.lattice
    if lattice.slope_bounds is None:
        offsets = voxels.offsets(lidar.position)
        windows = windows_of(offsets, 0.5, lidar.ground_from_sensor)
        pairs = lattice.candidates(windows)
        return Unhidden(count_pairs(offsets, lidar, *pairs, is_free=True))
    if not (_is_upright(lidar) and len(voxels)):
        return _bracketed(voxels, lidar, enough, slice(None))
    counts, unsure = _upright(voxels, lidar, np.zeros_like(lidar.stopped), 0.0)
    doubtful = np.flatnonzero(unsure)
    counts[doubtful] = _bracketed(voxels, lidar, enough, doubtful).counts
    return Unhidden(counts)


def _is_upright(lidar: PlacedLidar) -> bool:
    return lidar.lattice.slope_counts is not None and lidar.ground_from_sensor[2, 2] == 1.0


def _upright(
    voxels: VoxelPoints, lidar: PlacedLidar, stopped: NDArray[np.bool_], farthest: float
) -> tuple[Counts, NDArray[np.bool_]]:
    """Count for an upright LiDAR, and say where that is unsure.

    `stopped` (C, A), none of which ends farther away than `farthest`, in sides.
    """
    lattice, longest = lidar.lattice, lidar.longest
    assert lattice.slope_counts is not None
    upright = Upright.of(lattice.slope_counts, lidar.ground_from_sensor, stopped, farthest)
    counts, unsure = upright.count(voxels.corners, lidar.position)
    if voxels.farthest(lidar.position) > longest - CUBE_REACH:
        unsure |= _beyond(voxels.offsets_single(lidar.position), longest)
    return counts, unsure


def _beyond(points: Sequence[Singles], longest: float) -> NDArray[np.bool_]:
    """Whether a beam may end at its range before it has passed a voxel."""
    x, y, z = points
    beyond: NDArray[np.bool_] = x * x + y * y + z * z > max(longest - CUBE_REACH, 0.0) ** 2
    return beyond


def _bracketed(
    voxels: VoxelPoints, lidar: PlacedLidar, enough: int | None, some: Ints | slice
) -> Unhidden:
    """Count the beams through some voxels: by bounds, and one by one where they differ."""
    points = voxels.offsets_single(lidar.position, some)
    lattice = lidar.lattice
    assert lattice.slope_bounds is not None
    bounds = bracket(points, lidar.ground_from_sensor, lattice.slope_bounds, lattice.count)
    counts = bounds.least.astype(np.int64)
    counts[_beyond(points, lidar.longest)] = 0
    limit = np.iinfo(np.int64).max if enough is None else enough
    doubtful = np.flatnonzero((counts < bounds.most) & (counts < limit))
    counts[doubtful] = _one_by_one(voxels, lidar, bounds, some, doubtful, is_free=True)
    return Unhidden(counts, bounds)


def _hidden(
    voxels: VoxelPoints, lidar: PlacedLidar, unhidden: Unhidden, some: Ints | slice
) -> Ints:
    """Count again where beams of a voxel's window may be stopped."""
    bounds, counts, stopped = unhidden.bounds, unhidden.counts.astype(np.int64), lidar.stopped
    assert bounds is not None
    rows = np.flatnonzero(stopped.any(axis=1))
    if len(rows):
        touched = np.flatnonzero((bounds.row <= rows[-1]) & (bounds.most > 0) & (counts > 0))
        touched = touched[_holds_any(stopped, bounds, touched)]
        counts[touched] = _one_by_one(voxels, lidar, bounds, some, touched)
    return counts


def _one_by_one(
    voxels: VoxelPoints,
    lidar: PlacedLidar,
    bounds: Bracket,
    some: Ints | slice,
    which: Ints,
    is_free: bool = False,
) -> Ints:
    """Count with each beam of the windows of some of some voxels tested."""
    where = which if isinstance(some, slice) else some[which]
    offsets = voxels.offsets(lidar.position, where)
    return count_pairs(offsets, lidar, *lidar.lattice.window_beams(bounds, which), is_free)


def _holds_any(stopped: NDArray[np.bool_], bounds: Bracket, voxels: Ints) -> NDArray[np.bool_]:
    """Whether the windows of some voxels hold a stopped beam: four look-ups in a table of sums."""
    width, sums = stopped.shape[1], _sums_twice_round(stopped)
    r0, c0 = bounds.row[voxels], bounds.column[voxels] % width
    r1, c1 = r0 + bounds.rows[voxels], c0 + bounds.columns[voxels]
    held: NDArray[np.bool_] = sums[r1, c1] - sums[r0, c1] > sums[r1, c0] - sums[r0, c0]
    return held


def _sums_twice_round(stopped: NDArray[np.bool_]) -> Counts:
    """(C + 1, 2 A + 1) numbers of flags in lower rows and columns; twice, so that none wraps."""
    channels, width = stopped.shape
    sums = np.zeros((channels + 1, 2 * width + 1), np.int32)
    np.cumsum(stopped, axis=1, dtype=np.int32, out=sums[1:, 1 : width + 1])
    for row, before in zip(sums[1:], sums, strict=False):
        row += before  # five times as fast as a sum down the columns
    np.add(sums[:, 1 : width + 1], sums[:, width : width + 1], out=sums[:, width + 1 :])
    return sums


def count_pairs(
    offsets: Floats, lidar: PlacedLidar, voxel: Ints, beam: Ints, is_free: bool = False
) -> Ints:
    """(V,) how many of the (voxel, beam) pairs are beams through their voxel.

    With `is_free` as if there were no vehicle.
    """
    counts, doubtful = np.zeros(len(offsets), np.int64), []
    lidar.beams.expect(len(beam))
    for some in blocks(len(voxel), PAIRS_AT_ONCE):
        through, enter = _through(offsets, lidar, voxel[some], beam[some])
        pairs = voxel[some][through], beam[some][through]
        counts += np.bincount(pairs[0], minlength=len(counts))
        if not is_free:
            at = np.flatnonzero(lidar.ends.stopped[pairs[1]])
            doubtful.append((pairs[0][at], pairs[1][at], enter[at]))
    if doubtful:
        voxel, beam, reach = (np.concatenate(w) for w in zip(*doubtful, strict=True))
        early = reach > lidar.ends.some(beam) / lidar.side
        counts -= np.bincount(voxel[early], minlength=len(counts))
    return counts


def _through(offsets: Floats, lidar: PlacedLidar, voxel: Ints, beam: Ints) -> tuple[Ints, Floats]:
    """Pairs whose beam passes its cube in range, and where: `definition.cube_crossing` by axes."""
    enter, leave = np.zeros(len(voxel)), np.full(len(voxel), np.inf)
    for axis, step in enumerate(lidar.beams.speeds(beam)):
        center = offsets[voxel, axis]
        t0, t1 = (center - 0.5) / step, (center + 0.5) / step
        np.maximum(enter, np.minimum(t0, t1), out=enter)
        np.minimum(leave, np.maximum(t0, t1), out=leave)
    through = np.flatnonzero((enter < leave) & (enter <= lidar.longest))
    return through, enter[through]

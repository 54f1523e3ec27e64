"""Beams through single voxels: for each voxel the few beams that may touch it, tested exactly.

A cube seen from the sensor lies inside a window of azimuth and elevation that its half widths
bound. The beams of that window, taken from the LiDAR's own lattice, are put to the test of the
definition with the same arithmetic, so the count is the definition's to the last beam. For regular
LiDARs `lidar_bracket` settles most voxels without any test.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import rotate
from ...scene.raycast import ranges
from .bands import BeamBands
from .bracket import Bracket, ChannelTable, Singles, bracket
from .model import Lidar
from .upright import SlopeTable, Upright

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Counts = NDArray[np.int32]

WINDOW_MARGIN = 1e-7
"""Windows are widened by this [rad] against rounding."""
PAIRS_AT_ONCE = 1 << 16
CUBE_REACH = 2.0
"""No point of a unit cube is farther from its centre than this, rounding included."""


@dataclass(frozen=True, slots=True)
class Windows:
    """Directions a cube may cover, seen from the sensor, each (V,) [rad]."""

    azimuth: Floats
    half_azimuth: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True)
class Lattice:
    """A LiDAR's beams, sorted by elevation, for looking them up by direction."""

    channels: Ints
    elevations: Floats
    offsets: Floats
    step: float
    count: int
    position: Ints
    width: int
    table: ChannelTable | None
    slopes: SlopeTable | None
    bands: BeamBands | None

    @classmethod
    def of(cls, lidar: Lidar) -> Lattice:
        """Sort the channels, and say where in a channel each azimuth step is (-1: nowhere)."""
        channels = np.argsort(lidar.elevations, kind="stable")
        position = np.full(lidar.azimuth_count, -1)
        position[lidar.azimuth_steps % lidar.azimuth_count] = np.arange(len(lidar.azimuth_steps))
        full = len(lidar.azimuth_steps) == lidar.azimuth_count
        regular = full and lidar.azimuth_count > 1 and not lidar.azimuth_offsets.any()
        return cls(
            channels,
            lidar.elevations[channels],
            lidar.azimuth_offsets[channels],
            lidar.azimuth_step,
            lidar.azimuth_count,
            position,
            len(lidar.azimuth_steps),
            ChannelTable.of(lidar) if regular else None,
            SlopeTable.of(lidar) if regular else None,
            BeamBands.of(lidar.directions) if lidar.azimuth_count == 1 else None,
        )

    def window_beams(self, bounds: Bracket, voxels: Ints) -> tuple[Ints, Ints]:
        """(voxel, beam) pairs of the outer windows of some voxels, numbered as in `voxels`."""
        rows, columns = (n[voxels].astype(np.int64) for n in (bounds.rows, bounds.columns))
        n = rows * columns
        voxel = np.repeat(np.arange(len(voxels)), n)
        step, wide = ranges(n), np.repeat(columns, n)
        down = step // np.maximum(wide, 1)
        row = np.repeat(bounds.row[voxels], n) + down
        column = np.repeat(bounds.column[voxels], n) + (step - down * wide)
        return voxel, self.channels[row] * self.width + column % self.count

    def candidates(self, windows: Windows) -> tuple[Ints, Ints]:
        """(voxel, beam) pairs of the beams inside each voxel's window."""
        if self.bands is not None:
            half = windows.half_azimuth
            return self.bands.candidates(windows.azimuth, half, windows.low, windows.high)
        first = np.searchsorted(self.elevations, windows.low, side="left")
        n = np.searchsorted(self.elevations, windows.high, side="right") - first
        voxel = np.repeat(np.arange(len(n)), n)
        row = np.repeat(first, n) + ranges(n)
        middle = windows.azimuth[voxel] - self.offsets[row]
        half = windows.half_azimuth[voxel]
        j0 = np.ceil((middle - half) / self.step).astype(np.int64)
        n = np.floor((middle + half) / self.step).astype(np.int64) - j0 + 1
        n = np.clip(n, 0, self.count)
        j = (np.repeat(j0, n) + ranges(n)) % self.count
        at = self.position[j]
        beam = self.channels[np.repeat(row, n)] * self.width + at
        exists = at >= 0
        return np.repeat(voxel, n)[exists], beam[exists]


def windows_of(offsets: Floats, half: float, ground_from_sensor: Floats) -> Windows:
    """Bound the directions of cubes with half side `half` [m] at (V, 3) offsets from the sensor."""
    x, y, z = np.moveaxis(rotate(ground_from_sensor.T, offsets), -1, 0)
    flat = np.sqrt(x * x + y * y)
    c, s = x / np.maximum(flat, half), y / np.maximum(flat, half)
    axes = ground_from_sensor  # row k: ground axis k in the sensor frame
    radial = half * sum(np.abs(a[0] * c + a[1] * s) for a in axes)
    sideways = half * sum(np.abs(a[1] * c - a[0] * s) for a in axes)
    up = half * np.abs(axes[:, 2]).sum()
    near, far = flat - radial, np.sqrt((flat + radial) ** 2 + sideways**2)
    beside = near > 0.0
    room = np.where(beside, near, 1.0)
    high = np.arctan2(z + up, np.where(z + up > 0.0, room, far))
    low = np.arctan2(z - up, np.where(z - up > 0.0, far, room))
    return Windows(
        np.arctan2(y, x),
        np.where(beside, np.arctan2(sideways, room), np.pi) + WINDOW_MARGIN,
        np.where(beside, low, -np.pi) - WINDOW_MARGIN,
        np.where(beside, high, np.pi) + WINDOW_MARGIN,
    )


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
        return math.sqrt(float(gaps @ gaps))

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


def count_beams(
    voxels: VoxelPoints,
    position: Floats,
    lattice: Lattice,
    ground_from_sensor: Floats,
    directions: Floats,
    ends: Floats,
    enough: int | None = None,
) -> NDArray[np.signedinteger]:
    """Count the beams through voxels.

    Parameters
    ----------
    voxels : VoxelPoints
    position : (3,) float
        The sensor, seen from the grid's lowest corner, in voxel sides (`ties.position_in_voxels`).
    lattice : Lattice
    ground_from_sensor : (3, 3) float
    directions : (B, 3) float
        All beams of the lattice in the ground frame, without zeros.
    ends : (B,) float
        Where each beam ends, in voxel sides.
    enough : int, optional
        A count of this or more need not be exact: it may be told as any number from `enough` up to
        the count.

    Returns
    -------
    (V,) int
    """
    if lattice.table is None:
        offsets = voxels.offsets(position)
        voxel, beam = lattice.candidates(windows_of(offsets, 0.5, ground_from_sensor))
        return _count_pairs(offsets, directions, ends, voxel, beam)
    case = _Case(voxels, position, lattice, ground_from_sensor, directions, ends, enough)
    if lattice.slopes is None or ground_from_sensor[2, 2] != 1.0 or not len(voxels):
        return case.bracketed(slice(None))
    counts, unsure = case.upright()
    doubtful = np.flatnonzero(unsure)
    counts[doubtful] = case.bracketed(doubtful)
    return counts


@dataclass(frozen=True, slots=True)
class _Case:
    """What `count_beams` is given, for regular LiDARs."""

    voxels: VoxelPoints
    position: Floats
    lattice: Lattice
    ground_from_sensor: Floats
    directions: Floats
    ends: Floats
    enough: int | None

    def upright(self) -> tuple[Counts, NDArray[np.bool_]]:
        """Count for an upright LiDAR, and say where that is unsure."""
        assert self.lattice.slopes is not None
        longest = float(self.ends.max())
        early = self.ends < longest
        farthest = float(self.ends.max(where=early, initial=0.0))
        stopped = early.reshape(-1, self.lattice.width)[self.lattice.channels]
        upright = Upright.of(self.lattice.slopes, self.ground_from_sensor, stopped, farthest)
        counts, unsure = upright.count(self.voxels.corners, self.position)
        if self.voxels.farthest(self.position) > longest - CUBE_REACH:
            x, y, z = self.voxels.offsets_single(self.position)
            unsure |= x * x + y * y + z * z > max(longest - CUBE_REACH, 0.0) ** 2
        return counts, unsure

    def bracketed(self, some: Ints | slice) -> Ints:
        """Count the beams through some voxels: by bounds, and one by one where they differ."""
        points = self.voxels.offsets_single(self.position, some)
        lattice, ends = self.lattice, self.ends
        assert lattice.table is not None
        bounds = bracket(points, self.ground_from_sensor, lattice.table, lattice.count)
        counts = bounds.least.astype(np.int64)
        counts[_may_end_early(points, bounds, lattice, ends)] = 0
        limit = np.iinfo(np.int64).max if self.enough is None else self.enough
        doubtful = np.flatnonzero((counts < bounds.most) & (counts < limit))
        voxel, beam = lattice.window_beams(bounds, doubtful)
        where = doubtful if isinstance(some, slice) else some[doubtful]
        offsets = self.voxels.offsets(self.position, where)
        counts[doubtful] = _count_pairs(offsets, self.directions, ends, voxel, beam)
        return counts


def _may_end_early(
    points: Sequence[Singles], bounds: Bracket, lattice: Lattice, ends: Floats
) -> NDArray[np.bool_]:
    """Whether a beam of the voxel's window may end before it: at its range, or on the vehicle."""
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


def _count_pairs(
    offsets: Floats, directions: Floats, ends: Floats, voxel: Ints, beam: Ints
) -> Ints:
    """(V,) how many of the (voxel, beam) pairs are beams through their voxel."""
    counts = np.zeros(len(offsets), np.int64)
    for start in range(0, len(voxel), PAIRS_AT_ONCE):
        some = slice(start, start + PAIRS_AT_ONCE)
        through = _through(offsets, directions, ends, voxel[some], beam[some])
        counts += np.bincount(voxel[some][through], minlength=len(counts))
    return counts


def _through(
    offsets: Floats, directions: Floats, ends: Floats, voxel: Ints, beam: Ints
) -> NDArray[np.bool_]:
    """Whether each beam passes its cube: `measurement.cube_crossing`, an axis at a time."""
    enter, leave = np.zeros(len(voxel)), np.full(len(voxel), np.inf)
    for axis in range(3):
        step, center = directions[beam, axis], offsets[voxel, axis]
        t0, t1 = (center - 0.5) / step, (center + 0.5) / step
        np.maximum(enter, np.minimum(t0, t1), out=enter)
        np.minimum(leave, np.maximum(t0, t1), out=leave)
    return (enter < leave) & (enter <= ends[beam])

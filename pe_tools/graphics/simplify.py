"""A vehicle of fewer triangles, for meshes of millions: vertex clustering on a cubic grid.

All corners in one cube of the grid are replaced by their mean (Rossignac and Borrel, 1993). A
triangle with corners in three different cubes stays. Other triangles collapse. If all triangles of
a part collapse in a region (a thin rod, a bolt), one of its triangles is kept unchanged, so that no
part vanishes.

The surface error is bounded. A point of a triangle moves no farther than the corner that moves
farthest. A point of a collapsed triangle is then on a triangle that stayed. Otherwise its distance
from a triangle that was kept unchanged is at most the distance that the corners of that triangle
would have moved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats, Ints
from pe_core.base.values import Whole
from pe_core.geometry.poses import cross, dot
from pe_core.scene.vehicle import Vehicle

DEFAULT_TRIANGLES = 200_000
TRIANGLES = Whole(1000, 10**9, "triangles")
CLOSE = 0.85
MIDDLE = 0.93
CLOSE_QUICKLY = 0.5
"""Shares of the triangles wanted: from where on it is near enough, what is aimed at, and what is
near enough for previews. Cars keep 0.53 to 0.66 with the first cubes that are tried."""
TRIES = 8
MAX_CELLS_ACROSS = 1 << 20  # Cubes along an axis: three numbers fit into one
MIN_SIDE_M = 1e-9  # Minimum side of a cube [m], for a mesh without extent
MAX_INDEX = 1 << 62
TABLE = 1 << 26  # Numbers below this are counted in a table, others sorted


def simplified(
    vehicle: Vehicle, triangles: int = DEFAULT_TRIANGLES, *, quick: bool = False
) -> tuple[Vehicle, float]:
    """Return a vehicle with at most this number of triangles, and a bound of the surface error.

    Parameters
    ----------
    triangles : int
        1000 or more, else `InputError`.
    quick : bool
        Take the first size of cubes that leaves at least half as many: half the time, for previews.

    Returns
    -------
    vehicle : Vehicle
        With the same parts, glass and clearance; the same object if it has no more triangles. No
        part is lost, even if that needs more triangles.
    error_m : float
        No point of either surface is farther from the other one than this [m].
    """
    wanted = TRIANGLES.checked("simplify", "triangles", triangles)
    if len(vehicle.triangles) <= wanted:
        return vehicle, 0.0
    clusters, chosen = _fitting(vehicle, wanted, CLOSE_QUICKLY if quick else CLOSE)
    moved = clusters.middles[clusters.corners[chosen.staying]]
    corners = np.concatenate([moved, vehicle.triangles[chosen.kept]])
    parts = vehicle.parts[np.concatenate([chosen.staying, chosen.kept])]
    return replace(vehicle, triangles=corners, parts=parts), clusters.error(chosen)


@dataclass(frozen=True, slots=True)
class _Kept:
    """Triangles that stay with their corners moved, and those kept as they were: indices."""

    staying: Ints
    kept: Ints

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self.staying) + len(self.kept)


@dataclass(frozen=True, slots=True)
class _Clusters:
    """Cubes: `corners` (F, 3) which of them each corner is in, `middles` (C, 3) of their corners.
    `moves` (F,) is how far the farthest of a triangle's corners moves [m]."""

    corners: Ints
    middles: Floats
    moves: Floats

    @classmethod
    def of(cls, triangles: Floats, side: float) -> _Clusters:
        """Cluster corners in cubes of that side [m]."""
        points = triangles.reshape(-1, 3)
        index = np.floor((points - points.min(axis=0)) / side).astype(np.int64)
        cube, count = _counted(_numbers(index.T, (index.max(axis=0) + 1).tolist()))
        middles = np.stack([np.bincount(cube, w) / count for w in points.T], axis=1)
        away = points - middles[cube]
        moves = np.sqrt(dot(away, away)).reshape(-1, 3).max(axis=1)
        return cls(cube.reshape(-1, 3), middles, moves)

    def chosen(self, parts: NDArray[np.integer]) -> _Kept:
        """Choose triangles, by the part of each."""
        low = self.corners.min(axis=1)
        high = self.corners.max(axis=1)
        middle = self.corners.sum(axis=1) - low - high
        sizes = [len(self.middles)] * 3 + [int(parts.max()) + 1]
        is_flat = (low == middle) | (middle == high)
        whole = np.flatnonzero(~is_flat)
        flat = np.flatnonzero(is_flat)
        number = _numbers([w[whole] for w in (low, middle, high, parts)], sizes)
        staying = np.sort(whole[np.unique(number, return_index=True)[1]])
        line = _numbers([low, high, parts], sizes[1:])
        sides = [
            _numbers([a[staying], b[staying], parts[staying]], sizes[1:])
            for a, b in ((low, middle), (middle, high), (low, high))
        ]
        long = flat[low[flat] < high[flat]]
        short = flat[low[flat] == high[flat]]
        lines = _first_not_among(long, line, np.concatenate(sides))
        there = np.concatenate([staying, lines])
        ends = [
            _numbers([w[there], w[there], parts[there]], sizes[1:]) for w in (low, middle, high)
        ]
        points = _first_not_among(short, line, np.concatenate(ends))
        return _Kept(staying, np.sort(np.concatenate([lines, points])))

    def error(self, chosen: _Kept) -> float:
        """How far the surface moved at most [m]."""
        kept = float(self.moves[chosen.kept].max(initial=0.0))
        return float(self.moves.max()) + kept


def _fitting(vehicle: Vehicle, wanted: int, close: float) -> tuple[_Clusters, _Kept]:
    """Cluster in cubes as small as the number of triangles allows; it goes with their square."""
    min_side = (
        float(np.ptp(vehicle.triangles.reshape(-1, 3), axis=0).max()) / MAX_CELLS_ACROSS
        + MIN_SIDE_M
    )
    side = max(min_side, np.sqrt(3.0 * _area(vehicle.triangles) / wanted))
    best = None
    for attempt in range(2 * TRIES):
        clusters = _Clusters.of(vehicle.triangles, side)
        chosen = clusters.chosen(vehicle.parts)
        if chosen.count <= wanted and (best is None or chosen.count > best[1].count):
            best = clusters, chosen
        if best and (best[1].count >= close * wanted or attempt >= TRIES):
            break
        step = float(np.sqrt(chosen.count / (MIDDLE * wanted)))
        side = max(min_side, side * (step if attempt < TRIES else 2.0))
    return best or (clusters, chosen)  # in one cube there is a triangle a part


def _area(triangles: Floats) -> float:
    normals = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return float(np.sqrt(dot(normals, normals)).sum()) / 2.0


def _first_not_among(candidates: Ints, number: Ints, excluded: Ints) -> Ints:
    """Return the first index of each number that is not in `excluded`. `candidates` (C,) are
    indices into `number`."""
    candidates = candidates[~np.isin(number[candidates], excluded)]
    return candidates[np.unique(number[candidates], return_index=True)[1]]


def _numbers(columns: Sequence[NDArray[np.integer]], sizes: Sequence[int]) -> Ints:
    """Return one number (N,) for each row of `columns`: equal numbers mean equal rows. `sizes` are
    the exclusive upper bounds of the columns."""
    number = columns[0].astype(np.int64)
    span = sizes[0]
    for column, size in zip(columns[1:], sizes[1:], strict=True):
        if span * size >= MAX_INDEX:
            number, count = _counted(number)
            span = len(count)
        number = number * size + column
        span *= size
    return number


def _counted(numbers: Ints) -> tuple[Ints, Ints]:
    """Return the rank (N,) of each value among the distinct values, and the count of each."""
    if numbers.max() >= TABLE:
        _, which, count = np.unique(numbers, return_inverse=True, return_counts=True)
        return which, count
    table = np.bincount(numbers)
    return (np.cumsum(table > 0) - 1)[numbers], table[table > 0]

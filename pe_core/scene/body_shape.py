"""The shape of a body in figures: its size, its parts' places, how unlike its mirror images."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
PartBounds = tuple[Floats, Floats, NDArray[np.bool_]]
"""Lowest and highest corners (P, 3) of the parts, and which parts have any triangles."""

ROOM_M = 4.0
"""A part is as large as a room when two of its sides are this long [m]..."""
FAR_LARGER = 1.5
"""...and so many times as long as those of all smaller parts together."""
BINS, ENOUGH = 256, 100_000
"""Bins of a mesh's surface along an axis, and how many of its triangles are sorted into them."""


@dataclass(frozen=True, eq=False)
class BodyShape:
    """Triangles (F, 3, 3) [m] of named parts, looked at without a floor that came with them.

    Axes are those of the triangles, whatever they stand for.
    """

    triangles: Floats
    parts: NDArray[np.int32]
    part_names: Sequence[str]

    @cached_property
    def rooms(self) -> tuple[str, ...]:
        """Parts as large as a room."""
        return tuple(self.part_names[k] for k in _rooms(*self._part_bounds))

    @cached_property
    def is_ours(self) -> NDArray[np.bool_] | None:
        """(F,) which triangles are of no room; None: all of them."""
        if not self.rooms:
            return None
        names = list(self.part_names)
        return ~np.isin(self.parts, [names.index(name) for name in self.rooms])

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner (3,) without rooms [m]."""
        low, high, there = self._part_bounds
        kept = there & ~np.isin(np.arange(len(low)), _rooms(low, high, there))
        return low[kept].min(axis=0), high[kept].max(axis=0)

    @property
    def size(self) -> tuple[float, float, float]:
        """Extent along x, y, z without rooms [m]."""
        low, high = self.bounds
        x, y, z = (high - low).tolist()
        return x, y, z

    @cached_property
    def lopsided(self) -> tuple[float, float, float]:
        """How unlike its mirror image it is along x, y, z: 0 alike, 2 as unlike as can be.

        The distance that its surface has to be carried along the axis to become its mirror image,
        in half sides.
        """
        ours = self.triangles if self.is_ours is None else self.triangles[self.is_ours]
        every = -(-len(ours) // ENOUGH)
        triangles = ours[::every]
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        area = np.sqrt((normal * normal).sum(axis=1))
        x, y, z = (_lopsided(triangles[:, :, k].mean(axis=1), area) for k in range(3))
        return x, y, z

    def part_centers(self) -> dict[str, Floats]:
        """Middle of the bounds (3,) of every part that is no room [m], by name."""
        low, high, there = self._part_bounds
        named = ((self.part_names[k], k) for k in np.flatnonzero(there).tolist())
        return {name: (low[k] + high[k]) / 2.0 for name, k in named if name not in self.rooms}

    @cached_property
    def _part_bounds(self) -> PartBounds:
        return _part_bounds(self.triangles, np.asarray(self.parts), len(self.part_names))


def corner_bounds(triangles: Floats) -> tuple[Floats, Floats]:
    """Lowest and highest corner (3,) of triangles (F, 3, 3), F at least 1."""
    axes = [triangles[..., k] for k in range(3)]  # axis by axis: many times as fast
    return np.array([each.min() for each in axes]), np.array([each.max() for each in axes])


def _lopsided(at: Floats, area: Floats) -> float:
    low, high = float(at.min()), float(at.max())
    total = float(area.sum())
    if not (high > low and total > 0.0):
        return 0.0
    bins = np.minimum((at - low) * (BINS / (high - low)), BINS - 1).astype(np.int64)
    share = np.bincount(bins, area, BINS) / total
    return float(np.abs(np.cumsum(share) - np.cumsum(share[::-1])).sum()) * 2.0 / BINS


def _part_bounds(triangles: Floats, parts: NDArray[np.int32], count: int) -> PartBounds:
    starts = np.concatenate([[0], np.flatnonzero(np.diff(parts)) + 1])  # runs of one part
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    least, most = _bounds_of_runs(triangles, starts)
    np.minimum.at(low, parts[starts], least)
    np.maximum.at(high, parts[starts], most)
    return low, high, np.isfinite(low[:, 0])


def _bounds_of_runs(triangles: Floats, starts: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Lowest and highest corner (R, 3) of each run of triangles."""
    stops = np.append(starts[1:], len(triangles))
    if len(starts) < FEW_RUNS:
        pairs = [corner_bounds(triangles[a:b]) for a, b in zip(starts, stops, strict=True)]
        return np.array([low for low, _ in pairs]), np.array([high for _, high in pairs])
    a, b, c = (triangles[:, k] for k in range(3))
    least, most = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    low = np.minimum.reduceat(least, starts, axis=0)
    return low, np.maximum.reduceat(most, starts, axis=0)


FEW_RUNS = 1000
"""Runs of triangles that are quicker to look at one by one."""


def _rooms(low: Floats, high: Floats, there: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Find the parts that are far larger, two ways, than all parts that no room could be."""
    size = np.where(there[:, None], high - low, 0.0)
    longest = np.sort(size, axis=1)[:, ::-1]
    large = there & (longest[:, 1] >= ROOM_M)
    rest = there & ~large
    if not (large.any() and rest.any()):
        return np.zeros(0, np.int64)
    others = np.sort(high[rest].max(axis=0) - low[rest].min(axis=0))[::-1]
    larger = (longest[:, :2] >= FAR_LARGER * others[:2]).all(axis=1)
    return np.flatnonzero(large & larger)

"""Entropies of whole x-planes of the grid: eqs. 4 to 8 by look-up.

The precision 1 / sigma^2 that a group adds to a blind one's is a table: over beam counts for a
LiDAR, over pixel areas rounded to a few digits for a camera. Fusing is then an addition, and one
logarithm a voxel in view of a camera; elsewhere a lone LiDAR group's entropy is a table too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .entropy import BLIND_PRECISION, entropy_of
from .fusion import Fusion

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SeenRows:
    """Pixels (n, rows, nz) covered by the voxels of some x-planes; 0 outside these rows (y)."""

    rows: slice
    area: NDArray[np.float32]

    def __add__(self, other: SeenRows) -> SeenRows:
        """Sum of two views of the same planes."""
        if not (self.area.size and other.area.size):
            return self if self.area.size else other
        start = min(self.rows.start, other.rows.start)
        stop = max(self.rows.stop, other.rows.stop)
        n, _, nz = self.area.shape
        area = np.zeros((n, stop - start, nz), np.float32)
        for view in (self, other):
            area[:, view.rows.start - start : view.rows.stop - start] += view.area
        return SeenRows(slice(start, stop), area)


Group = tuple[str, NDArray | SeenRows]
"""Kind of a fusion group, and its beams (n, ny, nz) or its pixels on some x-planes."""

DIGITS = 11
"""Binary digits of a pixel area that are looked at: what is left out is below 1 part in 2048."""
SHIFT = 24 - DIGITS
LEAST_OCTAVE, OCTAVES = -32, 64
"""Areas from 2^-32 px on are told apart: far below what `camera_area` takes for nothing."""


class PlaneFusion:
    """Fuses measurements of planes of (ny, nz) voxels under the model of a `Fusion`."""

    def __init__(self, fusion: Fusion, shape: tuple[int, int]) -> None:
        self._fusion, self._shape = fusion, shape
        self._beams = fusion.precision(np.arange(fusion.enough + 1), "lidar") - BLIND_PRECISION
        self._alone: dict[int, Floats] = {}

    def entropies(self, groups: Sequence[Group], plane: int) -> Floats:
        """Entropy H (ny, nz) of the voxels of one of the planes [nats]."""
        counts, views = _planes(groups, plane)
        blind = 1 if self._fusion.model.blind == "floor" else len(groups)
        if len(counts) == 1:
            found = np.take(self._alone_table(blind), counts[0], mode="clip")
        else:
            found = entropy_of(self._counted(counts, blind, slice(None)))
        rows = _rows_of(views)
        if rows.stop > rows.start:
            precision = self._counted(counts, blind, rows)
            for own, area in views:
                precision[own.start - rows.start : own.stop - rows.start] += self._shown(area)
            found[rows] = entropy_of(precision)
        return found

    def seen(self, groups: Sequence[Group], plane: int) -> NDArray[np.bool_]:
        """Whether any group sees the voxels (ny, nz) of one of the planes."""
        counts, views = _planes(groups, plane)
        found = np.zeros(self._shape, bool) if not counts else counts[0] > 0
        for more in counts[1:]:
            found |= more > 0
        for rows, area in views:
            found[rows] |= area > 0.0
        return found

    def _counted(self, counts: Sequence[NDArray], blind: int, rows: slice) -> Floats:
        """1 / sigma^2 of so many blind groups and what the LiDAR groups add, in some rows."""
        total = np.full(self._shape, blind * BLIND_PRECISION)[rows]
        for beams in counts:
            total += np.take(self._beams, beams[rows], mode="clip")
        return total

    def _alone_table(self, blind: int) -> Floats:
        """Entropy of a LiDAR group by its beams, among so many blind groups."""
        if blind not in self._alone:
            self._alone[blind] = entropy_of(self._beams + blind * BLIND_PRECISION)
        return self._alone[blind]

    def _shown(self, area: NDArray[np.float32]) -> Floats:
        """What pixels add to 1 / sigma^2; by the digits of the floating-point number."""
        code = np.right_shift(area.view(np.int32), SHIFT)
        code -= _CODES[0]
        return np.take(self._pixels, code, mode="clip")

    @cached_property
    def _pixels(self) -> Floats:
        """What each code of an area adds to 1 / sigma^2, in the middle of what it stands for."""
        middle = (_CODES << SHIFT) + (1 << SHIFT - 1)
        added = self._fusion.precision(middle.view(np.float32), "camera") - BLIND_PRECISION
        added[0] = 0.0
        return added


_CODES = np.arange(OCTAVES << DIGITS - 1, dtype=np.int32) + (127 + LEAST_OCTAVE << DIGITS - 1)
"""Leading digits, exponent first, of the single-precision numbers that stand for an area."""


def _planes(
    groups: Sequence[Group], plane: int
) -> tuple[list[NDArray], list[tuple[slice, NDArray[np.float32]]]]:
    """One plane of every LiDAR group, and of every camera group that sees any of the planes."""
    counts, views = [], []
    for _, measured in groups:
        if not isinstance(measured, SeenRows):
            counts.append(measured[plane])
        elif measured.area.size:
            views.append((measured.rows, measured.area[plane]))
    return counts, views


def _rows_of(views: Sequence[tuple[slice, NDArray]]) -> slice:
    """The rows from the first to the last in any view."""
    starts, stops = [rows.start for rows, _ in views], [rows.stop for rows, _ in views]
    return slice(min(starts, default=0), max(stops, default=0))

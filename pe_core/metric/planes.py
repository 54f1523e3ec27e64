"""Entropies of whole x-planes of the grid: eqs. 4 to 8 by look-up.

The precision 1 / sigma^2 that a group adds to a blind one's is a table: over whole numbers (beams),
or over single-precision numbers (areas in pixels) rounded to a few digits. Fusing is then an
addition, and one logarithm a voxel that is seen in part of the rows; elsewhere the entropy of a
lone group of whole numbers is a table too. Double precision is not rounded but computed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .entropy import BLIND_PRECISION, H_BLIND, entropy_of
from .fusion import CurveOf, Fusion

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SeenRows:
    """m (n, rows, nz) of the voxels of some x-planes that is not 0 in these rows (y) alone.

    In single precision m is good to a few digits; in double precision it is taken as it is.
    """

    rows: slice
    m: NDArray[np.floating]

    def __add__(self, other: SeenRows) -> SeenRows:
        """Sum of two of the same planes."""
        if not (self.m.size and other.m.size):
            return self if self.m.size else other
        start = min(self.rows.start, other.rows.start)
        stop = max(self.rows.stop, other.rows.stop)
        n, _, nz = self.m.shape
        total = np.zeros((n, stop - start, nz), np.result_type(self.m, other.m))
        for each in (self, other):
            total[:, each.rows.start - start : each.rows.stop - start] += each.m
        return SeenRows(slice(start, stop), total)


Group = tuple[CurveOf, NDArray | SeenRows]
"""Curve of a fusion group, and its m on some x-planes: whole numbers (n, ny, nz), or seen rows."""
Counted = tuple[CurveOf, NDArray]
Shown = tuple[CurveOf, slice, NDArray[np.floating]]

DIGITS = 11
"""Binary digits of a pixel area that are looked at: what is left out is below 1 part in 2048."""
SHIFT = 24 - DIGITS
LEAST_OCTAVE, OCTAVES = -32, 64
"""Areas from 2^-32 px on are told apart: far below what a camera's exact area takes for nothing."""


class PlaneFusion:
    """Fuses measurements of planes of (ny, nz) voxels under the model of a `Fusion`."""

    def __init__(self, fusion: Fusion, shape: tuple[int, int]) -> None:
        self._fusion, self._shape = fusion, shape
        self._known: dict[tuple[str, CurveOf, int], Floats] = {}
        """Tables by what they are of, kind and number of blind groups: two a kind, and one more for
        each number of groups that was asked for (by the floor rule, one)."""

    def entropies(self, groups: Sequence[Group], plane: int) -> Floats:
        """Entropy H (ny, nz) of the voxels of one of the planes [nats]."""
        counts, views = _planes(groups, plane)
        blind = 1 if self._fusion.model.blind == "floor" else len(groups)
        if len(counts) == 1:
            ((kind, m),) = counts
            found = np.take(self._alone(kind, blind), m, mode="clip")
        else:
            found = entropy_of(self._counted(counts, blind, slice(None)))
        rows = _rows_of(views)
        if rows.stop > rows.start:
            precision = self._counted(counts, blind, rows)
            for kind, own, m in views:
                precision[own.start - rows.start : own.stop - rows.start] += self._shown(kind, m)
            found[rows] = entropy_of(precision)
        return found

    def seen(self, groups: Sequence[Group], plane: int) -> NDArray[np.bool_]:
        """Whether any group sees the voxels (ny, nz) of one of the planes."""
        counts, views = _planes(groups, plane)
        found = np.zeros(self._shape, bool) if not counts else counts[0][1] > 0
        for _, more in counts[1:]:
            found |= more > 0
        for _, rows, m in views:
            found[rows] |= m > 0.0
        return found

    def added(self, kind: CurveOf, m: NDArray) -> Floats:
        """What m of a group adds to the 1 / sigma^2 of a blind one."""
        if m.dtype.kind in "iu":
            return np.take(self._by_count(kind), m, mode="clip")
        return self._shown(kind, np.ascontiguousarray(m))

    def gained(self, kind: CurveOf) -> Floats:
        """Entropy of a lone group by its whole numbers, less that of a blind one."""
        return self._kept(("gained", kind, 1), lambda: self._alone(kind, 1) - H_BLIND)

    def _counted(self, counts: Sequence[Counted], blind: int, rows: slice) -> Floats:
        """1 / sigma^2 of so many blind groups and what whole numbers add, in some rows."""
        total = np.full(self._shape, blind * BLIND_PRECISION)[rows]
        for kind, m in counts:
            total += np.take(self._by_count(kind), m[rows], mode="clip")
        return total

    def _shown(self, kind: CurveOf, m: NDArray) -> Floats:
        """What m adds to 1 / sigma^2; for single precision by the digits of the number."""
        if m.dtype != np.float32:
            return np.where(m > 0.0, self._fusion.precision(m, kind) - BLIND_PRECISION, 0.0)
        code = np.right_shift(m.view(np.int32), SHIFT)
        code -= _CODES[0]
        return np.take(self._by_digits(kind), code, mode="clip")

    def _by_count(self, kind: CurveOf) -> Floats:
        """What each whole number adds to 1 / sigma^2."""
        return self._kept(("count", kind, 0), lambda: self._added_by_counts(kind))

    def _alone(self, kind: CurveOf, blind: int) -> Floats:
        """Entropy of a group by its whole numbers, among so many blind groups."""
        added = self._by_count(kind)
        return self._kept(
            ("alone", kind, blind), lambda: entropy_of(added + blind * BLIND_PRECISION)
        )

    def _by_digits(self, kind: CurveOf) -> Floats:
        """What each code of a number adds to 1 / sigma^2."""
        return self._kept(("digits", kind, 0), lambda: self._added_by_digits(kind))

    def _added_by_counts(self, kind: CurveOf) -> Floats:
        return self._fusion.tables(kind).precision - BLIND_PRECISION

    def _added_by_digits(self, kind: CurveOf) -> Floats:
        """In the middle of what each code stands for."""
        middle = (_CODES << SHIFT) + (1 << SHIFT - 1)
        added = self._fusion.precision(middle.view(np.float32), kind) - BLIND_PRECISION
        added[0] = 0.0
        return added

    def _kept(self, key: tuple[str, CurveOf, int], make: Callable[[], Floats]) -> Floats:
        if key not in self._known:
            self._known[key] = make()
        return self._known[key]


_CODES = np.arange(OCTAVES << DIGITS - 1, dtype=np.int32) + (127 + LEAST_OCTAVE << DIGITS - 1)
"""Leading digits, exponent first, of the single-precision numbers that stand for an area."""


def _planes(groups: Sequence[Group], plane: int) -> tuple[list[Counted], list[Shown]]:
    """One plane of every group of whole numbers, and of the others that see any of the planes."""
    counts, views = [], []
    for kind, measured in groups:
        if not isinstance(measured, SeenRows):
            counts.append((kind, measured[plane]))
        elif measured.m.size:
            views.append((kind, measured.rows, measured.m[plane]))
    return counts, views


def _rows_of(views: Sequence[Shown]) -> slice:
    """The rows from the first to the last in any view."""
    starts, stops = [rows.start for _, rows, _ in views], [rows.stop for _, rows, _ in views]
    return slice(min(starts, default=0), max(stops, default=0))

"""What each sensor of a rig is worth: alone, and to the others, in one pass over the planes.

Both differ from what is known, blindness and the whole rig, only where the sensor sees something.
What the others add to 1 / sigma^2 is summed from the first group on and from the last one back: it
takes as many additions as there are groups, and nothing is subtracted, which would cost digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .entropy import BLIND_PRECISION, H_BLIND, entropy_of
from .fusion import CurveOf, group_sum
from .planes import Group, PlaneFusion, SeenRows

Floats = NDArray[np.float64]


class OnPlane(NamedTuple):
    """m of a sensor or a group on a plane, in some rows; it is 0 in all others."""

    kind: CurveOf
    rows: slice
    m: NDArray


class SensorSums(NamedTuple):
    """Weighed sums over voxels, (S,) each: of the entropy that the sensor takes away from what the
    others leave, of what it takes away alone from blindness, and of what it sees."""

    lost: Floats
    gained: Floats
    seen: Floats


class MemberSums:
    """Sums over planes for the sensors of fusion groups, whose sums are `totals`; floor rule."""

    def __init__(
        self, fused: PlaneFusion, groups: Sequence[Sequence[Group]], totals: Sequence[Group]
    ) -> None:
        self._fused, self._groups, self._totals = fused, groups, totals
        self._rests = [_rests(members) for members in groups]

    def of_plane(self, plane: int, whole: Floats, weights: Floats) -> Floats:
        """Return the sums (3, S) of a plane, whose entropies and weights are (ny, nz)."""
        totals = [_on_plane(total, plane) for total in self._totals]
        others = self._others(totals, whole.shape)
        found = []
        for k, members in enumerate(self._groups):
            for s, own in enumerate(members):
                mine = _on_plane(own, plane)
                at = np.flatnonzero(mine.m != 0)
                if not at.size:
                    found.append((0.0, 0.0, 0.0))
                    continue
                m, weight = mine.m.reshape(-1).take(at, mode="clip"), _taken(weights, mine.rows, at)
                rest = self._rests[k], s, plane
                gone = entropy_of(self._without(mine, at, m, totals[k], others[k], *rest))
                gone -= _taken(whole, mine.rows, at)
                gone *= weight  # in place: a new array costs as much as the product
                gained = self._gained(mine.kind, m)
                gained *= weight
                found.append((gone.sum(), gained.sum(), weight.sum()))
        return np.array(found).T

    def _without(
        self,
        mine: OnPlane,
        at: NDArray[np.int64],
        m: NDArray,
        total: OnPlane,
        others: Floats,
        rests: Sequence[Group] | None,
        s: int,
        plane: int,
    ) -> Floats:
        """1 / sigma^2 of all sensors but one, where that one sees something."""
        rows = slice(mine.rows.start - total.rows.start, mine.rows.stop - total.rows.start)
        left = _taken(others, rows, at)
        if rests is None:
            return left
        if rests == ():  # whole numbers: what is left of their sum is exact
            rest = _taken(total.m, rows, at) - m
            left += self._fused.added(mine.kind, rest)
        else:
            left += (
                self._added(_on_plane(rests[s], plane), mine.rows).reshape(-1).take(at, mode="clip")
            )
        return left

    def _added(self, own: OnPlane, rows: slice) -> Floats:
        """What a sensor adds to 1 / sigma^2 in rows that may be others than its own."""
        added = np.zeros((rows.stop - rows.start, own.m.shape[-1]))
        start, stop = max(rows.start, own.rows.start), min(rows.stop, own.rows.stop)
        if start < stop:
            some = own.m[start - own.rows.start : stop - own.rows.start]
            added[start - rows.start : stop - rows.start] = self._fused.added(own.kind, some)
        return added

    def _gained(self, kind: CurveOf, m: NDArray) -> Floats:
        """Entropy of one sensor alone, less that of none."""
        if m.dtype.kind in "iu":
            return self._fused.gained(kind).take(m, mode="clip")
        return entropy_of(self._fused.added(kind, m) + BLIND_PRECISION) - H_BLIND

    def _others(self, totals: Sequence[OnPlane], shape: tuple[int, ...]) -> list[Floats]:
        """1 / sigma^2 of all groups but one, in the rows of that one; of each."""
        added = [self._fused.added(each.kind, each.m) for each in totals]
        found, so_far = [], np.full(shape, BLIND_PRECISION)
        for each, more in zip(totals, added, strict=True):
            found.append(so_far[each.rows].copy())
            so_far[each.rows] += more
        so_far = np.zeros(shape)
        for k in range(len(totals) - 1, -1, -1):
            rows = totals[k].rows
            found[k] += so_far[rows]
            so_far[rows] += added[k]
        return found


def _rests(members: Sequence[Group]) -> Sequence[Group] | None:
    """A group without each of its sensors: None for a lone one, () where a difference says it."""
    if len(members) == 1:
        return None
    if not any(isinstance(m, SeenRows) for _, m in members):
        return ()
    return [
        (kind, group_sum([m for j, (_, m) in enumerate(members) if j != k]))
        for k, (kind, _) in enumerate(members)
    ]


def _taken(values: NDArray, rows: slice, at: NDArray[np.int64]) -> NDArray:
    """Values (ny, nz) at places that are counted from the first of some rows."""
    return values[rows].reshape(-1).take(at, mode="clip")


def _on_plane(own: Group, plane: int) -> OnPlane:
    kind, measured = own
    if not isinstance(measured, SeenRows):
        m = measured[plane]
        return OnPlane(kind, slice(0, len(m)), m)
    if not measured.m.size:
        return OnPlane(kind, slice(0, 0), np.zeros((0, measured.m.shape[-1]), measured.m.dtype))
    return OnPlane(kind, measured.rows, measured.m[plane])

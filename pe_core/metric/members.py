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
    """Sums over planes for the sensors of fusion groups, by the floor rule."""

    def __init__(self, fused: PlaneFusion, groups: Sequence[Sequence[Group]]) -> None:
        self._fused, self._groups = fused, groups
        self._rests = [_rests(members) for members in groups]
        self._totals = [(members[0][0], group_sum([m for _, m in members])) for members in groups]

    def of_plane(self, plane: int, whole: Floats, weights: Floats) -> Floats:
        """Return the sums (3, S) of a plane, whose entropies and weights are (ny, nz)."""
        totals = [_on_plane(total, plane) for total in self._totals]
        others = self._others(totals, whole.shape)
        found = []
        for k, members in enumerate(self._groups):
            for s, own in enumerate(members):
                mine = _on_plane(own, plane)
                at = np.flatnonzero(mine.m)
                if not at.size:
                    found.append((0.0, 0.0, 0.0))
                    continue
                without = self._without(mine, at, totals[k], others[k], self._rests[k], s, plane)
                weight = weights[mine.rows].reshape(-1)[at]
                gone = entropy_of(without) - whole[mine.rows].reshape(-1)[at]
                alone = self._alone(mine, at) - H_BLIND
                found.append(((gone * weight).sum(), (alone * weight).sum(), weight.sum()))
        return np.array(found).T

    def _without(
        self,
        mine: OnPlane,
        at: NDArray[np.int64],
        total: OnPlane,
        others: Floats,
        rests: Sequence[Group] | None,
        s: int,
        plane: int,
    ) -> Floats:
        """1 / sigma^2 of all sensors but one, where that one sees something."""
        rows = slice(mine.rows.start - total.rows.start, mine.rows.stop - total.rows.start)
        left = others[rows].reshape(-1)[at]
        if rests is None:
            return left
        if rests == ():  # whole numbers: what is left of their sum is exact
            rest = total.m[rows].reshape(-1)[at] - mine.m.reshape(-1)[at]
            return left + self._fused.added(mine.kind, rest)
        return left + self._added(_on_plane(rests[s], plane), mine.rows).reshape(-1)[at]

    def _added(self, own: OnPlane, rows: slice) -> Floats:
        """What a sensor adds to 1 / sigma^2 in rows that may be others than its own."""
        added = np.zeros((rows.stop - rows.start, own.m.shape[-1]))
        start, stop = max(rows.start, own.rows.start), min(rows.stop, own.rows.stop)
        if start < stop:
            some = own.m[start - own.rows.start : stop - own.rows.start]
            added[start - rows.start : stop - rows.start] = self._fused.added(own.kind, some)
        return added

    def _alone(self, mine: OnPlane, at: NDArray[np.int64]) -> Floats:
        """Entropy of one sensor alone, where it sees something."""
        m = mine.m.reshape(-1)[at]
        if mine.m.dtype.kind in "iu":
            return np.take(self._fused.alone(mine.kind), m, mode="clip")
        return entropy_of(self._fused.added(mine.kind, m) + BLIND_PRECISION)

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


def _on_plane(own: Group, plane: int) -> OnPlane:
    kind, measured = own
    if not isinstance(measured, SeenRows):
        m = measured[plane]
        return OnPlane(kind, slice(0, len(m)), m)
    if not measured.m.size:
        return OnPlane(kind, slice(0, 0), np.zeros((0, measured.m.shape[-1]), measured.m.dtype))
    return OnPlane(kind, measured.rows, measured.m[plane])

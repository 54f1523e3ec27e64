"""Marginal contribution of each sensor of a rig: the rig without it, and the sensor alone.

All sums are taken in one pass over the planes. Without a sensor, entropies differ from those of the
rig only at the voxels that it sees; those of the sensor alone differ from blindness only there,
too. What the other groups add to 1 / sigma^2 is summed once forwards and once backwards over the
groups: as many additions as there are groups, and no subtraction, which would cost digits. The
floor rule for blind sensors is assumed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from .entropy import BLIND_PRECISION, H_BLIND, entropy_of
from .fusion import CurveOf, Group, PlaneFusion, VisibleRows, group_sum


class RowValues(NamedTuple):
    """Values (rows, nz) of a plane in some rows (y)."""

    rows: slice
    values: NDArray

    def at(self, visible: VisibleVoxels) -> NDArray:
        """Values (N,) at the voxels that a sensor sees, whose rows are within these."""
        rows = slice(visible.rows.start - self.rows.start, visible.rows.stop - self.rows.start)
        return self.values[rows].reshape(-1).take(visible.position, mode="clip")


class VisibleVoxels(NamedTuple):
    """Voxels of a plane with m > 0 for one sensor: their position (N,) in the rows, and m (N,)."""

    kind: CurveOf
    rows: slice
    position: Ints
    m: NDArray

    @classmethod
    def of(cls, sensor: Group, plane: int) -> VisibleVoxels:
        """Return the voxels of a plane that a sensor sees."""
        rows, m = _on_plane(sensor, plane)
        position = np.flatnonzero(m != 0)
        return cls(sensor[0], rows, position, m.reshape(-1).take(position, mode="clip"))


class LeaveOneOut:
    """Sums over planes for each sensor S of the fusion groups.

    `groups` are the measurements of the sensors of each fusion group, `totals` (G,) their sums.
    """

    def __init__(
        self, fused: PlaneFusion, groups: Sequence[Sequence[Group]], totals: Sequence[Group]
    ) -> None:
        self._fused = fused
        self._groups = [_FusionGroup(*pair) for pair in zip(groups, totals, strict=True)]

    def of_plane(self, plane: int, entropies: Floats, weights: Floats) -> Floats:
        """Return weighted sums (3, S) over the voxels of a plane that each sensor sees.

        Row 0: entropy without the sensor, less that of the rig. Row 1: entropy of the sensor
        alone, less that of a blind voxel. Row 2: the weights. `entropies` (ny, nz) are those of the
        rig, `weights` (ny, nz) the prior.
        """
        whole, weighing = (RowValues(slice(0, len(w)), w) for w in (entropies, weights))
        sums = []
        for group, others in zip(self._groups, self._others(plane, entropies.shape), strict=True):
            for rank, sensor in enumerate(group.sensors):
                visible = VisibleVoxels.of(sensor, plane)
                if not visible.position.size:
                    sums.append((0.0, 0.0, 0.0))
                    continue
                weight, precision = weighing.at(visible), others.at(visible)
                self._add_rest(group, precision, rank, visible, plane)
                lost = entropy_of(precision)
                lost -= whole.at(visible)
                lost *= weight  # in place: a new array costs as much as the product
                gained = self._gained(visible)
                gained *= weight
                sums.append((lost.sum(), gained.sum(), weight.sum()))
        return np.array(sums).T

    def _add_rest(
        self,
        group: _FusionGroup,
        precision: Floats,
        rank: int,
        visible: VisibleVoxels,
        plane: int,
    ) -> None:
        """Add to 1 / sigma^2 (N,) what a group adds without its sensor `rank`."""
        if len(group.sensors) == 1:
            return
        if not group.rests:
            rest = RowValues(*_on_plane(group.total, plane)).at(visible) - visible.m
            precision += self._fused.added(visible.kind, rest)
            return
        kind, others = group.rests[rank][0], RowValues(*_on_plane(group.rests[rank], plane))
        rows, nz = visible.rows, others.values.shape[-1]
        added = np.zeros((rows.stop - rows.start, nz))
        start, stop = max(rows.start, others.rows.start), min(rows.stop, others.rows.stop)
        if start < stop:  # the sum over the others may cover other rows
            m = others.values[start - others.rows.start : stop - others.rows.start]
            added[start - rows.start : stop - rows.start] = self._fused.added(kind, m)
        precision += RowValues(rows, added).at(visible)

    def _gained(self, visible: VisibleVoxels) -> Floats:
        """Entropy (N,) of one sensor alone, less that of a blind voxel."""
        if visible.m.dtype.kind in "iu":
            return self._fused.gained(visible.kind).take(visible.m, mode="clip")
        return entropy_of(self._fused.added(visible.kind, visible.m) + BLIND_PRECISION) - H_BLIND

    def _others(self, plane: int, shape: tuple[int, ...]) -> list[RowValues]:
        """1 / sigma^2 of all groups but one, in the rows of that group; for each group."""
        totals = [RowValues(*_on_plane(group.total, plane)) for group in self._groups]
        added = [
            self._fused.added(group.total[0], total.values)
            for group, total in zip(self._groups, totals, strict=True)
        ]
        others, so_far = [], np.full(shape, BLIND_PRECISION)
        for total, more in zip(totals, added, strict=True):
            others.append(RowValues(total.rows, so_far[total.rows].copy()))
            so_far[total.rows] += more
        so_far = np.zeros(shape)
        for rank in range(len(totals) - 1, -1, -1):
            rows = totals[rank].rows
            others[rank].values[...] += so_far[rows]
            so_far[rows] += added[rank]
        return others


class _FusionGroup:
    """A fusion group: the measurements of its sensors, and their sum.

    Of a group with areas a difference would lose digits, so `rests` are the sums over the sensors
    but each one. Other groups count in whole numbers: the sum less the sensor's count is exact.
    """

    def __init__(self, sensors: Sequence[Group], total: Group) -> None:
        self.sensors, self.total = sensors, total
        self.rests: list[Group] = []
        if len(sensors) > 1 and any(isinstance(m, VisibleRows) for _, m in sensors):
            self.rests = [
                (kind, group_sum([m for j, (_, m) in enumerate(sensors) if j != k]))
                for k, (kind, _) in enumerate(sensors)
            ]


def _on_plane(group: Group, plane: int) -> tuple[slice, NDArray]:
    """Rows of a plane in which m may be above 0, and m (rows, nz) there."""
    _, measured = group
    if not isinstance(measured, VisibleRows):
        m = measured[plane]
        return slice(0, len(m)), m
    if not measured.m.size:
        return slice(0, 0), np.zeros((0, measured.m.shape[-1]), measured.m.dtype)
    return measured.rows, measured.m[plane]

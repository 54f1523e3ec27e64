"""Fusion (equations 6 and 7), the entropy of fused groups by lookup tables (4 to 8), leave-one-out.

The plain definitions come first (`early_fusion`, `late_fusion`); tests compare the tables to them.

An integer m, a count of beams, soon saturates AP, so its 1 / sigma^2 is tabulated, and also its
entropy if no other group sees the voxel. `Fusion` works on any voxels. `PlaneFusion` works on whole
x-planes of the grid, where each group sees only some rows: pixel areas in single precision are
looked up, too, rounded to a few digits. Fusing is then an addition and one logarithm per voxel.
Double precision is not rounded, but computed.

`LeaveOneOut` gives the marginal contribution of each sensor of a rig: the rig without it, and the
sensor alone. All sums are taken in one pass over the planes. Without a sensor, entropies differ
from those of the rig only at the voxels that it sees; those of the sensor alone differ from
blindness only there, too. What the other groups add to 1 / sigma^2 is summed once forwards and once
backwards over the groups: as many additions as there are groups, and no subtraction, which would
cost digits. The floor rule for blind sensors is assumed.
"""

import weakref
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats, Ints
from .entropy import (
    BLIND_PRECISION,
    H_BLIND,
    ApCurve,
    CurveOf,
    OwnCurve,
    entropy_of,
    precision_of,
    ranged,
)
from .frames import Frames

Measurement = tuple[CurveOf, NDArray]
"""Curve and m of a fusion group: integers (beams) or floats (pixels)."""
MAX_TABLE = (1 << 16) - 1  # Counts are stored in 16 bits
AREAS_KEPT = 8  # Arrays of areas whose 1 / sigma^2 is cached
MAX_BYTE_COUNTS = 257  # Maximum number of 8-bit counts whose sum fits 16 bits
GroupCounts = tuple[CurveOf, NDArray]
Areas = tuple[CurveOf, slice, NDArray[np.floating]]
DIGITS = 11
"""Binary digits of a pixel area that are used: the rest is below 1 part in 2048."""
SHIFT = 24 - DIGITS
FIRST_OCTAVE = -32
OCTAVES = 64
"""Table from 2^-32 px on: far below the rounding of a camera's exact area."""
_CODES = np.arange(OCTAVES << DIGITS - 1, dtype=np.int32) + (127 + FIRST_OCTAVE << DIGITS - 1)
"""Leading bits, exponent first, of the single-precision numbers in the table."""


class Curves(Protocol):
    """The part of a perception model that fusion needs: AP curves, the rule for blind sensors."""

    @property
    def blind(self) -> str:
        """Rule for blind sensors."""

    @property
    def frames(self) -> Frames | None:
        """Frames that an entropy is of; None: one."""

    def curve(self, kind: str) -> ApCurve:
        """Return the AP curve of a kind of sensor."""


def early_fusion(measurements: Iterable[ArrayLike]) -> Floats:
    """m of a fusion group: the sum over its sensors, eq. 6."""
    return np.asarray(sum(np.asarray(m, dtype=float) for m in measurements), dtype=float)


def group_sum(measured: Sequence[Any]) -> Any:
    """Sum measurements of kernels (eq. 6): arrays of counts, `VisibleRows`, or other arrays."""
    if len(measured) == 1:
        return measured[0]
    if not (isinstance(measured[0], np.ndarray) and is_whole(measured[0])):
        return reduce(add, measured)
    is_short = all(m.itemsize == 1 for m in measured) and len(measured) <= MAX_BYTE_COUNTS
    total = measured[0].astype(np.uint16 if is_short else np.uint32)
    for m in measured[1:]:
        np.add(total, m, out=total, casting="unsafe")
    return total


def late_fusion(precisions: Iterable[ArrayLike], blind: str = "floor") -> Floats:
    """Fuse 1 / sigma^2 over fusion groups, eq. 7; returns the fused 1 / sigma^2.

    "floor" sums the precision above that of a blind sensor, f = 1 / 999^2:
    ``f + sum(1 / sigma_i^2 - f)``. "literal" is the plain sum of eq. 7 as printed.
    """
    floor = BLIND_PRECISION if blind == "floor" else 0.0
    fused = sum(np.asarray(p, dtype=float) - floor for p in precisions)
    return np.asarray(fused + floor, dtype=float)


class CountTables(NamedTuple):
    """1 / sigma^2 and entropy of a single group for m = 0, 1, ... up to the saturation count."""

    precision: Floats
    entropy: Floats


class Fusion:
    """Fusion of measurements under one perception model, with tables for integer m."""

    def __init__(self, model: Curves) -> None:
        self.model = model
        self._tables: dict[CurveOf, CountTables] = {}
        self._dense: list[tuple[CurveOf, weakref.ref[NDArray], Floats]] = []
        """The last AREAS_KEPT areas and their 1 / sigma^2: those of unmoved sensors return. Areas
        that nobody else keeps, as of a sensor that has moved on, are not kept here either."""

    def curve(self, kind: CurveOf) -> ApCurve:
        """Return the AP curve of a kind, or the sensor's own."""
        return kind.curve if isinstance(kind, OwnCurve) else self.model.curve(kind)

    def ranged(self, groups: Sequence[Measurement], distance: Floats) -> list[Measurement]:
        """Return groups with the range terms of their curves; `distance` (N,) is that of m."""
        return [(kind, ranged(m, self.curve(kind), distance)) for kind, m in groups]

    def tables(self, kind: CurveOf) -> CountTables:
        """Return the lookup tables for integer m of a kind."""
        if kind not in self._tables:
            curve = self.curve(kind)
            precision = precision_of(np.arange(self.saturation_count(kind) + 1), curve)
            entropy = entropy_of(self.fused([kind], [precision]))
            self._tables[kind] = CountTables(precision, entropy)
        return self._tables[kind]

    def saturation_count(self, kind: CurveOf) -> int:
        """Integer m from which AP is at its maximum: a larger m changes nothing."""
        return int(min(self.curve(kind).saturation, MAX_TABLE - 1)) + 1

    def precision(self, m: NDArray, kind: CurveOf) -> Floats:
        """1 / sigma^2 of a group's measurement."""
        if is_whole(m):
            return np.take(self.tables(kind).precision, m, mode="clip")
        return precision_of(m, self.curve(kind))

    def _precision_at(self, index: Ints, kind: CurveOf, m: NDArray) -> Floats:
        """1 / sigma^2 of a group's measurement at some voxels; of areas from the cache."""
        if is_whole(m):
            return self.precision(m.take(index), kind)
        for known, areas, precision in self._dense:
            if areas() is m and known == kind:
                return precision.take(index)
        curve = self.curve(kind)
        dense = np.full(m.shape, precision_of(np.zeros(1), curve))  # the bits of arrays
        some = np.flatnonzero(m > 0)
        np.put(dense, some, precision_of(m.take(some), curve))
        in_use = [row for row in self._dense if row[1]() is not None]
        self._dense = [(kind, weakref.ref(m), dense), *in_use[: AREAS_KEPT - 1]]
        return dense.take(index)

    def fused(self, kinds: Sequence[CurveOf], precisions: Sequence[Floats]) -> Floats:
        """Fused 1 / sigma^2 of groups: late fusion (eq. 7), over the model's frames (eq. T2)."""
        frames = self.model.frames
        if frames is None:
            return late_fusion(precisions, self.model.blind)
        floor = BLIND_PRECISION if self.model.blind == "floor" else 0.0
        return frames.fused(kinds, [p - floor for p in precisions], floor)

    def entropies(self, groups: Sequence[Measurement]) -> tuple[Floats, NDArray[np.bool_]]:
        """Entropy H of every voxel [nats], and whether any group sees it.

        H is looked up at voxels that only one group with integer m sees, and computed at all
        others. A blind group changes nothing, except by the literal formula (eq. 7).
        """
        ignores_blind = self.model.blind == "floor"
        counting = (g for g in groups if is_whole(g[1]) and ignores_blind)
        tabulated = next(counting, None)
        others = [g for g in groups if g is not tabulated]
        if tabulated is not None:
            entropies = np.take(self.tables(tabulated[0]).entropy, tabulated[1], mode="clip")
            visible = tabulated[1] > 0
        else:
            entropies = np.full(groups[0][1].shape, H_BLIND)
            visible = np.zeros(entropies.shape, bool)
        if others:
            by_others = np.logical_or.reduce([m > 0 for _, m in others])
            visible |= by_others
            seen = np.flatnonzero(by_others | (not ignores_blind))  # faster than by flags
            precisions = [self._precision_at(seen, kind, m) for kind, m in groups]  # eqs. 4 and 5
            fused = self.fused([kind for kind, _ in groups], precisions)
            np.put(entropies, seen, entropy_of(fused))
        return entropies, visible


def is_whole(m: NDArray) -> bool:
    """Whether a measurement is an array of integers."""
    return m.dtype.kind in "iu"


@dataclass(frozen=True, slots=True)
class VisibleRows:
    """m (n, rows, nz) of the voxels of n x-planes in some rows (y); it is 0 in all other rows. In
    single precision m is rounded to a few digits when fused; in double precision it is not."""

    rows: slice
    m: NDArray[np.floating]

    def __add__(self, other: "VisibleRows") -> "VisibleRows":
        """Sum of two measurements of the same planes."""
        if not (self.m.size and other.m.size):
            return self if self.m.size else other
        start = min(self.rows.start, other.rows.start)
        stop = max(self.rows.stop, other.rows.stop)
        n, _, nz = self.m.shape
        total = np.zeros((n, stop - start, nz), np.result_type(self.m, other.m))
        for part in (self, other):
            total[:, part.rows.start - start : part.rows.stop - start] += part.m
        return VisibleRows(slice(start, stop), total)


Group = tuple[CurveOf, NDArray | VisibleRows]
"""AP curve of a fusion group, and its m on n x-planes: integers (n, ny, nz), or visible rows."""


class PlaneFusion:
    """Fusion on planes of (ny, nz) voxels, under the model of a `Fusion`."""

    def __init__(self, fusion: Fusion, shape: tuple[int, int]) -> None:
        self._fusion = fusion
        self._shape = shape
        self._tables: dict[tuple[str, CurveOf, int], Floats] = {}
        """By content, kind and number of blind groups: two for each kind, and one more for each
        number of groups that occurs (by the floor rule, one)."""

    def entropies(self, groups: Sequence[Group], plane: int) -> Floats:
        """Entropy H (ny, nz) of the voxels of one of the planes [nats]."""
        if self._fusion.model.frames is not None:
            return self._over_frames(groups, plane)
        counts, areas = _planes(groups, plane)
        blind = 1 if self._fusion.model.blind == "floor" else len(groups)
        if len(counts) == 1:
            ((kind, m),) = counts
            entropies = np.take(self._alone(kind, blind), m, mode="clip")
        else:
            entropies = entropy_of(self._counted(counts, blind, slice(None)))
        starts = [own.start for _, own, _ in areas]
        stops = [own.stop for _, own, _ in areas]
        rows = slice(min(starts, default=0), max(stops, default=0))  # with any area
        if rows.stop > rows.start:
            precision = self._counted(counts, blind, rows)
            for kind, own, m in areas:
                added = self._added_by_areas(kind, m)
                precision[own.start - rows.start : own.stop - rows.start] += added
            entropies[rows] = entropy_of(precision)
        return entropies

    def _over_frames(self, groups: Sequence[Group], plane: int) -> Floats:
        """Entropy H (ny, nz) over the model's frames: what each group adds is summed by frame."""
        precisions = [np.full(self._shape, BLIND_PRECISION) for _ in groups]
        for (kind, _), precision, group in zip(groups, precisions, groups, strict=True):
            rows, m = _on_plane(group, plane)
            precision[rows] += self.added(kind, m)
        return entropy_of(self._fusion.fused([kind for kind, _ in groups], precisions))

    def seen(self, groups: Sequence[Group], plane: int) -> NDArray[np.bool_]:
        """Whether any group sees the voxels (ny, nz) of one of the planes."""
        counts, areas = _planes(groups, plane)
        visible = np.zeros(self._shape, bool) if not counts else counts[0][1] > 0
        for _, m in counts[1:]:
            visible |= m > 0
        for _, rows, m in areas:
            visible[rows] |= m > 0.0
        return visible

    def added(self, kind: CurveOf, m: NDArray) -> Floats:
        """What a group with measurement m adds to the 1 / sigma^2 of blindness."""
        if m.dtype.kind in "iu":
            return np.take(self._by_count(kind), m, mode="clip")
        return self._added_by_areas(kind, np.ascontiguousarray(m))

    def gained(self, kind: CurveOf) -> Floats:
        """Table over integer m: entropy of a single group, less that of a blind voxel."""
        return self._cached(("gained", kind, 1), lambda: self._alone(kind, 1) - H_BLIND)

    def _counted(self, counts: Sequence[GroupCounts], blind: int, rows: slice) -> Floats:
        """1 / sigma^2 of `blind` blind groups, plus that of groups with integer m, in some rows."""
        total = np.full(self._shape, blind * BLIND_PRECISION)[rows]
        for kind, m in counts:
            total += np.take(self._by_count(kind), m[rows], mode="clip")
        return total

    def _added_by_areas(self, kind: CurveOf, m: NDArray) -> Floats:
        """What m adds to 1 / sigma^2; in single precision looked up by its leading digits."""
        if m.dtype != np.float32:
            return np.where(m > 0.0, self._fusion.precision(m, kind) - BLIND_PRECISION, 0.0)
        code = np.right_shift(m.view(np.int32), SHIFT)
        code -= _CODES[0]
        return np.take(self._by_digits(kind), code, mode="clip")

    def _by_count(self, kind: CurveOf) -> Floats:
        """Table over integer m: what m adds to 1 / sigma^2."""
        return self._cached(
            ("count", kind, 0), lambda: self._fusion.tables(kind).precision - BLIND_PRECISION
        )

    def _alone(self, kind: CurveOf, blind: int) -> Floats:
        """Table over integer m: entropy of a group among `blind` blind groups."""
        added = self._by_count(kind)
        return self._cached(
            ("alone", kind, blind), lambda: entropy_of(added + blind * BLIND_PRECISION)
        )

    def _by_digits(self, kind: CurveOf) -> Floats:
        """Table over the leading digits of m: what the middle of these adds to 1 / sigma^2."""

        def made() -> Floats:
            middle = (_CODES << SHIFT) + (1 << SHIFT - 1)
            added = self._fusion.precision(middle.view(np.float32), kind) - BLIND_PRECISION
            added[0] = 0.0
            return added

        return self._cached(("digits", kind, 0), made)

    def _cached(self, key: tuple[str, CurveOf, int], make: Callable[[], Floats]) -> Floats:
        if key not in self._tables:
            self._tables[key] = make()
        return self._tables[key]


def _planes(groups: Sequence[Group], plane: int) -> tuple[list[GroupCounts], list[Areas]]:
    """One plane of the groups with integer m, and of those with areas that see any plane."""
    counts = []
    areas = []
    for kind, measured in groups:
        if not isinstance(measured, VisibleRows):
            counts.append((kind, measured[plane]))
        elif measured.m.size:
            areas.append((kind, measured.rows, measured.m[plane]))
    return counts, areas


class RowValues(NamedTuple):
    """Values (rows, nz) of a plane in some rows (y)."""

    rows: slice
    values: NDArray

    def at(self, visible: "VisibleVoxels") -> NDArray:
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
    def of(cls, sensor: Group, plane: int) -> "VisibleVoxels":
        """Return the voxels of a plane that a sensor sees."""
        rows, m = _on_plane(sensor, plane)
        position = np.flatnonzero(m != 0)
        return cls(sensor[0], rows, position, m.reshape(-1).take(position, mode="clip"))


class LeaveOneOut:
    """Sums over planes for each sensor S of the fusion groups. `groups` are the measurements of the
    sensors of each fusion group, `totals` (G,) their sums."""

    def __init__(
        self, fused: PlaneFusion, groups: Sequence[Sequence[Group]], totals: Sequence[Group]
    ) -> None:
        self._fused = fused
        self._groups = [
            _FusionGroup(sensors, total) for sensors, total in zip(groups, totals, strict=True)
        ]

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
                weight = weighing.at(visible)
                precision = others.at(visible)
                self._add_rest(group, precision, rank, visible, plane=plane)
                lost = entropy_of(precision)
                lost -= whole.at(visible)
                lost *= weight  # in place: a new array costs as much as the product
                gained = self._gained(visible)
                gained *= weight
                sums.append((lost.sum(), gained.sum(), weight.sum()))
        return np.array(sums).T

    def _add_rest(
        self,
        group: "_FusionGroup",
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
        kind = group.rests[rank][0]
        others = RowValues(*_on_plane(group.rests[rank], plane))
        rows = visible.rows
        nz = others.values.shape[-1]
        added = np.zeros((rows.stop - rows.start, nz))
        start = max(rows.start, others.rows.start)
        stop = min(rows.stop, others.rows.stop)
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
        others = []
        so_far = np.full(shape, BLIND_PRECISION)
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
    """A fusion group: the measurements of its sensors, and their sum. Of a group with areas a
    difference would lose digits, so `rests` are the sums over the sensors but each one. Other
    groups count in whole numbers: the sum less the sensor's count is exact."""

    def __init__(self, sensors: Sequence[Group], total: Group) -> None:
        self.sensors = sensors
        self.total = total
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

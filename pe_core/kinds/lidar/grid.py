"""Beams through every voxel of the grid, by sweeping planes.

A beam enters a voxel through exactly one face, or starts inside it. So m is a count of entries, and
the entries through one grid plane are the cells of that plane in which the beams cross it. Sweeping
every plane of the three axes visits each (beam, voxel) pair once: exact for any pose and any
pattern of beams, each with its own end, at a cost proportional to the paths.

Crossing points advance by a constant step from plane to plane. They are kept in fixed point
(FRACTION_BITS of a voxel), so a step is one integer addition and a cell index one shift.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.space import PerceptionSpace
from .ties import position_in_voxels, without_zeros

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Fixed = NDArray[np.uint64]
HeldCounts = NDArray[np.uint16]

FRACTION_BITS = 40
FRACTION = np.uint64(FRACTION_BITS)
STEEPEST = float(1 << 20)
"""Voxels a beam may advance sideways from one plane to the next; no grid is as wide."""
EARLY = 1e-6
"""Beams from outside are let in this early, in voxels: before the border they meet no cell."""
MOST = int(np.iinfo(np.uint16).max)
"""Counts stop here. Only voxels close to the sensor can hold as many."""
NEAR = 16
"""Voxels round a sensor where a count may reach `MOST` and has to be held there."""
ONE = np.uint16(1)


@dataclass(frozen=True, slots=True)
class Paths:
    """Beams cut to the space, in voxels: `origin` (3,), `directions` (B, 3), `start`, `end`.

    None starts nearer than `first`.
    """

    origin: Floats
    directions: Floats
    start: Floats
    end: Floats
    first: float = 0.0


class BeamGrid:
    """Beams through every voxel of a space, as 16-bit counts that hold at 65535.

    One more voxel on each side catches crossing points that a rounding puts outside the space, so
    that no sweep has to look.
    """

    def __init__(self, space: PerceptionSpace) -> None:
        self.space = space
        self._padded = np.zeros([n + 2 for n in space.shape], np.uint16)
        self._crowded: list[tuple[slice, ...]] = []

    @property
    def counts(self) -> HeldCounts:
        """(nx, ny, nz) beams through each voxel; a view."""
        return self._padded[1:-1, 1:-1, 1:-1]

    def clear(self) -> None:
        """Forget all beams."""
        if self._crowded:
            self._crowded.clear()
            self._padded.fill(0)

    def add(
        self, origin: Sequence[float], directions: Floats, ends: Floats, nearest: float = 0.0
    ) -> None:
        """Add the beams of one sensor to those that are there.

        Parameters
        ----------
        origin : (3,) float
            Where the beams start, ground frame [m].
        directions : (B, 3) float
            Unit directions, ground frame.
        ends : (B,) float
            A voxel entered farther than this is not counted [m].
        nearest : float
            Nor one that is left nearer than this [m].
        """
        paths = _cut_to_space(origin, directions, ends, self.space, nearest)
        self._crowded.append(_around(paths.origin, self._padded.shape))
        if nearest > 0.0:
            self._add_at_start(paths)
        else:
            self._add_at_origin(paths)
        for axis in range(3):
            for sign in (1, -1):
                run = _Run.of(paths, self.space.shape, axis, sign)
                for few in run.portions(MOST):
                    self._add_held(few, axis, sign)

    def _add_at_origin(self, paths: Paths) -> None:
        """Add the beams that start in the space to the voxel that holds the sensor."""
        inside = int((paths.start == 0.0).sum())
        if inside:
            here = tuple(np.floor(paths.origin).astype(int))
            self.counts[here] = min(int(self.counts[here]) + inside, MOST)

    def _add_at_start(self, paths: Paths) -> None:
        """Add the beams whose minimum range ends in the space to the voxels where it does."""
        inside = paths.start == paths.first
        at = np.floor(paths.origin + paths.directions[inside] * paths.first).astype(np.int64) + 1
        flat = self._padded.reshape(-1)
        cells, found = np.unique(at @ np.array(self._strides), return_counts=True)
        flat[cells] = np.minimum(flat[cells] + found, MOST)

    def _add_held(self, run: _Run, axis: int, sign: int) -> None:
        """Add the entries of so few beams that they alone overflow no count; hold the sums."""
        before = [self._padded[where].copy() for where in self._crowded]
        for where in self._crowded:
            self._padded[where] = 0
        self._sweep(run, axis, sign)
        added = [self._padded[where].copy() for where in self._crowded]
        for where, old, new in zip(self._crowded, before, added, strict=True):
            self._padded[where] = np.minimum(old, MOST - new) + new

    def _sweep(self, run: _Run, axis: int, sign: int) -> None:
        """Count entries through the planes across `axis`, by the beams that go the way of `sign`.

        NumPy adds at indices one by one, so entries in the same voxel are all counted.
        """
        stride, stride_b, stride_c = (self._strides[a] for a in (axis, *_others(axis)))
        flat = self._padded.reshape(-1)
        for plane, (b, c) in run:
            cell = (plane if sign > 0 else plane - 1) + 1
            b *= stride_b
            if stride_c != 1:
                c *= stride_c
            b += c
            np.add.at(flat[cell * stride :], b, ONE)

    @property
    def _strides(self) -> tuple[int, ...]:
        return tuple(n // self._padded.itemsize for n in self._padded.strides)


def _around(origin: Floats, padded: tuple[int, ...]) -> tuple[slice, ...]:
    """Cells of the padded grid that are at most `NEAR` from a sensor, in voxels."""
    return tuple(
        slice(*(min(max(math.floor(o) + 1 + k, 0), n) for k in (-NEAR, NEAR + 1)))
        for o, n in zip(origin, padded, strict=True)
    )


def _others(axis: int) -> tuple[int, int]:
    return ((1, 2), (0, 2), (0, 1))[axis]


def _cut_to_space(
    origin: Sequence[float],
    directions: Floats,
    ends: Floats,
    space: PerceptionSpace,
    nearest: float,
) -> Paths:
    """Drop the beams that miss the space; say where the others are inside it, in voxels."""
    cells = position_in_voxels(origin, space.origin, space.interval)
    speeds = without_zeros(directions)
    first = nearest / space.interval
    enter = np.full(len(directions), first)
    leave = np.asarray(ends, dtype=float) / space.interval
    for axis, size in enumerate(space.shape):
        t0, t1 = -cells[axis] / speeds[:, axis], (size - cells[axis]) / speeds[:, axis]
        enter = np.maximum(enter, np.minimum(t0, t1))
        leave = np.minimum(leave, np.maximum(t0, t1))
    keep = np.flatnonzero(enter <= leave)
    return Paths(cells, speeds[keep], enter[keep], leave[keep], first)


@dataclass(slots=True)
class _Run:
    """The paths of one sweep, sorted so that those still on their way are always the first ones.

    `at` (2, B) are the crossing points along the two other axes, in fixed point and one voxel up:
    the cells outside the grid that a rounding may reach then have indices as well. `arrival` says
    on which plane a beam enters the space (None: all are there from the start).
    """

    planes: list[int]
    active: list[int]
    at: Fixed
    step: Fixed
    arrival: Ints | None

    @classmethod
    def of(cls, paths: Paths, shape: tuple[int, ...], axis: int, sign: int) -> _Run:
        """Place the beams on their first plane."""
        origin, speed = paths.origin[axis], sign * paths.directions[:, axis]
        first = math.floor(origin) + 1 if sign > 0 else math.ceil(origin) - 1
        first = max(first, 0) if sign > 0 else min(first, shape[axis])
        ahead = sign * (first - origin)
        room = shape[axis] - 1 - first if sign > 0 else first - 1
        early = np.where((paths.start > paths.first) | (paths.first == 0.0), EARLY, 0.0)
        arrival = np.maximum(np.ceil(paths.start * speed - ahead - early), 0.0)
        last = np.minimum(np.floor(paths.end * speed - ahead), room)
        moving = np.flatnonzero((speed > 0.0) & (last >= arrival))
        order = moving[np.argsort(-last[moving], kind="stable")]
        last, arrival = last[order].astype(np.int64), arrival[order].astype(np.int64)
        count = int(last[0]) + 1 if len(order) else 0
        active = np.searchsorted(-last, -np.arange(count), side="right")
        slopes = np.stack([paths.directions[order, a] / speed[order] for a in _others(axis)])
        at = _fixed_places(paths.origin[_others(axis), None], slopes * ahead)
        planes = [first + sign * k for k in range(count)]
        late = arrival if arrival.any() else None
        return cls(planes, active.tolist(), at, _fixed(slopes), late)

    def portions(self, most: int) -> Iterator[_Run]:
        """Yield the run in portions of at most `most` beams."""
        n = -(-len(self.step[0]) // most)
        for k in range(n):
            active = [(count - k + n - 1) // n for count in self.active]
            at, step = (np.ascontiguousarray(w[:, k::n]) for w in (self.at, self.step))
            late = None if self.arrival is None else self.arrival[k::n]
            yield _Run(self.planes, active, at, step, late)

    def __iter__(self) -> Iterator[tuple[int, Ints]]:
        """Yield each plane with the padded cells (2, N) where the beams cross it."""
        cells = np.empty_like(self.at)
        for step, (plane, n) in enumerate(zip(self.planes, self.active, strict=True)):
            at = self.at[:, :n]
            crossed = np.right_shift(at, FRACTION, out=cells[:, :n]).view(np.int64)
            if self.arrival is not None:
                crossed = crossed[:, self.arrival[:n] <= step]
            yield plane, crossed
            at += self.step[:, :n]


def _fixed_places(origin: Floats, along: Floats) -> Fixed:
    """Origins (2, 1) moved along (2, B), in fixed point and one voxel up; rounded down.

    The origin's whole part is added last, so that a beam which begins a nudge from a voxel's corner
    (`ties`) crosses the first plane in the cell that the definition says.
    """
    whole = np.floor(origin)
    places = np.clip((origin - whole) + along, -STEEPEST, STEEPEST)
    fixed = np.floor(places * (1 << FRACTION_BITS)).astype(np.int64)
    fixed += (whole.astype(np.int64) + 1) << FRACTION_BITS
    return fixed.view(np.uint64)


def _fixed(values: Floats) -> Fixed:
    """Voxels in fixed point, unsigned: shifting those is faster, and steps back wrap round."""
    whole = np.rint(np.clip(values, -STEEPEST, STEEPEST) * (1 << FRACTION_BITS))
    return whole.astype(np.int64).view(np.uint64)

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

from ..space import PerceptionSpace
from .ties import position_in_voxels, without_zeros

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Counts = NDArray[np.uint16]

FRACTION_BITS = 40
STEEPEST = float(1 << 20)
"""Voxels a beam may advance sideways from one plane to the next; no grid is as wide."""
EARLY = 1e-6
"""Beams from outside are let in this early, in voxels: before the border they meet no cell."""
MOST = int(np.iinfo(np.uint16).max)
"""Counts stop here. Only voxels close to the sensor can hold as many."""
NEAR = 16
"""Voxels round the sensor where a count may reach `MOST` and has to be held there."""
ONE = np.uint16(1)


@dataclass(frozen=True, slots=True)
class Beams:
    """Beams cut to the space, in voxels: `origin` (3,), `directions` (B, 3), `start`, `end`."""

    origin: Floats
    directions: Floats
    start: Floats
    end: Floats


class BeamGrid:
    """Beams through every voxel of a space, as 16-bit counts that hold at 65535.

    One more voxel on each side catches crossing points that a rounding puts outside the space, so
    that no sweep has to look.
    """

    def __init__(self, space: PerceptionSpace) -> None:
        self.space = space
        self._padded = np.zeros([n + 2 for n in space.shape], np.uint16)

    @property
    def counts(self) -> Counts:
        """(nx, ny, nz) beams through each voxel; a view."""
        return self._padded[1:-1, 1:-1, 1:-1]

    def add(self, origin: Sequence[float], directions: Floats, ends: Floats) -> None:
        """Add the beams of one sensor.

        Parameters
        ----------
        origin : (3,) float
            Where the beams start, ground frame [m].
        directions : (B, 3) float
            Unit directions, ground frame.
        ends : (B,) float
            A voxel entered farther than this is not counted [m].
        """
        beams = _cut_to_space(origin, directions, ends, self.space)
        self._add_at_origin(beams)
        for axis in range(3):
            for sign in (1, -1):
                self._sweep(beams, axis, sign)

    def _add_at_origin(self, beams: Beams) -> None:
        """Add the beams that start in the space to the voxel that holds the sensor."""
        inside = int((beams.start == 0.0).sum())
        if inside:
            here = tuple(np.floor(beams.origin).astype(int))
            self.counts[here] = min(int(self.counts[here]) + inside, MOST)

    def _sweep(self, beams: Beams, axis: int, sign: int) -> None:
        """Count entries through the planes across `axis`, by the beams that go the way of `sign`.

        NumPy adds at indices one by one, so entries in the same voxel are all counted.
        """
        stride, stride_b, stride_c = (self._strides[a] for a in (axis, *_others(axis)))
        flat = self._padded.reshape(-1)
        held = len(beams.end) > MOST
        for plane, b, c in _Run.start(beams, self.space.shape, axis, sign):
            cell = (plane if sign > 0 else plane - 1) + 1
            if held and abs(plane - beams.origin[axis]) <= NEAR:
                b, c = self._add_near(beams, axis, cell, b, c)
            b *= stride_b
            if stride_c != 1:
                c *= stride_c
            b += c
            np.add.at(flat[cell * stride :], b, ONE)

    @property
    def _strides(self) -> tuple[int, ...]:
        return tuple(n // self._padded.itemsize for n in self._padded.strides)

    def _add_near(self, beams: Beams, axis: int, cell: int, b: Ints, c: Ints) -> tuple[Ints, Ints]:
        """Add the entries near the sensor, held at `MOST`; return the others."""
        b0, c0 = (math.floor(beams.origin[a]) + 1 - NEAR for a in _others(axis))
        width = 2 * NEAR + 1
        near = (b >= b0) & (b < b0 + width) & (c >= c0) & (c < c0 + width)
        hits = np.bincount((b[near] - b0) * width + (c[near] - c0), minlength=width**2)
        layer = np.moveaxis(self._padded, axis, 0)[cell]
        rows, columns = (slice(max(low, 0), max(low + width, 0)) for low in (b0, c0))
        window = layer[rows, columns]
        hits = hits.reshape(width, width)[rows.start - b0 :, columns.start - c0 :]
        hits = hits[: window.shape[0], : window.shape[1]]
        window += np.minimum(hits, MOST - window.astype(np.int64)).astype(np.uint16)
        return b[~near], c[~near]


def _others(axis: int) -> tuple[int, int]:
    return ((1, 2), (0, 2), (0, 1))[axis]


def _cut_to_space(
    origin: Sequence[float], directions: Floats, ends: Floats, space: PerceptionSpace
) -> Beams:
    """Drop the beams that miss the space; say where the others are inside it, in voxels."""
    cells = position_in_voxels(origin, space.origin, space.interval)
    speeds = without_zeros(directions)
    enter = np.zeros(len(directions))
    leave = np.asarray(ends, dtype=float) / space.interval
    for axis, size in enumerate(space.shape):
        t0, t1 = -cells[axis] / speeds[:, axis], (size - cells[axis]) / speeds[:, axis]
        enter = np.maximum(enter, np.minimum(t0, t1))
        leave = np.minimum(leave, np.maximum(t0, t1))
    keep = np.flatnonzero(enter <= leave)
    return Beams(cells, speeds[keep], enter[keep], leave[keep])


@dataclass(slots=True)
class _Run:
    """The beams of one sweep, sorted so that those still on their way are always the first ones.

    `b` and `c` are the crossing points along the two other axes, in fixed point and one voxel up:
    the cells outside the grid that a rounding may reach then have indices as well.
    """

    planes: list[int]
    active: list[int]
    b: Ints
    c: Ints
    step_b: Ints
    step_c: Ints
    arrival: Ints | None

    @classmethod
    def start(cls, beams: Beams, shape: tuple[int, ...], axis: int, sign: int) -> _Run:
        """Place the beams on their first plane."""
        origin, speed = beams.origin[axis], sign * beams.directions[:, axis]
        first = math.floor(origin) + 1 if sign > 0 else math.ceil(origin) - 1
        first = max(first, 0) if sign > 0 else min(first, shape[axis])
        ahead = sign * (first - origin)
        room = shape[axis] - 1 - first if sign > 0 else first - 1
        arrival = np.maximum(np.ceil(beams.start * speed - ahead - EARLY), 0.0)
        last = np.minimum(np.floor(beams.end * speed - ahead), room)
        moving = np.flatnonzero((speed > 0.0) & (last >= arrival))
        order = moving[np.argsort(-last[moving], kind="stable")]
        last, arrival = last[order].astype(np.int64), arrival[order].astype(np.int64)
        count = int(last[0]) + 1 if len(order) else 0
        active = np.searchsorted(-last, -np.arange(count), side="right")
        other = _others(axis)
        slopes = [beams.directions[order, a] / speed[order] for a in other]
        b, c = (
            _fixed(beams.origin[a] + slope * ahead + 1.0)
            for a, slope in zip(other, slopes, strict=True)
        )
        step_b, step_c = (_fixed(slope) for slope in slopes)
        planes = [first + sign * k for k in range(count)]
        late = arrival if arrival.any() else None
        return cls(planes, active.tolist(), b, c, step_b, step_c, late)

    def __iter__(self) -> Iterator[tuple[int, Ints, Ints]]:
        """Yield each plane with the padded cells where the beams cross it."""
        cell_b, cell_c = np.empty_like(self.b), np.empty_like(self.c)
        for step, (plane, n) in enumerate(zip(self.planes, self.active, strict=True)):
            b = np.right_shift(self.b[:n], FRACTION_BITS, out=cell_b[:n])
            c = np.right_shift(self.c[:n], FRACTION_BITS, out=cell_c[:n])
            if self.arrival is not None:
                arrived = np.flatnonzero(self.arrival[:n] <= step)
                b, c = b[arrived], c[arrived]
            yield plane, b, c
            self.b[:n] += self.step_b[:n]
            self.c[:n] += self.step_c[:n]


def _fixed(values: Floats) -> Ints:
    """Voxels in fixed point."""
    return np.rint(np.clip(values, -STEEPEST, STEEPEST) * (1 << FRACTION_BITS)).astype(np.int64)

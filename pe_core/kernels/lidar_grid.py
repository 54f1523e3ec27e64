"""Beams through every voxel of the grid, by sweeping planes.

A beam enters a voxel through exactly one face, or starts inside it. So m is a count of entries, and
the entries through the faces of one grid plane are a histogram of the points where the beams cross
that plane. Sweeping every plane of the three axes visits each (beam, voxel) pair once: exact for
any pose and any pattern of beams, each with its own end, at a cost proportional to the paths.

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
"""Counts stop here. Only a voxel that touches the sensor can hold as many."""
NEAR_PLANES = 3
"""Planes beside the sensor, where a count may reach `MOST` and has to be held there."""


@dataclass(frozen=True, slots=True)
class Beams:
    """Beams cut to the space, in voxels: `origin` (3,), `directions` (B, 3), `start`, `end`."""

    origin: Floats
    directions: Floats
    start: Floats
    end: Floats


def add_beams(
    counts: Counts,
    origin: Sequence[float],
    directions: Floats,
    ends: Floats,
    space: PerceptionSpace,
) -> None:
    """Add the beams through each voxel to `counts`.

    Parameters
    ----------
    counts : (nx, ny, nz) uint16
        Changed in place; holds at 65535.
    origin : (3,) float
        Where the beams start, ground frame [m].
    directions : (B, 3) float
        Unit directions, ground frame.
    ends : (B,) float
        A voxel entered farther than this is not counted [m].
    space : PerceptionSpace
    """
    beams = _cut_to_space(origin, directions, ends, space)
    _add_at_origin(counts, beams)
    for axis in range(3):
        for sign in (1, -1):
            _sweep(counts, beams, axis, sign)


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


def _add_at_origin(counts: Counts, beams: Beams) -> None:
    """The voxel that holds the sensor is entered by every beam at distance 0."""
    inside = int((beams.start == 0.0).sum())
    if inside:
        here = tuple(np.floor(beams.origin).astype(int))
        counts[here] = min(int(counts[here]) + inside, MOST)


def _sweep(counts: Counts, beams: Beams, axis: int, sign: int) -> None:
    """Count entries through the planes across `axis`, by the beams that go the way of `sign`."""
    run = _Run.start(beams, counts.shape, axis, sign)
    for plane, b, c in run:
        cell = plane if sign > 0 else plane - 1
        if axis == 2:
            _add_scattered(counts, b, c, cell)
            continue
        layer = counts[cell] if axis == 0 else counts[:, cell]
        near = abs(plane - beams.origin[axis]) <= NEAR_PLANES
        _add_layer(layer, b, c, near)


def _add_layer(layer: Counts, b: Ints, c: Ints, near: bool) -> None:
    """Add entries at padded cells (b, c) to one layer (nb, nc) of the grid."""
    rows, columns = layer.shape[0] + 2, layer.shape[1] + 2
    b *= columns
    b += c
    padded = np.bincount(b, minlength=rows * columns).reshape(rows, columns)
    hits = padded[1:-1, 1:-1]
    if near:
        hits = np.minimum(hits, MOST - layer.astype(np.int64))
    np.add(layer, hits, out=layer, casting="unsafe")


def _add_scattered(counts: Counts, b: Ints, c: Ints, cell: int) -> None:
    """Entries through a plane across z: few, and far apart in memory, so each is added alone."""
    nx, ny, nz = counts.shape
    inside = (b > 0) & (b <= nx) & (c > 0) & (c <= ny)
    columns = (b[inside] - 1) * ny + (c[inside] - 1)
    voxels, hits = np.unique(columns * nz + cell, return_counts=True)
    flat = counts.reshape(-1)
    flat[voxels] = np.minimum(flat[voxels] + hits, MOST)


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
        other = [a for a in range(3) if a != axis]
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

"""Beams through every voxel of the grid, counted by sweeping planes.

A beam enters a voxel through exactly one face, or starts inside it. So m is a count of entries, and
the entries through one grid plane are the cells of that plane in which the beams cross it. Sweeping
every plane of the three axes visits each (beam, voxel) pair once: exact for any pose and any
pattern of beams, each with its own end, at a cost proportional to the paths.

Crossing points advance by a constant step from plane to plane. They are kept in fixed point
(FRACTION_BITS of a voxel), so a step is one integer addition and a cell index one shift.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints
from ...geometry.grids import PerceptionSpace
from .definition import position_in_voxels, without_zeros

Fixed = NDArray[np.uint64]
SaturatingCounts = NDArray[np.uint16]

FRACTION_BITS = 40
FRACTION = np.uint64(FRACTION_BITS)
MAX_ADVANCE = float(1 << 20)
"""Voxels a beam may advance sideways from one plane to the next; no grid is as wide."""
ENTRY_MARGIN = 1e-6
"""A beam from outside begins this much before the border, in voxels, where it meets no cell."""
MAX_COUNT = int(np.iinfo(np.uint16).max)
"""Counts saturate here. Only voxels close to the sensor can hold as many beams."""
SATURATION_RADIUS = 16
"""Voxels round a sensor in which a count may reach MAX_COUNT and needs to be clipped."""
ONE = np.uint16(1)


@dataclass(frozen=True, slots=True)
class Paths:
    """Beams clipped to the space, in voxels. `origin` (3,) is the sensor's position, `directions`
    (B, 3) are without zeros; a beam leads from `start` to `end` (B,). None starts nearer than
    `min_range`."""

    origin: Floats
    directions: Floats
    start: Floats
    end: Floats
    min_range: float = 0.0


class BeamGrid:
    """Counts of beams through every voxel of a space, in 16 bits; they saturate at 65535. The grid
    is padded by a voxel on each side for crossing points that rounding puts outside the space, so
    no sweep has to test for them."""

    def __init__(self, space: PerceptionSpace) -> None:
        self.space = space
        self._padded = np.zeros([n + 2 for n in space.shape], np.uint16)
        self._saturable: list[tuple[slice, ...]] = []

    @property
    def counts(self) -> SaturatingCounts:
        """(nx, ny, nz) numbers of beams through each voxel; a view."""
        return self._padded[1:-1, 1:-1, 1:-1]

    def clear(self) -> None:
        """Set all counts to 0."""
        if self._saturable:
            self._saturable.clear()
            self._padded.fill(0)

    def add(
        self, origin: Sequence[float], directions: Floats, ends: Floats, min_range: float = 0.0
    ) -> None:
        """Add the beams of one sensor at `origin` (3,) [m] to the counts. `directions` (B, 3) are
        unit vectors, ground frame. A beam does not count in voxels that it enters farther away than
        its end (B,), or leaves nearer than the minimum range [m]."""
        paths = _clip(origin, directions, ends, self.space, min_range=min_range)
        self._saturable.append(_around(paths.origin, self._padded.shape))
        if min_range > 0.0:  # beams that are inside the space at their minimum range count there
            inside = paths.start == paths.min_range
            points = paths.origin + paths.directions[inside] * paths.min_range
            voxels = np.floor(points).astype(np.int64) + 1
            flat = self._padded.reshape(-1)
            cells, added = np.unique(voxels @ np.array(self._strides), return_counts=True)
            flat[cells] = np.minimum(flat[cells] + added, MAX_COUNT)
        elif inside_count := int((paths.start == 0.0).sum()):  # in the voxel that holds the sensor
            voxel = tuple(np.floor(paths.origin).astype(int))
            self.counts[voxel] = min(int(self.counts[voxel]) + inside_count, MAX_COUNT)
        for axis in range(3):
            for sign in (1, -1):
                sweep = _Sweep.of(paths, self.space.shape, axis, sign)
                for part in sweep.split(MAX_COUNT):
                    self._add_saturating(part, axis, sign)

    def _add_saturating(self, sweep: "_Sweep", axis: int, sign: int) -> None:
        """Add the entries through planes across `axis`, of at most MAX_COUNT beams along `sign`. So
        no count overflows; the sums are clipped."""
        before = [self._padded[box].copy() for box in self._saturable]
        for box in self._saturable:
            self._padded[box] = 0
        stride, stride_b, stride_c = (self._strides[a] for a in (axis, *_other_axes(axis)))
        flat = self._padded.reshape(-1)
        for plane, (b, c) in sweep:
            cell = (plane if sign > 0 else plane - 1) + 1
            b *= stride_b
            if stride_c != 1:
                c *= stride_c
            b += c
            np.add.at(flat[cell * stride :], b, ONE)  # counts an index as often as it occurs
        added = [self._padded[box].copy() for box in self._saturable]
        for box, old, new in zip(self._saturable, before, added, strict=True):
            self._padded[box] = np.minimum(old, MAX_COUNT - new) + new

    @property
    def _strides(self) -> tuple[int, ...]:
        return tuple(n // self._padded.itemsize for n in self._padded.strides)


def _around(origin: Floats, padded: tuple[int, ...]) -> tuple[slice, ...]:
    """Box of the padded grid's cells within SATURATION_RADIUS of a sensor."""
    return tuple(
        slice(
            *(
                min(max(math.floor(o) + 1 + k, 0), n)
                for k in (-SATURATION_RADIUS, SATURATION_RADIUS + 1)
            )
        )
        for o, n in zip(origin, padded, strict=True)
    )


def _other_axes(axis: int) -> tuple[int, int]:
    """The two other axes."""
    return ((1, 2), (0, 2), (0, 1))[axis]


def _clip(
    origin: Sequence[float],
    directions: Floats,
    ends: Floats,
    space: PerceptionSpace,
    min_range: float,
) -> Paths:
    """Drop the beams that miss the space, and clip the others to it; in voxels."""
    position = position_in_voxels(origin, space.origin, space.interval)
    components = without_zeros(directions)
    start = min_range / space.interval
    enter = np.full(len(directions), start)
    leave = np.asarray(ends, dtype=float) / space.interval
    for axis, size in enumerate(space.shape):
        speed = components[:, axis]
        t0 = -position[axis] / speed
        t1 = (size - position[axis]) / speed
        enter = np.maximum(enter, np.minimum(t0, t1))
        leave = np.minimum(leave, np.maximum(t0, t1))
    keep = np.flatnonzero(enter <= leave)
    return Paths(position, components[keep], enter[keep], leave[keep], min_range=start)


@dataclass(slots=True)
class _Sweep:
    """The beams of one sweep over `planes`, sorted so that those not yet ended come first.

    On plane k the first `active[k]` beams have not ended. `at` (2, B) are the crossing points along
    the two other axes, in fixed point and raised by the padding; they advance by `step` from plane
    to plane. `arrival` (B,) is the number of the plane on which a beam enters the space; None: all
    beams are inside from the start.
    """

    planes: list[int]
    active: list[int]
    at: Fixed
    step: Fixed
    arrival: Ints | None

    @classmethod
    def of(cls, paths: Paths, shape: tuple[int, ...], axis: int, sign: int) -> "_Sweep":
        """Advance the beams to their first plane."""
        origin = paths.origin[axis]
        speed = sign * paths.directions[:, axis]
        first = math.floor(origin) + 1 if sign > 0 else math.ceil(origin) - 1
        first = max(first, 0) if sign > 0 else min(first, shape[axis])
        ahead = sign * (first - origin)
        max_planes = shape[axis] - 1 - first if sign > 0 else first - 1
        from_outside = (paths.start > paths.min_range) | (paths.min_range == 0.0)
        margin = np.where(from_outside, ENTRY_MARGIN, 0.0)
        arrival = np.maximum(np.ceil(paths.start * speed - ahead - margin), 0.0)
        last = np.minimum(np.floor(paths.end * speed - ahead), max_planes)
        moving = np.flatnonzero((speed > 0.0) & (last >= arrival))
        order = moving[np.argsort(-last[moving], kind="stable")]
        last = last[order].astype(np.int64)
        arrival = arrival[order].astype(np.int64)
        count = int(last[0]) + 1 if len(order) else 0
        active = np.searchsorted(-last, -np.arange(count), side="right")
        slopes = np.stack([paths.directions[order, a] / speed[order] for a in _other_axes(axis)])
        at = _fixed_points(paths.origin[_other_axes(axis), None], slopes * ahead)
        planes = [first + sign * k for k in range(count)]
        return cls(
            planes, active.tolist(), at, _fixed(slopes), arrival=arrival if arrival.any() else None
        )

    def split(self, max_beams: int) -> "Iterator[_Sweep]":
        """Yield parts of at most `max_beams` beams."""
        n = -(-len(self.step[0]) // max_beams)
        for k in range(n):
            active = [(count - k + n - 1) // n for count in self.active]
            at, step = (np.ascontiguousarray(w[:, k::n]) for w in (self.at, self.step))
            arrival = None if self.arrival is None else self.arrival[k::n]
            yield _Sweep(self.planes, active, at, step, arrival=arrival)

    def __iter__(self) -> Iterator[tuple[int, Ints]]:
        """Yield each plane with the cells (2, N) of the padded grid where beams cross it."""
        cells = np.empty_like(self.at)
        for step, (plane, n) in enumerate(zip(self.planes, self.active, strict=True)):
            at = self.at[:, :n]
            crossed = np.right_shift(at, FRACTION, out=cells[:, :n]).view(np.int64)
            if self.arrival is not None:
                crossed = crossed[:, self.arrival[:n] <= step]
            yield plane, crossed
            at += self.step[:, :n]


def _fixed_points(origin: Floats, along: Floats) -> Fixed:
    """Origin (2, 1) plus `along` (2, B) in fixed point, raised by the padding; rounded down. The
    origin's whole part is added last, so that a beam that begins a nudge from a voxel's corner
    (`kind`) crosses the first plane in the cell of the definition."""
    whole = np.floor(origin)
    points = np.clip((origin - whole) + along, -MAX_ADVANCE, MAX_ADVANCE)
    fixed = np.floor(points * (1 << FRACTION_BITS)).astype(np.int64)
    fixed += (whole.astype(np.int64) + 1) << FRACTION_BITS
    return fixed.view(np.uint64)


def _fixed(values: Floats) -> Fixed:
    """Voxels in fixed point; unsigned, as shifting is faster then and negative steps wrap round."""
    whole = np.rint(np.clip(values, -MAX_ADVANCE, MAX_ADVANCE) * (1 << FRACTION_BITS))
    return whole.astype(np.int64).view(np.uint64)

"""Light on what is seen: a sun that casts shadows, and the open sky that corners see less of.

A caster of rays from one point shows what a lamp shines on: shadows are what it does not reach. The
sky is a dome of lamps. Each pixel of every second row and column asks a quarter of them, its
neighbours the others; what they find is shared among neighbours on the same surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .normals import unit
from .tableau import GROUND, Met, Tableau

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Size = tuple[int, int]

LAMPS_A_PIXEL, TURNS = 6, 4
"""Lamps of the dome that a pixel asks, and how many sets of them there are."""
FAR = 8.0
"""How far away lamps are, in half the size of what stands there."""
OPEN_M = 3.0
"""Ground farther than this from every solid sees all of the sky, in heights of the tallest."""
SAME = 0.85
"""Cosine of the angle up to which two normals are those of one surface."""
SPREAD = (-2, -1, 0, 1)
"""Neighbours that share the sky's light, along and across: each set of lamps equally often."""
OFF_M = 0.02
"""How far off its surface the light at a point is asked for."""


def sun_place(stage: Tableau, direction: Floats) -> Floats:
    """(3,) where a lamp stands for the sun in a direction (3,) [m]."""
    middle, half = _extent(stage)
    return middle + unit(direction) * max(60.0, 4.0 * FAR * half)


def sunlight(stage: Tableau, seen: Met, place: Floats) -> Floats:
    """(N,) what share of full sunlight falls on surfaces: 0 in the shade or turned away."""
    light = np.zeros(len(seen.what))
    some = np.flatnonzero(seen.is_surface)
    points, normals = seen.points[some], seen.normals[some]
    slope = (unit(place - points) * normals).sum(axis=1)
    facing = slope > 0.0
    some, slope = some[facing], slope[facing]
    lit = np.ones(len(some), bool)
    near = np.flatnonzero(_may_be_shaded(stage, seen, some, reach=12.0))
    lit[near] = stage.lit(place, points[facing][near] + OFF_M * normals[facing][near])
    light[some] = slope * lit
    return light


def skylight(stage: Tableau, seen: Met, size: Size) -> Floats:
    """(H * W,) what share of the sky that surfaces face is open, 0 to 1."""
    width, height = size
    rows, columns = np.arange(0, height, 2), np.arange(0, width, 2)
    small = np.add.outer(rows * width, columns)
    own = _shared(_dome_light(stage, seen, small), _PixelPlanes.of(seen, small))
    return _enlarged(own, seen, small, size)


def dome(count: int) -> Floats:
    """(N, 3) directions spread evenly over the upper half sphere."""
    k = np.arange(count) + 0.5
    up, turn = k / count, k * math.pi * (3.0 - math.sqrt(5.0))
    flat = np.sqrt(1.0 - up * up)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), up], axis=1)


def _dome_light(stage: Tableau, seen: Met, small: Ints) -> Floats:
    """Openness (h, w) of pixels `small` (h, w), each by the lamps of its turn."""
    middle, half = _extent(stage)
    directions = dome(LAMPS_A_PIXEL * TURNS)
    flat = small.ravel()
    turn = (np.arange(small.shape[0])[:, None] % 2 * 2 + np.arange(small.shape[1]) % 2).ravel()
    near = _may_be_shaded(stage, seen, flat, reach=OPEN_M) & seen.is_surface[flat]
    found, total = np.zeros(len(flat)), np.zeros(len(flat))
    for number, direction in enumerate(directions):
        at = np.flatnonzero(near & (turn == number % TURNS))
        pixel = flat[at]
        slope = np.maximum((seen.normals[pixel] * direction).sum(axis=1), 0.0)
        asked = np.flatnonzero(slope > 0.0)
        points = seen.points[pixel[asked]] + OFF_M * seen.normals[pixel[asked]]
        lit = stage.lit(middle + direction * FAR * half, points)
        found[at[asked]] += slope[asked] * lit
        total[at] += slope
    open_ = np.where(total > 0.0, found / np.where(total > 0.0, total, 1.0), 1.0)
    return np.where(near, open_, 1.0).reshape(small.shape)


@dataclass(frozen=True, slots=True)
class _PixelPlanes:
    """What pixels (h, w) are of: `what` is seen, its `normals` and `points` (h, w, 3)."""

    what: Ints
    normals: NDArray[np.float32]
    points: NDArray[np.float32]
    slack: NDArray[np.float32]

    @classmethod
    def of(cls, seen: Met, pixels: Ints) -> _PixelPlanes:
        slack = 0.03 + 0.01 * np.minimum(seen.distance[pixels], 1e6)
        normals, points = (each[pixels].astype(np.float32) for each in (seen.normals, seen.points))
        return cls(seen.what[pixels], normals, points, slack.astype(np.float32))

    def __getitem__(self, some: Any) -> _PixelPlanes:
        return _PixelPlanes(
            self.what[some], self.normals[some], self.points[some], self.slack[some]
        )

    def like(self, other: _PixelPlanes) -> NDArray[np.bool_]:
        """Whether two are one surface."""
        along = np.einsum("...k,...k->...", self.normals, other.normals)
        off = np.einsum("...k,...k->...", self.points - other.points, self.normals)
        return (self.what == other.what) & (along > SAME) & (np.abs(off) <= self.slack)


def _shared(own: Floats, surfaces: _PixelPlanes) -> Floats:
    """Mean of each pixel and its neighbours on the same surface, each turn as often as another."""
    total, weight = np.zeros_like(own), np.zeros_like(own)
    steps = [(dy, dx) for dy in SPREAD for dx in SPREAD]
    for dy, dx in steps:
        here, there = _beside(own.shape[0], dy), _beside(own.shape[1], dx)
        to, of = (here[0], there[0]), (here[1], there[1])
        same = surfaces[to].like(surfaces[of])
        total[to] += same * own[of]
        weight[to] += same
    return total / np.maximum(weight, 1.0)


def _beside(count: int, step: int) -> tuple[slice, slice]:
    """Places that have a neighbour so many steps on, and those neighbours."""
    if step < 0:
        return slice(-step, None), slice(0, count + step)
    return slice(0, count - step), slice(step, None)


def _enlarged(own: Floats, seen: Met, small: Ints, size: Size) -> Floats:
    """Light of all pixels: the mean of the small picture's on the same surface."""
    width, height = size
    found = np.empty((height, width))
    for y, x in ((0, 0), (0, 1), (1, 0), (1, 1)):
        pixels = np.add.outer(np.arange(y, height, 2) * width, np.arange(x, width, 2))
        found[y::2, x::2] = _between(own, _PixelPlanes.of(seen, pixels), seen, small, (y, x))
    return found.ravel()


def _between(own: Floats, there: _PixelPlanes, seen: Met, small: Ints, step: Size) -> Floats:
    """Light of pixels beside those of the small picture, a step of (0 or 1, 0 or 1) away."""
    rows, columns = (np.arange(n) for n in there.what.shape)
    total, weight = np.zeros(there.what.shape), np.zeros(there.what.shape)
    for dy in range(step[0] + 1):
        for dx in range(step[1] + 1):
            i = np.minimum(rows + dy, small.shape[0] - 1)
            j = np.minimum(columns + dx, small.shape[1] - 1)
            near = np.ix_(i, j)
            share = there.like(_PixelPlanes.of(seen, small[near])) + 1e-6
            total += share * own[near]
            weight += share
    return total / weight


def _may_be_shaded(stage: Tableau, seen: Met, some: Ints, reach: float) -> NDArray[np.bool_]:
    """Which pixels are of a solid, or of ground no farther from one than `reach` of its height."""
    near = seen.what[some] > GROUND
    x, y = seen.points[some, 0], seen.points[some, 1]
    for solid in stage.solids:
        low, high = solid.body.bounds
        far = reach * float(high[2])
        inside = (x > low[0] - far) & (x < high[0] + far) & (y > low[1] - far) & (y < high[1] + far)
        near |= inside & (seen.what[some] == GROUND)
    return near


def _extent(stage: Tableau) -> tuple[Floats, float]:
    """Middle of all solids, and half their greatest size [m]."""
    if not stage.solids:
        return np.array([0.0, 0.0, 1.0]), 3.0
    low = np.min([solid.body.bounds[0] for solid in stage.solids], axis=0)
    high = np.max([solid.body.bounds[1] for solid in stage.solids], axis=0)
    return (low + high) / 2.0, max(float((high - low).max()) / 2.0, 1.0)

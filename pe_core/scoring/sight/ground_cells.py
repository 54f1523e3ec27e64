"""Square cells of the ground, and the points of each at which voxels are evaluated.

A cell is many columns wide, and the beams of a LiDAR meet the ground in rings: one voxel in the
middle of each cell would show moire patterns. So each cell has a power of two of points, a run of
the scrambled Sobol' sequence: spread evenly over the cell (and over height, if needed), differently
in each cell, and reproducibly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Floats
from ...base.errors import InputError
from ...base.values import Number
from ...geometry.grids import PerceptionSpace
from ..sampling import CENTERED, scrambled_sobol

Bounds = tuple[float, float]
Rectangle = tuple[Bounds, Bounds]
"""A rectangle of the ground: bounds along x and along y [m]."""

VOXELS_PER_M2 = 8
MIN_VOXELS, MAX_VOXELS = 4, 64
"""Voxels of a cell, if it is wider than a column."""
MAX_CELLS = 2**21
STEP = Number(0.0, above=True, cap=1e6, unit="m", noun="length")
WITHIN = Number(0.0, above=True, cap=1e6, unit="m", noun="length")
ROUNDING = 1e-6
"""Tolerance of divisions, in voxels: 0.3 / 0.1 is not a whole number."""


@dataclass(frozen=True, slots=True)
class GroundCells:
    """Squares side by side: their lower ends `x0` (NX,) and `y0` (NY,), and the `step` [m].

    The last ones end where the space does, at `x1` and `y1`.
    """

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    step: float

    @classmethod
    def of(cls, space: PerceptionSpace, step: float, part: Rectangle | None = None) -> GroundCells:
        """Cut the ground of a space, or a part of it, into cells.

        Raises
        ------
        InputError
            When the step is not positive or the cells are too many, or the part is beside the
            space.
        """
        step = STEP.checked("sight", "step", step)
        bounds = [_whole_columns(space, axis, part) for axis in (0, 1)]
        counts = [math.ceil((high - low) / step - ROUNDING) for low, high in bounds]
        if math.prod(counts) > MAX_CELLS:
            found = f"{step:g} m: {math.prod(counts):,}"
            raise InputError("sight", "step", f"a step with at most {MAX_CELLS:,} cells", found)
        low = [at + np.arange(n) * step for (at, _), n in zip(bounds, counts, strict=True)]
        high = [np.minimum(w + step, end) for w, (_, end) in zip(low, bounds, strict=True)]
        return cls(low[0], low[1], high[0], high[1], step)

    @property
    def key(self) -> tuple[float, ...]:
        """A key that identifies the cells among those of the same space."""
        return self.step, self.x0[0], self.x1[-1], self.y0[0], self.y1[-1]

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y."""
        return len(self.x0), len(self.y0)

    @property
    def x(self) -> Floats:
        """Middles along x (NX,) [m]."""
        return self.x0 + self.step / 2.0

    @property
    def y(self) -> Floats:
        """Middles along y (NY,) [m]."""
        return self.y0 + self.step / 2.0

    def points(self, interval: float, *, over_height: bool) -> tuple[Floats, Floats, Floats]:
        """Points of every cell: x, y [m] and a share of the height, each (cells, K).

        Cells on the right of the vehicle have the mirrored points of the cells on its left.
        """
        count = self._voxels(interval, over_height)
        _, row = np.unique(np.round(np.abs(self.y0 + self.y1), 6), return_inverse=True)
        number = np.add.outer(np.arange(len(self.x0)) * (row.max() + 1), row)
        u = scrambled_sobol((int(number.max()) + 1) * count, CENTERED).reshape(-1, count, 3)
        u = u[number]  # (NX, NY, K, 3)
        if count == 1:
            u[..., :2] = 0.5
        right = (self.y0 + self.y1 < 0.0)[:, None]
        across = np.where(right, 1.0 - u[..., 1], u[..., 1])
        x = self.x0[:, None, None] + u[..., 0] * (self.x1 - self.x0)[:, None, None]
        y = self.y0[:, None] + across * (self.y1 - self.y0)[:, None]
        return x.reshape(-1, count), y.reshape(-1, count), u[..., 2].reshape(-1, count)

    def _voxels(self, interval: float, over_height: bool) -> int:
        """Return how many voxels a cell has: a power of two."""
        if self.step < 1.5 * interval and not over_height:
            return 1
        wanted = math.log2(VOXELS_PER_M2 * self.step**2)
        return int(np.clip(2 ** round(np.clip(wanted, 0.0, 16.0)), MIN_VOXELS, MAX_VOXELS))


def widened(rectangle: Rectangle, within: float) -> Rectangle:
    """Widen a rectangle by a distance to each side; `InputError` for one that is not positive."""
    within = WITHIN.checked("sight", "within", within)
    (x0, x1), (y0, y1) = rectangle
    return (x0 - within, x1 + within), (y0 - within, y1 + within)


def _whole_columns(space: PerceptionSpace, axis: int, part: Rectangle | None) -> Bounds:
    """Bounds along an axis of the space's columns that lie in a part of it."""
    low, high = (space.x, space.y)[axis]
    if part is None:
        return low, high
    first = max(0, math.ceil((part[axis][0] - low) / space.interval - ROUNDING))
    last = min(space.shape[axis], math.floor((part[axis][1] - low) / space.interval + ROUNDING))
    if first >= last:
        expected = f"a part of the space, {'xy'[axis]} = [{low:g}, {high:g}]"
        found = "[{:g}, {:g}]".format(*part[axis])
        raise InputError("sight", "within", expected, found)
    return low + first * space.interval, low + last * space.interval

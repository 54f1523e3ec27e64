"""Squares of the ground: where something may stand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class GroundGrid:
    """Squares side by side on the ground, z = 0.

    Attributes
    ----------
    origin : (2,) float
        The lowest corner of the lowest square, ground frame [m].
    shape : (2,) int
        Number of squares along x and y.
    step : float
        Side of a square [m].
    """

    origin: tuple[float, float]
    shape: tuple[int, int]
    step: float

    @cached_property
    def x(self) -> Floats:
        """Middles along x (NX,) [m]."""
        return self.origin[0] + (np.arange(self.shape[0]) + 0.5) * self.step

    @cached_property
    def y(self) -> Floats:
        """Middles along y (NY,) [m]."""
        return self.origin[1] + (np.arange(self.shape[1]) + 0.5) * self.step

    @property
    def end(self) -> tuple[float, float]:
        """The highest corner of the highest square [m]."""
        x, y = (w + n * self.step for w, n in zip(self.origin, self.shape, strict=True))
        return x, y

    def middles(self, squares: Ints) -> Floats:
        """(N, 2) middles of squares (N,), numbered row by row along y [m]."""
        i, j = np.divmod(squares, self.shape[1])
        return np.stack([self.x[i], self.y[j]], axis=1)

    def widened(self, squares: int) -> GroundGrid:
        """Return the grid with so many squares more on each side."""
        x, y = (w - squares * self.step for w in self.origin)
        nx, ny = (n + 2 * squares for n in self.shape)
        return GroundGrid((x, y), (nx, ny), self.step)

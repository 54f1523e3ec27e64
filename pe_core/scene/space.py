"""The perception space: the box of voxels that is judged."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..text.values import Number, pair

PAPER_INTERVAL_M = 0.1
MAX_VOXELS = 2**31
"""A grid larger than this (32 times the paper's) is taken for a slip of the pen."""
DIVIDES_TOLERANCE = 1e-6
"""How far from a whole number of voxels, in voxels, an extent may be (0.1 is no binary number)."""
MAX_COLUMNS = 2**25
"""Each class of the prior holds a number a column; 26 times the paper's."""
EDGE_M = 1e6
"""No space reaches farther than this."""
INTERVAL = Number(1e-3, EDGE_M, unit="m", noun="length")
BOUND = Number(cap=EDGE_M, unit="m")


@dataclass(frozen=True, slots=True)
class PerceptionSpace:
    """A box in the ground frame, cut into cubes of side `interval`.

    Parameters
    ----------
    x, y, z : (low, high) float
        Bounds [m]; the paper's are the defaults.
    interval : float
        Side of a voxel [m]. It has to divide every extent.

    Raises
    ------
    InputError
        When a bound is not finite, an extent is not positive, the interval does not divide it, or
        the voxels are too many.
    """

    x: tuple[float, float] = (-80.0, 80.0)
    y: tuple[float, float] = (-40.0, 40.0)
    z: tuple[float, float] = (0.0, 5.0)
    interval: float = PAPER_INTERVAL_M

    def __post_init__(self) -> None:
        object.__setattr__(self, "interval", INTERVAL.checked("space", "interval", self.interval))
        for name in "xyz":
            object.__setattr__(self, name, pair("space", name, getattr(self, name), BOUND))
            _check_divides(name, getattr(self, name), self.interval)
        if self.size > MAX_VOXELS:
            raise InputError("space", "interval", f"at most {MAX_VOXELS} voxels", self.size)
        if (columns := self.shape[0] * self.shape[1]) > MAX_COLUMNS:
            raise InputError("space", "interval", f"at most {MAX_COLUMNS} columns", columns)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of voxels along x, y, z."""
        nx, ny, nz = (round((hi - lo) / self.interval) for lo, hi in (self.x, self.y, self.z))
        return nx, ny, nz

    @property
    def size(self) -> int:
        """Number of voxels."""
        return math.prod(self.shape)

    @property
    def origin(self) -> tuple[float, float, float]:
        """The lowest corner [m]."""
        return self.x[0], self.y[0], self.z[0]

    def centers(self, axis: int) -> NDArray[np.float64]:
        """Voxel centres along one axis (0, 1, 2 for x, y, z) [m]."""
        steps = np.arange(self.shape[axis], dtype=float)
        return self.origin[axis] + (steps + 0.5) * self.interval

    def center_of(self, index: NDArray[np.integer]) -> NDArray[np.float64]:
        """Centres (V, 3) [m] of the voxels with (V, 3) indices."""
        return np.asarray(self.origin) + (np.asarray(index) + 0.5) * self.interval


def _check_divides(name: str, bounds: tuple[float, float], interval: float) -> None:
    voxels = (bounds[1] - bounds[0]) / interval
    if round(voxels) < 1 or abs(voxels - round(voxels)) > DIVIDES_TOLERANCE * max(1.0, voxels):
        raise InputError(
            "space", "interval", f"a length that divides {name} = {list(bounds)}", interval
        )

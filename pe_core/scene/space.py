"""The perception space: the box of voxels that is judged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

PAPER_INTERVAL_M = 0.1
MAX_VOXELS = 2**31
"""A grid larger than this (32 times the paper's) is taken for a slip of the pen."""
DIVIDES_TOLERANCE = 1e-6
"""How far from a whole number of voxels, in voxels, an extent may be (0.1 is no binary number)."""


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
        When a bound is not finite, an extent is not positive, or the interval does not divide it.
    """

    x: tuple[float, float] = (-80.0, 80.0)
    y: tuple[float, float] = (-40.0, 40.0)
    z: tuple[float, float] = (0.0, 5.0)
    interval: float = PAPER_INTERVAL_M

    def __post_init__(self) -> None:
        object.__setattr__(self, "interval", _positive(self.interval))
        for name in "xyz":
            object.__setattr__(self, name, _bounds(name, getattr(self, name)))
            _check_divides(name, getattr(self, name), self.interval)
        if math.prod(self.shape) > MAX_VOXELS:
            raise InputError(
                "space", "interval", f"at most {MAX_VOXELS} voxels", math.prod(self.shape)
            )

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


def _positive(value: float) -> float:
    if not (_is_number(value) and value > 0):
        raise InputError("space", "interval", "a positive number of metres", repr(value))
    return float(value)


def _bounds(name: str, bounds: Sequence[float]) -> tuple[float, float]:
    ok = isinstance(bounds, Sequence) and len(bounds) == 2 and all(map(_is_number, bounds))
    if not ok or not bounds[0] < bounds[1]:
        raise InputError("space", name, "two finite numbers, low before high", repr(bounds))
    return float(bounds[0]), float(bounds[1])


def _is_number(value: object) -> bool:
    real = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
    return real and math.isfinite(value)  # type: ignore[arg-type]


def _check_divides(name: str, bounds: tuple[float, float], interval: float) -> None:
    voxels = (bounds[1] - bounds[0]) / interval
    if round(voxels) < 1 or abs(voxels - round(voxels)) > DIVIDES_TOLERANCE * max(1.0, voxels):
        raise InputError(
            "space", "interval", f"a length that divides {name} = {list(bounds)}", interval
        )

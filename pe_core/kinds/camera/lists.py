"""Voxels of a run of planes as lists: by their numbers, and where they lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def places_of(
    axes: list[Floats], index: Ints, shape: tuple[int, ...], first: tuple[int, int]
) -> Floats:
    """Places (V, 3), told axis by axis, of voxels numbered from a plane and a row on."""
    column, k = np.divmod(index, shape[2])
    i, j = np.divmod(column, shape[1])
    x, y, z = axes
    return np.stack([x[first[0] + i], y[first[1] + j], z[k]], axis=1)


def span_of(mask: NDArray[np.bool_]) -> slice:
    """From the first to the last that is true."""
    seen = np.flatnonzero(mask)
    return slice(int(seen[0]), int(seen[-1]) + 1) if len(seen) else slice(0, 0)

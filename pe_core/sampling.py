"""Voxels drawn from the prior by a low-discrepancy sequence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .prior import ClassDensity
from .space import PerceptionSpace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PLASTIC = 1.2207440846057596
"""Root of g^4 = g + 1: the R3 sequence's generator (Roberts 2018, "The unreasonable effectiveness
of quasirandom sequences")."""
BLOCKS = 16
"""A class's samples are judged in this many runs of the sequence, each a lattice of its own."""
MIN_SAMPLES = 1024


@dataclass(frozen=True, slots=True)
class VoxelSample:
    """Voxels drawn from p_S, class after class.

    `index` (V, 3) voxel indices; `centers` (V, 3) [m]; `slices` and `masses` say which voxels stand
    for which class and how much of the prior the class holds.
    """

    index: Ints
    centers: Floats
    slices: tuple[slice, ...]
    names: tuple[str, ...]
    masses: tuple[float, ...]


def draw(
    densities: list[ClassDensity],
    space: PerceptionSpace,
    count: int,
    excluded: Floats | None = None,
    shift: tuple[float, float, float] = (0.5, 0.5, 0.5),
) -> VoxelSample:
    """Draw about `count` voxels from the prior, each class by its share.

    Parameters
    ----------
    densities : list of ClassDensity
    space : PerceptionSpace
    count : int
        Number of draws.
    excluded : (nx, ny) float, optional
        Heights (nx, ny) below which voxels carry no weight [m]: draws there are dropped.
    shift : (3,) float
        Start of the sequence in [0, 1).
    """
    if count < MIN_SAMPLES:
        raise InputError("evaluator", "samples", f"at least {MIN_SAMPLES}", count)
    parts, slices, masses, start = [], [], [], 0
    for density in densities:
        share = float(density.ground.sum())
        index = _draw_class(density, round(count * share), np.asarray(shift))
        if excluded is not None:
            index = index[~_below(index, excluded, space)]
        parts.append(index)
        slices.append(slice(start, start + len(index)))
        start += len(index)
        masses.append(share)
    index = np.concatenate(parts)
    names = tuple(d.name for d in densities)
    return VoxelSample(index, space.center_of(index), tuple(slices), names, tuple(masses))


def r3_sequence(count: int, shift: Floats) -> Floats:
    """(count, 3) points of the R3 low-discrepancy sequence in [0, 1)."""
    steps = PLASTIC ** -np.arange(1.0, 4.0)
    return (shift + np.arange(count)[:, None] * steps) % 1.0


def _draw_class(density: ClassDensity, count: int, shift: Floats) -> Ints:
    """(count, 3) voxel indices through the inverse cumulative distributions of x, y given x, z."""
    if count == 0:
        return np.zeros((0, 3), np.int64)
    u = r3_sequence(count, shift)
    rows = np.cumsum(density.ground.sum(axis=1))
    i = _inverse(rows, u[:, 0] * rows[-1])
    cells = np.cumsum(density.ground.reshape(-1))
    ny = density.ground.shape[1]
    before = np.concatenate([[0.0], cells])[i * ny]
    inside = before + u[:, 1] * (cells[(i + 1) * ny - 1] - before)
    j = np.clip(_inverse(cells, inside) - i * ny, 0, ny - 1)
    k = _inverse(np.cumsum(density.profile), u[:, 2] * float(density.profile.sum()))
    return np.stack([i, j, k], axis=1)


def _inverse(cumulative: Floats, values: Floats) -> Ints:
    found = np.searchsorted(cumulative, values, side="right")
    return np.minimum(found, len(cumulative) - 1)


def _below(index: Ints, heights: Floats, space: PerceptionSpace) -> NDArray[np.bool_]:
    z = space.centers(2)[index[:, 2]]
    below: NDArray[np.bool_] = z < heights[index[:, 0], index[:, 1]]
    return below

"""Voxels drawn from the prior by a low-discrepancy sequence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..prior.prior import ClassDensity
from ..scene.frozen import frozen
from ..scene.space import PerceptionSpace
from ..text.values import Whole
from .sobol import scrambled_sobol

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AZIMUTH, HEIGHT, RING = range(3)
"""What the Sobol' sequence's dimensions draw: its first two, which fill the plane best, the azimuth
and the height, in which beams are spaced; the third the distance."""
BLOCKS = 16
"""The sample is judged in this many runs of the sequence, each a lattice of its own."""
MIN_SAMPLES, MAX_SAMPLES = 1024, 2**24
"""Fewer say nothing; more than 16.8 million need more memory than a grid score."""
SAMPLES = Whole(MIN_SAMPLES, MAX_SAMPLES, "voxels")
CENTERED = (0.5, 0.5, 0.5)
AT_ONCE = 1 << 16

SAMPLES_OR_GRID = Whole(0, MAX_SAMPLES, "voxels")


def samples_or_grid(source: str, value: Any) -> int:
    """Return a number of samples (0: all); `InputError` for what is none."""
    count = SAMPLES_OR_GRID.checked(source, "samples", value)
    if 0 < count < MIN_SAMPLES:
        expected = f"0 (all), or a whole number of voxels >= {MIN_SAMPLES}"
        raise InputError(source, "samples", expected, count)
    return count


@dataclass(frozen=True, slots=True)
class VoxelSample:
    """Voxels drawn from p_S, nearest to the origin first: neighbours in memory are work alike.

    `index` (V, 3) voxel indices; `centers` (V, 3) [m]; `run` (V,) which of BLOCKS runs of the
    sequence drew each; `names` of the C classes; `classes` (V, C) how likely each voxel's object is
    of each class, rows summing to 1.
    """

    index: Ints
    centers: Floats
    run: Ints
    names: tuple[str, ...]
    classes: Floats


def draw(
    densities: list[ClassDensity],
    space: PerceptionSpace,
    count: int,
    excluded: Floats | None = None,
    shift: tuple[float, float, float] = CENTERED,
) -> VoxelSample:
    """Draw `count` voxels from the prior.

    A point of a scrambled Sobol' sequence is sent through the inverse cumulative distributions of
    the distance from the origin, of the azimuth given that, and of z given both, all of the whole
    prior: its classes are drawn together. Sensors see in rings and sectors, so what they see
    changes along the sequence's own axes.

    Parameters
    ----------
    densities : list of ClassDensity
    space : PerceptionSpace
    count : int
        Number of draws.
    excluded : (nx, ny) float, optional
        Heights below which voxels carry no weight [m]: draws there are dropped.
    shift : (3,) float
        Three numbers in [0, 1) that scramble the sequence.
    """
    count = SAMPLES.checked("evaluator", "samples", count)
    u = scrambled_sobol(count, shift)
    ground = np.sum([d.ground for d in densities], axis=0)
    i, j = _draw_column(ground, space, u[:, RING], u[:, AZIMUTH])
    k, classes = _draw_height(densities, i, j, u[:, HEIGHT])
    kept = _nearest_first(space.centers(0)[i], space.centers(1)[j])
    if excluded is not None:
        kept = kept[(space.centers(2)[k] >= excluded[i, j])[kept]]
    index = np.stack([i, j, k], axis=1)[kept]
    names = tuple(d.name for d in densities)
    return VoxelSample(index, space.center_of(index), kept * BLOCKS // count, names, classes[kept])


def _nearest_first(x: Floats, y: Floats) -> Ints:
    """Order of points by their distance from the origin."""
    return np.argsort(x * x + y * y, kind="stable")


def _draw_column(ground: Floats, space: PerceptionSpace, u: Floats, v: Floats) -> tuple[Ints, Ints]:
    """Column indices (V,) of a density over the ground (nx, ny): a ring, then a place in it."""
    ring, order = _rings(space)
    first = np.flatnonzero(np.diff(ring, prepend=-1))
    before = np.concatenate([[0.0], np.cumsum(ground.reshape(-1)[order])])
    starts = np.append(before[first], before[-1])
    chosen = _inverse(starts[1:], u * starts[-1])
    inside = starts[chosen] + v * (starts[chosen + 1] - starts[chosen])
    last = np.append(first[1:], len(order)) - 1
    place = np.clip(_inverse(before[1:], inside), first[chosen], last[chosen])
    i, j = np.divmod(order[place], ground.shape[1])
    return i, j


@lru_cache(maxsize=1)
def _rings(space: PerceptionSpace) -> tuple[Ints, Ints]:
    """Columns by ring, a voxel wide, round the origin, and by azimuth: rings and indices (N,).

    Kept, as a search draws samples of several sizes from one space.
    """
    x, y = np.meshgrid(space.centers(0), space.centers(1), indexing="ij")
    x, y = x.reshape(-1), y.reshape(-1)
    ring = np.floor(np.sqrt(x * x + y * y) / space.interval).astype(np.int64)
    # As good as the azimuth for sorting, and the same bits everywhere: y on a square of corners 1.
    around = y / np.maximum(np.abs(x) + np.abs(y), np.finfo(float).tiny)
    around = np.where(x >= 0.0, around, np.where(y >= 0.0, 2.0, -2.0) - around)
    order = np.lexsort((around, ring))
    return frozen(ring[order]), frozen(order)


def _draw_height(densities: list[ClassDensity], i: Ints, j: Ints, w: Floats) -> tuple[Ints, Floats]:
    """Height indices (V,) given the column, and the classes (V, C) of what is there."""
    profiles = np.stack([d.profile for d in densities])  # (C, nz)
    shares = np.stack([d.ground[i, j] for d in densities], axis=1)  # (V, C)
    k = np.empty(len(i), np.int64)
    for start in range(0, len(i), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        cumulative = np.cumsum(_mixed(shares[some], profiles), axis=1)
        below = cumulative <= (w[some] * cumulative[:, -1])[:, None]
        k[some] = np.minimum(below.sum(axis=1), profiles.shape[1] - 1)
    likely = shares * profiles[:, k].T
    return k, likely / likely.sum(axis=1, keepdims=True)


def _mixed(shares: Floats, profiles: Floats) -> Floats:
    """(V, nz) sum over classes of share times profile; no BLAS, so the same bits everywhere."""
    total = np.zeros((len(shares), profiles.shape[1]))
    for share, profile in zip(shares.T, profiles, strict=True):
        total += share[:, None] * profile
    return total


def _inverse(cumulative: Floats, values: Floats) -> Ints:
    found = np.searchsorted(cumulative, values, side="right")
    return np.minimum(found, len(cumulative) - 1)

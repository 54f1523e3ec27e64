"""The voxels that stand for places on the ground: which ones, and what each weighs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..prior.prior import ClassDensity
from ..scene.numbering import blocks
from ..scene.space import PerceptionSpace
from ..text.values import FINITE
from .cells import ROUNDING, GroundCells
from .regions import closed, gauss, without_specks

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AT_ONCE = 1 << 17
SPREAD_M = 0.7
"""Standard deviation of the Gauss curve: less than the objects are large."""
CLOSED = 1.5
"""Radius of the disc in which a sensor sees nothing, in standard deviations of the Gauss curve."""
GRAIN_M2 = 12.0
"""Of what a sensor sees, pieces smaller than this are taken for chance."""
NEXT_TO_NOTHING = 1e-9
"""What a column without mass weighs, of the heaviest: it counts among its like alone."""


@dataclass(frozen=True, eq=False)
class VoxelsByCell:
    """Voxels by cell: `index` (cells * K, 3), and what each weighs in its cell's mean, (cells, K).

    A voxel in the vehicle's own volume weighs nothing; a cell of nothing else is the vehicle's.
    With a `spread` [m], a mean takes the cells about as far away with it, by a Gauss curve, and
    what any voxel there has is set: see `by_prior`.
    """

    cells: GroundCells
    index: Ints
    weights: Floats
    spread: float = 0.0

    def mean(self, values: NDArray) -> Floats:
        """Means (NX, NY) of values of voxels; NaN where the vehicle is."""
        sums = self._spread_out((values.reshape(self.weights.shape) * self.weights).sum(axis=1))
        return sums / self._total

    def any(self, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a flag is set for any of a cell's voxels outside the vehicle, (NX, NY)."""
        found = flags.reshape(self.weights.shape) & (self.weights > 0.0)
        cells = found.any(axis=1).reshape(self.cells.shape)
        return self._without_grain(cells) if self.spread else cells

    def _without_grain(self, cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Fill what is too small to be told from chance, and drop what is."""
        filled = closed(cells, CLOSED * self.spread / self.cells.step)
        least = GRAIN_M2 / self.cells.step**2
        return without_specks(~without_specks(~filled, least), least)

    @cached_property
    def _total(self) -> Floats:
        """What cells weigh; NaN for the vehicle's."""
        total = self._spread_out(self.weights.sum(axis=1))
        return np.where(self.vehicle, np.nan, total)

    @cached_property
    def vehicle(self) -> NDArray[np.bool_]:
        """(NX, NY) cells that are the vehicle's own volume."""
        return ~(self.weights > 0.0).any(axis=1).reshape(self.cells.shape)

    def _spread_out(self, sums: Floats) -> Floats:
        """Take neighbouring cells with each."""
        cells: Floats = sums.reshape(self.cells.shape)
        return gauss(cells, self.spread / self.cells.step) if self.spread else cells


def in_layer(
    cells: GroundCells, space: PerceptionSpace, tops: Floats | None, layer: int
) -> VoxelsByCell:
    """Choose voxels of one layer, numbered from the lowest."""
    x, y, _ = cells.points(space.interval, over_height=False)
    i, j = _columns(space, x, y)
    weights = np.ones(x.shape)
    if tops is not None:
        weights[space.centers(2)[layer] < tops[i, j]] = 0.0
    index = np.stack([i, j, np.full_like(i, layer)], axis=-1).reshape(-1, 3)
    return VoxelsByCell(cells, index, weights)


def layer_at(space: PerceptionSpace, height: float) -> int:
    """Return the number of the layer of voxels that holds a height [m].

    Raises
    ------
    InputError
        When the space does not reach there.
    """
    height = FINITE.checked("sight", "height", height)
    layer = math.floor((height - space.z[0]) / space.interval + ROUNDING)
    if not 0 <= layer < space.shape[2]:
        expected = f"a height in the space, z = [{space.z[0]:g}, {space.z[1]:g}]"
        raise InputError("sight", "height", expected, f"{height:g}")
    return layer


def by_prior(
    cells: GroundCells, space: PerceptionSpace, tops: Floats | None, densities: list[ClassDensity]
) -> VoxelsByCell:
    """Choose voxels over height as the prior has it there, outside the vehicle (eq. 9).

    A voxel's height is drawn from the mix of the classes' profiles in its column, and its weight is
    the prior's mass there: a cell's mean is the prior's. Where no object is ever met the mix is
    that of the whole space, and columns weigh alike.

    Far away the beams of a LiDAR stand farther apart than voxels: whether one meets the voxel that
    is looked at, or the next, is chance, and would be drawn as grain. So means are spread over
    `SPREAD_M`, and a sensor sees a cell unless that lies in a disc of radius `CLOSED` times that in
    which it sees nothing; pieces smaller than `GRAIN_M2` are as what is round them.
    """
    x, y, share = cells.points(space.interval, over_height=True)
    i, j = _columns(space, x, y)
    first = np.zeros_like(i)
    if tops is not None:
        first = np.searchsorted(space.centers(2), tops[i, j].reshape(-1)).reshape(i.shape)
    columns = _WeightByColumn(densities)
    k, mass = np.empty(i.size, np.int64), np.empty(i.size)
    for some in blocks(i.size, AT_ONCE):
        at, beside, above = (w.reshape(-1)[some] for w in (i, j, first))
        k[some], mass[some] = columns.drawn(at, beside, above, share.reshape(-1)[some])
    weights = mass.reshape(i.shape)
    nobody = ~(weights > 0.0).any(axis=1)
    weights[nobody] = (first[nobody] < space.shape[2]) * NEXT_TO_NOTHING * weights.max()
    index = np.stack([i.reshape(-1), j.reshape(-1), k], axis=-1)
    return VoxelsByCell(cells, index, weights, SPREAD_M)


class _WeightByColumn:
    """The prior's mix of heights in columns."""

    def __init__(self, densities: list[ClassDensity]) -> None:
        self._grounds = [d.ground for d in densities]
        self._below = [np.concatenate([[0.0], np.cumsum(d.profile)]) for d in densities]
        self._everywhere = np.array([g.sum() for g in self._grounds])

    def drawn(self, i: Ints, j: Ints, first: Ints, share: Floats) -> tuple[Ints, Floats]:
        """Heights (V,) from `first` on that leave a share of the mass below; and the mass (V,)."""
        mix = np.stack([ground[i, j] for ground in self._grounds])  # (C, V)
        empty = mix.sum(axis=0) <= 0.0
        mix[:, empty] = self._everywhere[:, None]
        last = len(self._below[0]) - 2
        under, whole = self._upto(mix, first), self._upto(mix, np.full_like(first, last + 1))
        wanted = under + share * (whole - under)
        low, high = np.minimum(first, last), np.full_like(first, last)
        for _ in range(max(1, last + 1).bit_length()):
            middle = (low + high) // 2
            above = self._upto(mix, middle + 1) > wanted
            high, low = np.where(above, middle, high), np.where(above, low, middle + 1)
            low = np.minimum(low, high)
        return low, np.where(empty, 0.0, whole - under)

    def _upto(self, mix: Floats, k: Ints) -> Floats:
        """Mass below height k of each column."""
        total = np.zeros(mix.shape[1])
        for share, below in zip(mix, self._below, strict=True):
            total += share * below[k]
        return total


def _columns(space: PerceptionSpace, x: Floats, y: Floats) -> tuple[Ints, Ints]:
    """Columns (i, j) that hold points of the space [m]."""
    found = []
    for w, low, count in ((x, space.x[0], space.shape[0]), (y, space.y[0], space.shape[1])):
        whole = np.floor((w - low) / space.interval).astype(np.int64)
        found.append(np.clip(whole, 0, count - 1))
    return found[0], found[1]

"""What is visible: the map of the ground, and shares of the prior by sensor and zone.

A cell of the ground is represented by a set of voxels; what each sensor measures on them is
cached.
"""

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints, read_only
from ...base.errors import InputError
from ...base.notebook import ShortRepr
from ...base.values import FINITE
from ...geometry.bins import blocks
from ...geometry.grids import PerceptionSpace
from ...metric.fusion import Fusion
from ...prior.prior import ClassDensity
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import MeasurementCache, Voxels
from ..rig_batch import fused_early
from ..sampling import VoxelSample
from ..score import zone_masks
from .ground_cells import ROUNDING, GroundCells, closed, gauss, without_specks

K = TypeVar("K")

AT_ONCE = 1 << 17
SPREAD_M = 0.7
"""Standard deviation of the Gaussian filter: less than the size of objects."""
CLOSED = 1.5
"""Radius of the disc of the morphological closing, in standard deviations of the filter."""
GRAIN_M2 = 12.0  # Visible pieces smaller than this are taken for sampling noise
EMPTY_WEIGHT = 1e-9
"""Weight of a column without mass, as a share of the largest: it counts only among such columns."""
MAX_VOXELS = 4_000_000
"""How many voxels all cached sets have together, at most: some 100 bytes each."""


@dataclass(frozen=True, eq=False)
class VoxelsByCell:
    """Voxels by cell: `index` (cells * K, 3), and their weights in the cell's mean, (cells, K).

    A voxel in the vehicle's own volume has no weight; a cell with only such voxels is the
    vehicle's. With a `spread` [m], means are smoothed over the cells by a Gaussian filter, and
    flags by morphology: see `by_prior`.
    """

    cells: GroundCells
    index: Ints
    weights: Floats
    spread: float = 0.0

    def mean(self, values: NDArray) -> Floats:
        """Return the means (NX, NY) of values of voxels; NaN where the vehicle is."""
        sums = self._smoothed((values.reshape(self.weights.shape) * self.weights).sum(axis=1))
        return sums / self._total

    def any(self, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a flag is set for any of a cell's voxels outside the vehicle, (NX, NY)."""
        outside = flags.reshape(self.weights.shape) & (self.weights > 0.0)
        cells = outside.any(axis=1).reshape(self.cells.shape)
        if not self.spread:
            return cells
        # without holes and pieces that are too small to be distinguished from sampling noise
        filled = closed(cells, CLOSED * self.spread / self.cells.step)
        min_cells = GRAIN_M2 / self.cells.step**2
        return without_specks(~without_specks(~filled, min_cells), min_cells)

    @cached_property
    def _total(self) -> Floats:
        """Return the weights of cells; NaN for the vehicle's."""
        total = self._smoothed(self.weights.sum(axis=1))
        return np.where(self.vehicle, np.nan, total)

    @cached_property
    def vehicle(self) -> NDArray[np.bool_]:
        """(NX, NY) cells that are the vehicle's own volume."""
        return ~(self.weights > 0.0).any(axis=1).reshape(self.cells.shape)

    def _smoothed(self, sums: Floats) -> Floats:
        """Smooth sums over neighbouring cells."""
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
    """Return the number of the layer of voxels that holds a height [m]. `InputError` when it is not
    in the space."""
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

    The height of a voxel is sampled from the mix of the classes' profiles in its column, and its
    weight is the prior's mass there, so a cell's mean is the prior's. In a column without objects
    the mix is that of the whole space, and all such columns have the same weight.

    Far away, the beams of a LiDAR are farther apart than voxels: whether one passes through the
    sampled voxel or through the next one is random, and would show as noise in the map. So means
    are smoothed over `SPREAD_M`, and a cell is visible to a sensor unless it is in a disc of radius
    `CLOSED` times that without any visible cell; pieces smaller than `GRAIN_M2` are dropped.
    """
    x, y, share = cells.points(space.interval, over_height=True)
    i, j = _columns(space, x, y)
    first = np.zeros_like(i)
    if tops is not None:
        first = np.searchsorted(space.centers(2), tops[i, j].reshape(-1)).reshape(i.shape)
    columns = _WeightByColumn(densities)
    k = np.empty(i.size, np.int64)
    mass = np.empty(i.size)
    for some in blocks(i.size, AT_ONCE):
        at, beside, above = (w.reshape(-1)[some] for w in (i, j, first))
        k[some], mass[some] = columns.sampled(at, beside, above, share.reshape(-1)[some])
    weights = mass.reshape(i.shape)
    nobody = ~(weights > 0.0).any(axis=1)
    weights[nobody] = (first[nobody] < space.shape[2]) * EMPTY_WEIGHT * weights.max()
    index = np.stack([i.reshape(-1), j.reshape(-1), k], axis=-1)
    return VoxelsByCell(cells, index, weights, SPREAD_M)


class _WeightByColumn:
    """The distribution of heights in columns, by the prior's mix of classes."""

    def __init__(self, densities: list[ClassDensity]) -> None:
        self._grounds = [d.ground for d in densities]
        self._below = [np.concatenate([[0.0], np.cumsum(d.profile)]) for d in densities]
        self._everywhere = np.array([g.sum() for g in self._grounds])

    def sampled(self, i: Ints, j: Ints, first: Ints, share: Floats) -> tuple[Ints, Floats]:
        """Return heights (V,) from `first` on with a share of the mass below, and the mass (V,)."""
        mix = np.stack([ground[i, j] for ground in self._grounds])  # (C, V)
        empty = mix.sum(axis=0) <= 0.0
        mix[:, empty] = self._everywhere[:, None]
        last = len(self._below[0]) - 2
        under = self._upto(mix, first)
        whole = self._upto(mix, np.full_like(first, last + 1))
        wanted = under + share * (whole - under)
        low = np.minimum(first, last)
        high = np.full_like(first, last)
        for _ in range(max(1, last + 1).bit_length()):
            middle = (low + high) // 2
            above = self._upto(mix, middle + 1) > wanted
            high = np.where(above, middle, high)
            low = np.where(above, low, middle + 1)
            low = np.minimum(low, high)
        return low, np.where(empty, 0.0, whole - under)

    def _upto(self, mix: Floats, k: Ints) -> Floats:
        """Return the mass below height k of each column."""
        total = np.zeros(mix.shape[1])
        for share, below in zip(mix, self._below, strict=True):
            total += share * below[k]
        return total


def _columns(space: PerceptionSpace, x: Floats, y: Floats) -> tuple[Ints, Ints]:
    """Return the columns (i, j) that contain points of the space [m]."""
    columns = []
    for w, low, count in ((x, space.x[0], space.shape[0]), (y, space.y[0], space.shape[1])):
        whole = np.floor((w - low) / space.interval).astype(np.int64)
        columns.append(np.clip(whole, 0, count - 1))
    return columns[0], columns[1]


class MeasuredVoxels:
    """A set of voxels, with its `index` (V, 3), and the sensors measured on them."""

    def __init__(
        self, voxels: Any, sensors: MeasurementCache, fusion: Fusion, centers: Floats
    ) -> None:
        self.voxels = voxels
        self._sensors = sensors
        self._fusion = fusion
        self._distance = np.hypot(*centers[:, :2].T)

    @property
    def size(self) -> int:
        """Number of voxels."""
        return len(self.voxels.index)

    def measured(self, rig: Rig) -> dict[str, NDArray]:
        """Return m (V,) of each sensor by name, with the range terms of their curves."""
        self._sensors.measure(rig)
        named = [(s.detector, self._sensors.m[s.name]) for s in rig]
        terms = self._fusion.ranged(named, self._distance)
        return {s.name: of_sensor for s, (_, of_sensor) in zip(rig, terms, strict=True)}


class VoxelSetCache:
    """A cache of voxel sets: those that were used last, up to `MAX_VOXELS`."""

    def __init__(self, space: PerceptionSpace, vehicle: Vehicle | None, fusion: Fusion) -> None:
        self._space = space
        self._vehicle = vehicle
        self._fusion = fusion
        self.kernel_cache: dict[str, Any] = {}  # by kind: beams are cast once for all voxel sets
        self._sets: dict[Hashable, Any] = {}  # least recently used first

    def voxels(self, key: Hashable, choose: Callable[[], Any]) -> MeasuredVoxels:
        """Return the voxel set with a key, from the cache or newly chosen."""

        def measurable() -> MeasuredVoxels:
            chosen = choose()
            voxels = Voxels(self._space, chosen.index, self._space.center_of(chosen.index))
            count = self._fusion.saturation_count
            sensors = MeasurementCache(voxels, self._vehicle, count, self.kernel_cache)
            return MeasuredVoxels(chosen, sensors, self._fusion, voxels.centers)

        return self.cached(key, measurable)

    def cached(self, key: Hashable, make: Callable[[], K]) -> K:
        """Return the value with a key, from the cache or newly made; it has a `size` in voxels."""
        value: K = self._sets.pop(key, None) or make()
        self._sets[key] = value
        room = MAX_VOXELS
        for other in reversed(tuple(self._sets)):
            room -= self._sets[other].size
            if room < 0 and other != key:
                del self._sets[other]
        return value


@dataclass(frozen=True, slots=True, eq=False)
class GroundSight(ShortRepr):
    """What is visible to a rig in every cell of the ground.

    Attributes
    ----------
    x : (NX,) float
    y : (NY,) float
        Middles of the cells [m].
    step : float
        Side of a cell [m].
    height : float or None
        Height of the evaluated voxels [m]; None: averaged over height by the prior, as in a score.
    entropy : (NX, NY) float
        Mean H of a cell, eq. 8 [nats]; NaN where the vehicle is.
    coverage : (NX, NY) float
        Share of a cell that is visible to a sensor, 0 to 1; NaN where the vehicle is.
    sensors : (NX, NY) int
        Number of sensors that see a part of a cell; -1 where the vehicle is.
    kinds : (NX, NY) int
        Number of kinds of sensors that see a part of a cell; -1 where the vehicle is.
    """

    x: Floats
    y: Floats
    step: float
    height: float | None
    entropy: Floats
    coverage: Floats
    sensors: Ints
    kinds: Ints


def ground_sight(
    voxels: VoxelsByCell, rig: Rig, m: Mapping[str, NDArray], fusion: Fusion, height: float | None
) -> GroundSight:
    """Combine the measurements `m` (by sensor name) on the voxels of cells."""
    entropies, visible = fusion.entropies(fused_early(rig, m, [s.name for s in rig]))
    by_sensor = {s.name: voxels.any(m[s.name] > 0) for s in rig}
    by_kind: dict[str, NDArray[np.bool_]] = {}
    for s in rig:
        by_kind[s.kind] = by_kind.get(s.kind, False) | by_sensor[s.name]
    return GroundSight(
        x=read_only(voxels.cells.x),
        y=read_only(voxels.cells.y),
        step=voxels.cells.step,
        height=height,
        entropy=read_only(voxels.mean(entropies)),
        coverage=read_only(voxels.mean(visible)),
        sensors=read_only(_number(by_sensor, voxels)),
        kinds=read_only(_number(by_kind, voxels)),
    )


def _number(flags: Mapping[str, NDArray[np.bool_]], voxels: VoxelsByCell) -> Ints:
    """Number of flags set in each cell; -1 where the vehicle is."""
    total = np.sum(list(flags.values()), axis=0, dtype=np.int64)
    return np.where(voxels.vehicle, -1, total)


@dataclass(frozen=True, slots=True)
class VisibleShares:
    """Visible shares of the prior, 0 to 1.

    `by_number`: By at least 0, 1, 2, ... sensors, up to all of them.
    `zones`: By sensor and zone (`scoring.zones.ZONES`): the share of the zone that the sensor sees.
        A zone without prior mass is left out.
    `losses`: By sensor and zone: how much the zone's mean entropy rises when the sensor fails
        [nats].
    """

    by_number: tuple[float, ...]
    zones: Mapping[str, Mapping[str, float]]
    losses: Mapping[str, Mapping[str, float]]


def visible_shares(
    sample: VoxelSample, m: Mapping[str, NDArray], rises: Mapping[str, NDArray]
) -> VisibleShares:
    """Aggregate measurements over a sample of the prior. By sensor, `m` (V,) is its measurement,
    and `rises` (V,) how much the entropy of each voxel rises without it [nats]."""
    sees = {name: of_one > 0 for name, of_one in m.items()}
    number = np.sum(list(sees.values()), axis=0, dtype=np.int64)
    masks = zone_masks(sample.centers[:, 0], sample.centers[:, 1])

    def by_zone(values: Mapping[str, NDArray]) -> dict[str, dict[str, float]]:
        return {
            name: {zone: float(np.mean(shares[mask])) for zone, mask in masks.items() if mask.any()}
            for name, shares in values.items()
        }

    by_number = tuple(float(np.mean(number >= n)) for n in range(len(m) + 1))
    return VisibleShares(by_number, by_zone(sees), by_zone(rises))

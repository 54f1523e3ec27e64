"""Voxels sampled from the prior by a scrambled Sobol' sequence, and the densities of its classes.

The sequence is computed in integers only, so that its bits are the same on every system. It is
scrambled as Owen proposes, by hashing (Laine and Karras 2011; the constants are Vegdahl's, as in
Burley 2020, "Practical Hash-based Owen Scrambling"). Scrambling removes the regularity that a
pattern of beams may be in step with; each run of 2^k points remains a low-discrepancy net.

The vehicle's own volume carries no weight in eq. 9.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints, read_only
from ..base.errors import InputError
from ..base.values import Whole
from ..geometry.bins import stable_order
from ..geometry.grids import PerceptionSpace
from ..prior.prior import ClassDensity

Words = NDArray[np.uint32]
BITS = 32
WORD = (1 << BITS) - 1
PRIMITIVE = (
    (0, (1,)),
    (1, (1, 3)),
    (1, (1, 3, 1)),
    (2, (1, 1, 1)),
    (1, (1, 1, 3, 3)),
    (4, (1, 3, 5, 13)),
)
"""Of each dimension but the first, which is the van der Corput sequence: the inner coefficients of
a primitive polynomial as a number, and first direction numbers m (Joe and Kuo 2008)."""
DIMENSIONS = 1 + len(PRIMITIVE)
MASKS = ((0x55555555, 1), (0x33333333, 2), (0x0F0F0F0F, 4), (0x00FF00FF, 8), (0x0000FFFF, 16))
ODDS = (0x9E3779B9, 0x85EBCA6B, 0xC2B2AE35)
"""Constants that separate the seeds of the dimensions, and mix them (the last two: MurmurHash3)."""
AZIMUTH, HEIGHT, RING = range(3)
"""Use of the Sobol' sequence's dimensions. The first two fill the plane best: they sample azimuth
and height, in which beams are spaced. The third one samples the distance."""
BLOCKS = 16
"""Number of runs of the sequence for the standard error; each run is a lattice."""
MIN_SAMPLES = 1024
MAX_SAMPLES = 2**24
"""Fewer samples are useless; more than 16.8 million need more memory than a grid score."""
SAMPLES = Whole(MIN_SAMPLES, MAX_SAMPLES, "voxels")
FIRST_SAMPLES = 262_144
"""Voxels that a score of a newly made study evaluates, in a file or in Blender: seconds instead of
minutes. A study file that does not name them is scored on all voxels."""
Shift = tuple[float, float, float]
"""Three numbers in [0, 1) that scramble a sample's sequence: others give another sample."""
CENTERED: Shift = (0.5, 0.5, 0.5)
"""Shift of the sample that results are reported on."""
SEARCHED: Shift = (0.319, 0.171, 0.049)
"""Shift of the sample that a search evaluates its candidates on. A placement fits the voxels that
it was searched on, so its score on them is too good: it is reported on those of `CENTERED`."""
HELD_OUT: tuple[Shift, ...] = (CENTERED, (0.819, 0.671, 0.549))
"""Shifts of samples that no search uses; the difference of two estimates tells their error."""
AZIMUTHS = 1 << 16
"""Azimuths by which the columns of a ring are sorted at first."""
AT_ONCE = 1 << 11
"""Voxels whose heights are drawn together: their profiles fit the processor's cache."""


def scrambled_sobol(count: int, shift: Sequence[float]) -> Floats:
    """Return points (count, D) in [0, 1), scrambled by D <= 7 numbers in [0, 1)."""
    columns = [_sobol(count, dimension) for dimension in range(len(shift))]
    scrambled = [
        _scrambled(c, _seed(s, d)) for d, (c, s) in enumerate(zip(columns, shift, strict=True))
    ]
    return np.stack(scrambled, axis=1) / float(1 << BITS)


def _sobol(count: int, dimension: int) -> Words:
    """Return one coordinate of the points, in 32 bits."""
    points = np.zeros(count, np.uint32)
    number = np.arange(count, dtype=np.uint32)
    for bit, word in enumerate(_directions(dimension)[: max(count - 1, 1).bit_length()]):
        points ^= ((number >> np.uint32(bit)) & np.uint32(1)) * np.uint32(word)
    return points


def _directions(dimension: int) -> list[int]:
    """Return a dimension's direction numbers: what each bit of a point's number adds."""
    if dimension == 0:
        return [1 << (BITS - 1 - bit) for bit in range(BITS)]
    inner, odd = PRIMITIVE[dimension - 1]
    degree = len(odd)
    words = [m << (BITS - 1 - bit) for bit, m in enumerate(odd)]
    for bit in range(degree, BITS):
        word = words[bit - degree] ^ (words[bit - degree] >> degree)
        for back in range(1, degree):
            word ^= words[bit - back] * (inner >> (degree - 1 - back) & 1)
        words.append(word)
    return words


def _seed(shift: float, dimension: int) -> int:
    """Mix a number in [0, 1) and a dimension into 32 bits."""
    seed = (int(shift * (1 << BITS)) + (dimension + 1) * ODDS[0]) & WORD
    for odd, down in ((ODDS[1], 16), (ODDS[2], 13)):
        seed = ((seed ^ (seed >> down)) * odd) & WORD
    return seed ^ (seed >> 16)


def _scrambled(points: Words, seed: int) -> Words:
    """Flip each bit by a hash of the bits above it."""
    x = _reversed(points)
    x ^= x * np.uint32(0x3D20ADEA)
    x += np.uint32(seed)
    x *= np.uint32((seed >> 16) | 1)
    x ^= x * np.uint32(0x05526C56)
    x ^= x * np.uint32(0x53A22864)
    return _reversed(x)


def _reversed(words: Words) -> Words:
    """Mirror the bits of each word."""
    x = words.copy()
    for mask, step in MASKS:
        x = ((x >> np.uint32(step)) & np.uint32(mask)) | ((x & np.uint32(mask)) << np.uint32(step))
    return x


@dataclass(frozen=True, slots=True)
class SamplesOrGrid(Whole):
    """A number of sampled voxels; 0 stands for all voxels of the grid."""

    def checked(self, source: object, field: str, value: Any) -> int:
        """Return the value, or raise `InputError`."""
        count = Whole.checked(self, source, field, value)
        if 0 < count < MIN_SAMPLES:
            expected = f"0 (all), or a whole number of voxels >= {MIN_SAMPLES}"
            raise InputError(source, field, expected, count)
        return count


SAMPLES_OR_GRID = SamplesOrGrid(0, MAX_SAMPLES, "voxels")


@dataclass(frozen=True, slots=True)
class VoxelSample:
    """Voxels drawn from p_S, sorted by distance: neighbours in memory cost about the same.

    `index` (V, 3) voxel indices; `centers` (V, 3) [m]; `run` (V,) which of BLOCKS runs of the
    sequence drew each; `names` of the C classes; `classes` (V, C) probability of each class for
    the voxel's object, rows summing to 1.
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
    shift: Shift = CENTERED,
) -> VoxelSample:
    """Draw `count` voxels from the prior.

    A point of a scrambled Sobol' sequence is sent through the inverse cumulative distributions of
    the distance from the origin, of the azimuth at that distance, and of z at both. All classes
    are drawn together, from the whole prior. Sensors see in rings and sectors, so visibility
    changes along the axes of the sequence.

    `count`: Number of draws.
    `excluded` (nx, ny): Heights below which voxels carry no weight [m]: draws there are dropped.
    `shift` (3,): Three numbers in [0, 1) that scramble the sequence.
    """
    count = SAMPLES.checked("evaluator", "samples", count)
    u = scrambled_sobol(count, shift)
    ground = reduce(np.add, (d.ground for d in densities))
    i, j = _draw_column(ground, space, u[:, RING], u[:, AZIMUTH])
    k, classes = _draw_height(densities, i, j, u[:, HEIGHT])
    x = space.centers(0)[i]
    y = space.centers(1)[j]
    rows = np.argsort(x * x + y * y, kind="stable")
    if excluded is not None:
        rows = rows[(space.centers(2)[k] >= excluded[i, j])[rows]]
    index = np.stack([i, j, k], axis=1)[rows]
    names = tuple(d.name for d in densities)
    return VoxelSample(
        index, space.center_of(index), rows * BLOCKS // count, names, classes=classes[rows]
    )


def _draw_column(ground: Floats, space: PerceptionSpace, u: Floats, v: Floats) -> tuple[Ints, Ints]:
    """Draw column indices (V,) from a density over the ground (nx, ny): a ring, then a column."""
    ring, order = _rings(space)
    first = np.flatnonzero(np.diff(ring, prepend=-1))
    before = np.concatenate([[0.0], np.cumsum(ground.reshape(-1)[order])])
    starts = np.append(before[first], before[-1])
    rings = _inverse(starts[1:], u * starts[-1])
    inside = starts[rings] + v * (starts[rings + 1] - starts[rings])
    last = np.append(first[1:], len(order)) - 1
    position = np.clip(_inverse(before[1:], inside), first[rings], last[rings])
    i, j = np.divmod(order[position], ground.shape[1])
    return i, j


@lru_cache(maxsize=1)
def _rings(space: PerceptionSpace) -> tuple[Ints, Ints]:
    """Sort columns by ring (one voxel wide) and azimuth; return rings and column indices (N,). It
    is cached, because a search draws samples of several sizes from one space."""
    x = space.centers(0)[:, None]
    y = space.centers(1)
    ring = np.floor(np.sqrt(x * x + y * y) / space.interval).astype(np.int64).reshape(-1)
    # y on the unit square sorts like the azimuth, and has the same bits on every system.
    around = y / np.maximum(np.abs(x) + np.abs(y), np.finfo(float).tiny)
    around = np.where(x >= 0.0, around, np.where(y >= 0.0, 2.0, -2.0) - around).reshape(-1)
    order = _ring_order(ring, around) if ring.max() < AZIMUTHS else np.lexsort((around, ring))
    return read_only(ring[order]), read_only(order)


def _ring_order(rings: Ints, azimuths: Floats) -> Ints:
    """Return the stable order by ring of 16 bits, then by azimuth in -2 .. 2."""
    # Azimuths as fine as 16 bits are sorted by their digits; only columns with equal keys are
    # then sorted by the azimuth itself.
    keys = rings * AZIMUTHS + ((azimuths + 2.0) * ((AZIMUTHS - 1) / 4.0)).astype(np.int64)
    order = stable_order(keys)
    sorted_keys = keys[order]
    repeats = np.pad(sorted_keys[1:] == sorted_keys[:-1], 1)
    is_tied = repeats[1:] | repeats[:-1]
    tied = order[is_tied]
    order[is_tied] = tied[np.lexsort((azimuths[tied], keys[tied]))]
    return order


def _draw_height(densities: list[ClassDensity], i: Ints, j: Ints, w: Floats) -> tuple[Ints, Floats]:
    """Draw height indices (V,) in columns; return them and class probabilities (V, C)."""
    profiles = np.stack([d.profile for d in densities])  # (C, nz)
    shares = np.stack([d.ground[i, j] for d in densities], axis=1)  # (V, C)
    k = np.empty(len(i), np.int64)
    for start in range(0, len(i), AT_ONCE):
        block = slice(start, start + AT_ONCE)
        cumulative = np.cumsum(_mixed(shares[block], profiles), axis=1)
        below = cumulative <= (w[block] * cumulative[:, -1])[:, None]
        k[block] = np.minimum(below.sum(axis=1), profiles.shape[1] - 1)
    likely = shares * profiles[:, k].T
    return k, likely / likely.sum(axis=1, keepdims=True)


def _mixed(shares: Floats, profiles: Floats) -> Floats:
    """Return (V, nz): the sum over classes of share times profile; without BLAS, for equal bits."""
    total = np.zeros((len(shares), profiles.shape[1]))
    for share, profile in zip(shares.T, profiles, strict=True):
        total += share[:, None] * profile
    return total


def _inverse(cumulative: Floats, values: Floats) -> Ints:
    indices = np.searchsorted(cumulative, values, side="right")
    return np.minimum(indices, len(cumulative) - 1)


def outside_profile(density: ClassDensity, space: PerceptionSpace, tops: Floats) -> Floats:
    """Sum the class's height profile over voxels outside the vehicle, by column."""
    return _profile_from(density, _layers_below(space, tops))


def _layers_below(space: PerceptionSpace, tops: Floats) -> Ints:
    """Return the number of layers (nx, ny) whose centres are below these heights."""
    below = np.searchsorted(space.centers(2), tops.reshape(-1), side="left")
    return below.reshape(tops.shape)


def _profile_from(density: ClassDensity, layer: Ints) -> Floats:
    """Sum the class's height profile from these layers (nx, ny) up."""
    above = np.append(np.cumsum(density.profile[::-1])[::-1], 0.0)
    return np.asarray(above[layer])


def outside_masses(
    densities: list[ClassDensity], space: PerceptionSpace, tops: Floats | None
) -> list[float]:
    """Return each class's mass of the prior outside the vehicle (`tops` None: no vehicle).
    `InputError` when no weight is left outside."""
    if tops is None:
        return [float(d.ground.sum()) for d in densities]
    below = _layers_below(space, tops)  # of all classes
    masses = [float((d.ground * _profile_from(d, below)).sum()) for d in densities]
    if not sum(masses) > 0.0:
        raise InputError("prior", "weights", "some weight outside the vehicle", "none")
    return masses

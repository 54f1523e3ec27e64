"""Rank correlation: Spearman's rho, what chance gives, corrections for several tests, bootstraps.

A placement is a sample. Placements of one vehicle are a group; a statistic is the mean over the
groups, so that a difference between vehicles is no correlation.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.base import Flags, Floats, Ints
from pe_core.geometry.bins import blocks

Interval = tuple[float, float]

MAX_PLACEMENTS = 9
"""9! permutations are 360 thousand; one more placement would make 3.6 million."""
SAME = 1e-9
"""Correlations that differ by less than this are equal."""
MIN_GROUP = 3
"""A group of fewer placements has no rank correlation worth the name."""
STUDENT = {2: 4.302653, 3: 3.182446, 5: 2.570582}
"""Student's quantile at 0.975 by degrees of freedom."""
PERMUTED_AT_ONCE = 500
AT_ONCE = 2_000_000
"""Comparisons that are done at once, to limit memory."""


def midranks(values: ArrayLike) -> Floats:
    """Return ranks along the last axis, from 1 up; equal values have the mean of their ranks."""
    array = np.asarray(values, dtype=float)
    if array.ndim == 1:  # there may be thousands
        _, which, count = np.unique(array, return_inverse=True, return_counts=True)
        return np.asarray((np.cumsum(count) - (count - 1) / 2.0)[which])
    lower = (array[..., None, :] < array[..., :, None]).sum(axis=-1)
    equal = (array[..., None, :] == array[..., :, None]).sum(axis=-1)
    return np.asarray(lower + (equal + 1) / 2.0)


def standard_ranks(values: ArrayLike) -> Floats:
    """Return midranks minus their mean, scaled to length 1; zeros where all values are equal.

    Spearman's rho is the scalar product of two of these.
    """
    ranks = midranks(values)
    centred = ranks - ranks.mean(axis=-1, keepdims=True)
    length = np.sqrt((centred**2).sum(axis=-1, keepdims=True))
    return np.asarray(centred / np.where(length > 0.0, length, 1.0))


def spearman(first: ArrayLike, second: ArrayLike) -> float | None:
    """Return Spearman's rho; None where all values of one of the two are equal."""
    a = standard_ranks(first)
    b = standard_ranks(second)
    return float((a * b).sum()) if a.any() and b.any() else None


def mean_ranks(aps: Sequence[Sequence[float]]) -> Floats:
    """Return the mean of several detectors' standard ranks, (n,), but for those that rank nothing.

    The scalar product of a score's standard ranks with it is the score's mean rho.
    """
    return np.mean([r for r in map(standard_ranks, aps) if r.any()], axis=0)


def under_chance(score: Sequence[float], aps: Sequence[Sequence[float]]) -> Floats | None:
    """Return the distribution of the mean rho under chance, (n!,), sorted; None as in `spearman`.

    It has the mean rho over the detectors (`aps` has the AP of the placements of each) for every
    permutation of the placements. A permutation is the same for all detectors: detectors that were
    trained on the same placements are no further samples.
    """
    ranks = standard_ranks(score)
    if not ranks.any():
        return None
    return np.sort((ranks[permutations(len(ranks))] * mean_ranks(aps)).sum(axis=1))


@cache
def permutations(count: int) -> Ints:
    """Return all permutations of so many placements, (count!, count)."""
    if count > MAX_PLACEMENTS:
        raise ValueError(f"{count} placements have too many permutations")
    return np.array(list(itertools.permutations(range(count))))


def exact_p(observed: float, chance: Floats) -> float:
    """Return the two-sided p: the share of permutations whose mean rho is as far from zero."""
    return float((np.abs(chance) >= abs(observed) - SAME).mean())


def exact_p_of_mean(observed: float, first: Floats, second: Floats) -> float:
    """Return the two-sided p of the mean of two papers' rho, over all pairs of permutations.

    `first` and `second` are the papers' sorted distributions from `under_chance`.
    """
    edge = 2.0 * abs(observed) - SAME
    at_least = len(second) - np.searchsorted(second, edge - first, side="left")
    at_most = np.searchsorted(second, -edge - first, side="right")
    return float(min(1.0, (at_least.sum() + at_most.sum()) / (len(first) * len(second))))


def min_significant_rho(count: int, significance: float = 0.05) -> float | None:
    """Return the smallest significant rho of so many placements without ties, or None.

    It is significant by the exact p of a single test; there is none for very few placements.
    """
    ranks = list(map(float, range(count)))
    chance = under_chance(ranks, [ranks])
    assert chance is not None
    positive = sorted({round(float(rho), 9) for rho in chance if rho > 0.0})
    return next((rho for rho in positive if exact_p(rho, chance) <= significance), None)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return Holm's adjusted p values, in the same order."""
    count = len(p_values)
    adjusted = [0.0] * count
    highest = 0.0
    for rank, index in enumerate(sorted(range(count), key=lambda i: p_values[i])):
        highest = max(highest, min(1.0, (count - rank) * p_values[index]))
        adjusted[index] = highest
    return adjusted


def agreement(aps: Sequence[Sequence[float]]) -> float | None:
    """Return how well detectors agree: the mean rho of each with the mean ranks of the others.

    No score can be expected to rank like detectors that do not rank like each other.
    """
    rhos = [
        spearman(aps[i], mean_ranks([*aps[:i], *aps[i + 1 :]]).tolist()) for i in range(len(aps))
    ]
    defined = [rho for rho in rhos if rho is not None]
    return float(np.mean(defined)) if defined else None


# Placements in groups, with seeds.


@dataclass(frozen=True, eq=False)
class Resample:
    """Bootstrap samples: indices of placements (R, P), in their groups, and mean AP (R, P)."""

    index: Ints
    ap: Floats


Statistic = Callable[[Resample], Floats]
"""Maps bootstrap samples to (R,) numbers."""


@dataclass(frozen=True, eq=False)
class PlacementSamples:
    """Placements: AP by placement and seed (P, S), and of each (P,) its vehicle and hardware."""

    aps: Floats
    groups: NDArray
    hardware: NDArray

    @cached_property
    def ap(self) -> Floats:
        """Mean AP of each placement, (P,)."""
        return np.asarray(self.aps.mean(axis=1))

    @property
    def whole(self) -> Resample:
        """All placements, once each."""
        return Resample(np.arange(len(self.ap)), self.ap)

    @cached_property
    def members(self) -> list[Ints]:
        """Indices of the placements of each group that has enough."""
        found = [np.flatnonzero(self.groups == g) for g in np.unique(self.groups)]
        return [index for index in found if len(index) >= MIN_GROUP]

    def subset(self, index: Ints) -> PlacementSamples:
        """Return some of the placements."""
        return PlacementSamples(self.aps[index], self.groups[index], self.hardware[index])

    @property
    def noise(self) -> float:
        """Standard deviation over seeds, pooled over the placements; NaN for one seed."""
        if self.aps.shape[1] < 2:
            return float("nan")
        return float(np.sqrt(self.aps.var(axis=1, ddof=1).mean()))

    def better_half(self) -> tuple[Ints, PlacementSamples]:
        """Return the half of each group with the higher AP at the first seed, with the other seeds.

        Selection and result do not share their noise. The indices (Q,) are those of the placements.
        """
        index = np.sort(
            np.concatenate(
                [
                    group[np.argsort(-self.aps[group, 0], kind="stable")[: (len(group) + 1) // 2]]
                    for group in self.members
                ]
            )
        )
        part = self.subset(index)
        return index, PlacementSamples(part.aps[:, 1:], part.groups, part.hardware)


def rho_within(score: Floats, ap: Floats, members: Sequence[Ints]) -> Floats:
    """Return the mean over groups of Spearman's rho, (...); arrays are (..., P)."""
    rhos = [
        (standard_ranks(score[..., index]) * standard_ranks(ap[..., index])).sum(axis=-1)
        for index in members
    ]
    return np.mean(rhos, axis=0)


def partial_rho(score: Floats, ap: Floats, given: Floats, members: Sequence[Ints]) -> Floats:
    """Return the mean over groups of the partial rank correlation of score and AP, given a third.

    The partial correlation of ranks: (r_xy - r_xz r_yz) / sqrt((1 - r_xz^2) (1 - r_yz^2)).
    """
    parts = []
    for index in members:
        x, y, z = (standard_ranks(w[..., index]) for w in (score, ap, given))
        parts.append(_partial((x * y).sum(axis=-1), (x * z).sum(axis=-1), (y * z).sum(axis=-1)))
    return np.mean(parts, axis=0)


def _partial(xy: Floats, xz: Floats, yz: Floats) -> Floats:
    """Return the partial correlation of x and y given z; 0 where z leaves nothing of one."""
    free = np.sqrt(np.maximum((1.0 - xz**2) * (1.0 - yz**2), 0.0))
    return np.where(free > SAME, (xy - xz * yz) / np.maximum(free, SAME), 0.0)


def rho_statistic(
    values: Floats, samples: PlacementSamples, given: Floats | None = None
) -> Statistic:
    """Return the statistic: rho of values with AP, or their partial rho, given others."""

    def of(drawn: Resample) -> Floats:
        if given is None:
            return rho_within(values[drawn.index], drawn.ap, samples.members)
        return partial_rho(values[drawn.index], drawn.ap, given[drawn.index], samples.members)

    return of


def permutation_p_beyond(
    score: Floats, given: Floats, samples: PlacementSamples, rule: Any, seed: int
) -> float:
    """Return the two-sided p of the partial rho, given a third, as `permutation_p`."""
    observed = abs(float(rho_statistic(score, samples, given)(samples.whole)))
    rng = np.random.default_rng([seed, 2])
    ranks = [
        tuple(standard_ranks(w[k]) for w in (score, samples.ap, given)) for k in samples.members
    ]
    extreme = 0
    for block in blocks(rule.permutations, PERMUTED_AT_ONCE):
        count = block.stop - block.start
        parts = []
        for x, y, z in ranks:
            drawn = rng.permuted(np.tile(y, (count, 1)), axis=1)
            parts.append(_partial(drawn @ x, np.asarray(x @ z), drawn @ z))
        found = np.mean(parts, axis=0)
        extreme += int((np.abs(found) >= observed - SAME).sum())
    return (1 + extreme) / (1 + rule.permutations)


def permutation_p(score: Floats, samples: PlacementSamples, rule: Any, seed: int) -> float:
    """Return the two-sided p of rho: placements are permuted within their groups at random.

    The observed order counts as one of the permutations, so p is never 0.
    """
    observed = float(rho_within(score, samples.ap, samples.members))
    rng = np.random.default_rng([seed, 2])
    total = np.zeros(rule.permutations)
    for index in samples.members:
        fixed = standard_ranks(score[index])
        moved = standard_ranks(samples.ap[index])
        tiled = np.broadcast_to(moved, (rule.permutations, len(index)))
        total += (rng.permuted(tiled, axis=1) * fixed).sum(axis=1)
    extreme = np.abs(total / len(samples.members)) >= abs(observed) - SAME
    return float((1 + extreme.sum()) / (1 + rule.permutations))


def resamples(samples: PlacementSamples, rule: Any, seed: int) -> Iterator[Resample]:
    """Yield bootstrap samples in portions: placements within groups, and for each its seeds."""
    rng = np.random.default_rng([seed, 3])
    placements, seeds = samples.aps.shape
    portion = max(1, AT_ONCE // max(placements**2, 1))
    for first in range(0, rule.resamples, portion):
        count = min(portion, rule.resamples - first)
        index = np.tile(np.arange(placements), (count, 1))
        for members in samples.members:
            index[:, members] = members[rng.integers(0, len(members), (count, len(members)))]
        drawn = rng.integers(0, seeds, (count, placements, seeds))
        yield Resample(index, samples.aps[index[..., None], drawn].mean(axis=-1))


def interval(samples: PlacementSamples, rule: Any, seed: int, statistic: Statistic) -> Interval:
    """Return the percentile interval of a statistic."""
    values = np.concatenate([statistic(portion) for portion in resamples(samples, rule, seed)])
    low, high = np.nanpercentile(values, [2.5, 97.5])
    return float(low), float(high)


def bca_interval(
    values: Floats, samples: PlacementSamples, rule: Any, seed: int, given: Floats | None = None
) -> tuple[Interval, float]:
    """Return the interval of rho, corrected for bias and skewness, and the mean of the bootstraps.

    With a third variable, `given` (P,), it is that of the partial rho.

    BCa: Efron, Better bootstrap confidence intervals, JASA 82 (1987). The bootstraps are those of
    `interval`; the acceleration is the jackknife's, a placement left out at a time.
    """
    statistic = rho_statistic(values, samples, given)
    every = np.arange(len(values))
    rhos = np.concatenate([statistic(portion) for portion in resamples(samples, rule, seed)])
    rho = float(statistic(samples.whole))
    left_out = np.array([_without(values, samples, np.delete(every, k), given) for k in every])
    return bca_limits(rho, rhos, left_out), float(rhos.mean())


def bca_limits(value: float, drawn: Floats, left_out: Floats) -> Interval:
    """Return the BCa interval (95 %) of a statistic.

    `drawn` (R,) are its bootstraps, `left_out` (P,) its values without each of the samples.
    """
    normal = NormalDist()
    below = float((drawn < value - SAME).mean() + 0.5 * (np.abs(drawn - value) <= SAME).mean())
    bias = normal.inv_cdf(min(max(below, 1.0 / len(drawn)), 1.0 - 1.0 / len(drawn)))
    off = left_out.mean() - left_out
    acceleration = float((off**3).sum() / (6.0 * max((off**2).sum(), SAME) ** 1.5))
    levels = []
    for p in (0.025, 0.975):
        shifted = bias + normal.inv_cdf(p)
        levels.append(100.0 * normal.cdf(bias + shifted / (1.0 - acceleration * shifted)))
    low, high = np.percentile(drawn, levels)
    return float(low), float(high)


def rank_figures(
    values: Floats, samples: PlacementSamples, rule: Any, seed: int, given: Floats | None = None
) -> dict[str, Any]:
    """Return rho of values with AP, its BCa interval, and its p; nothing is rounded.

    With a third variable, `given` (P,), they are those of the partial rho.
    """
    if given is None:
        p = permutation_p(values, samples, rule, seed)
    else:
        p = permutation_p_beyond(values, given, samples, rule, seed=seed)
    limits, _ = bca_interval(values, samples, rule, seed, given=given)
    rho = float(rho_statistic(values, samples, given)(samples.whole))
    return {"rho": rho, "interval": list(limits), "p": p}


def _without(values: Floats, samples: PlacementSamples, index: Ints, given: Floats | None) -> float:
    """Return the statistic of some of the placements alone."""
    part = samples.subset(index)
    more = None if given is None else given[index]
    return float(rho_statistic(values[index], part, more)(part.whole))


def power(rho: float, samples: PlacementSamples, rule: Any, seed: int, studies: int) -> float:
    """Return in which share of studies the percentile interval of rho would be above 0.

    The studies have the vehicles and placements of `samples`, and normal pairs whose Spearman's rho
    is `rho`; the seeds of a placement differ as much as here, beside what placements differ by.
    """
    rng = np.random.default_rng([seed, 4])
    r = 2.0 * math.sin(math.pi * rho / 6.0)
    spread = float(np.mean([samples.ap[index].std(ddof=1) for index in samples.members]))
    noise = samples.noise / spread

    def is_above() -> bool:
        score, other = rng.normal(size=(2, len(samples.ap)))
        seeds = noise * rng.normal(size=samples.aps.shape)
        ap = r * score + math.sqrt(1.0 - r * r) * other
        study = replace(samples, aps=ap[:, None] + seeds - seeds.mean(axis=1, keepdims=True))
        return interval(study, rule, seed, rho_statistic(score, study))[0] > 0.0

    return sum(is_above() for _ in range(studies)) / studies


def student_interval(values: Sequence[float]) -> Interval:
    """Return Student's interval (95 %) of the mean of three, four or six values."""
    half = STUDENT[len(values) - 1] * float(np.std(values, ddof=1)) / math.sqrt(len(values))
    middle = float(np.mean(values))
    return middle - half, middle + half


def better_ones(ap: Floats, hardware: NDArray, groups: NDArray, tie: float) -> Flags:
    """Return the pairs of a group with different hardware, (P, P), each once: row finds more."""
    counted = (groups[:, None] == groups) & (hardware[:, None] != hardware)
    return np.asarray(counted & (ap[:, None] - ap >= tie))


def ordered_share(
    score: Floats, ap: Floats, hardware: NDArray, groups: NDArray, tie: float
) -> float:
    """Return the share of pairs with different hardware that a score orders as AP does.

    Arrays are (P,). Pairs that differ in AP by less than `tie` are not counted; a tie of the score
    counts half. NaN without any pair.
    """
    counted = better_ones(ap, hardware, groups, tie)
    if not counted.any():
        return float("nan")
    of_score = (score[:, None] - score)[counted]
    return float(((of_score > 0.0) + 0.5 * (of_score == 0.0)).mean())

"""Rank correlation within vehicles: rho, permutation tests, bootstrap intervals, ordered pairs.

A placement is a sample. Placements of one vehicle are a group; a statistic is the mean over the
groups, so that a difference between vehicles is no correlation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from pe_core.geometry.bins import blocks

from ..ranks import SAME, standard_ranks
from .plan import StatisticsRule

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Interval = tuple[float, float]

MIN_GROUP = 3
"""A group of fewer placements has no rank correlation worth the name."""
STUDENT = {2: 4.302653, 3: 3.182446, 5: 2.570582}
"""Student's quantile at 0.975 by degrees of freedom."""
PERMUTED_AT_ONCE = 500
AT_ONCE = 2_000_000
"""Comparisons that are done at once, to limit memory."""


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
        xy, xz, yz = (x * y).sum(axis=-1), (x * z).sum(axis=-1), (y * z).sum(axis=-1)
        free = np.sqrt(np.maximum((1.0 - xz**2) * (1.0 - yz**2), 0.0))
        parts.append(np.where(free > SAME, (xy - xz * yz) / np.maximum(free, SAME), 0.0))
    return np.mean(parts, axis=0)


def permutation_p_beyond(
    score: Floats, given: Floats, samples: PlacementSamples, rule: StatisticsRule, seed: int
) -> float:
    """Return the two-sided p of the partial rho, given a third, as `permutation_p`."""
    observed = abs(float(partial_rho(score, samples.ap, given, samples.members)))
    rng, extreme = np.random.default_rng([seed, 2]), 0
    for block in blocks(rule.permutations, PERMUTED_AT_ONCE):
        count = block.stop - block.start
        ap = np.tile(samples.ap, (count, 1))
        for index in samples.members:
            ap[:, index] = rng.permuted(ap[:, index], axis=1)
        x, z = (np.broadcast_to(w, ap.shape) for w in (score, given))
        found = partial_rho(x, ap, z, samples.members)
        extreme += int((np.abs(found) >= observed - SAME).sum())
    return (1 + extreme) / (1 + rule.permutations)


def permutation_p(
    score: Floats, samples: PlacementSamples, rule: StatisticsRule, seed: int
) -> float:
    """Return the two-sided p of rho: placements are permuted within their groups at random.

    The observed order counts as one of the permutations, so p is never 0.
    """
    observed = float(rho_within(score, samples.ap, samples.members))
    rng = np.random.default_rng([seed, 2])
    total = np.zeros(rule.permutations)
    for index in samples.members:
        fixed, moved = standard_ranks(score[index]), standard_ranks(samples.ap[index])
        tiled = np.broadcast_to(moved, (rule.permutations, len(index)))
        total += (rng.permuted(tiled, axis=1) * fixed).sum(axis=1)
    extreme = np.abs(total / len(samples.members)) >= abs(observed) - SAME
    return float((1 + extreme.sum()) / (1 + rule.permutations))


@dataclass(frozen=True, eq=False)
class Resample:
    """Bootstrap samples: indices of placements (R, P), in their groups, and mean AP (R, P)."""

    index: Ints
    ap: Floats


Statistic = Callable[[Resample], Floats]
"""Maps bootstrap samples to (R,) numbers."""


def resamples(samples: PlacementSamples, rule: StatisticsRule, seed: int) -> Iterator[Resample]:
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


def interval(
    samples: PlacementSamples, rule: StatisticsRule, seed: int, statistic: Statistic
) -> Interval:
    """Return the percentile interval of a statistic."""
    values = np.concatenate([statistic(portion) for portion in resamples(samples, rule, seed)])
    low, high = np.nanpercentile(values, [2.5, 97.5])
    return float(low), float(high)


def bca_interval(
    values: Floats,
    samples: PlacementSamples,
    rule: StatisticsRule,
    seed: int,
    given: Floats | None = None,
) -> tuple[Interval, float]:
    """Return the interval of rho, corrected for bias and skewness, and the mean of the bootstraps.

    With a third variable, `given` (P,), it is that of the partial rho.

    BCa: Efron, Better bootstrap confidence intervals, JASA 82 (1987). The bootstraps are those of
    `interval`; the acceleration is the jackknife's, a placement left out at a time.
    """
    every = np.arange(len(values))

    def rho_of(index: Ints, ap: Floats, members: Sequence[Ints]) -> Floats:
        if given is None:
            return rho_within(values[index], ap, members)
        return partial_rho(values[index], ap, given[index], members)

    rhos = np.concatenate(
        [
            rho_of(portion.index, portion.ap, samples.members)
            for portion in resamples(samples, rule, seed)
        ]
    )
    rho = float(rho_of(every, samples.ap, samples.members))
    normal = NormalDist()
    below = float((rhos < rho - SAME).mean() + 0.5 * (np.abs(rhos - rho) <= SAME).mean())
    bias = normal.inv_cdf(min(max(below, 1.0 / len(rhos)), 1.0 - 1.0 / len(rhos)))
    parts = [(index, samples.subset(index)) for k in every for index in [np.delete(every, k)]]
    left_out = np.array([float(rho_of(index, part.ap, part.members)) for index, part in parts])
    off = left_out.mean() - left_out
    acceleration = float((off**3).sum() / (6.0 * max((off**2).sum(), SAME) ** 1.5))
    levels = []
    for p in (0.025, 0.975):
        shifted = bias + normal.inv_cdf(p)
        levels.append(100.0 * normal.cdf(bias + shifted / (1.0 - acceleration * shifted)))
    low, high = np.percentile(rhos, levels)
    return (float(low), float(high)), float(rhos.mean())


def power(
    rho: float, samples: PlacementSamples, rule: StatisticsRule, seed: int, studies: int
) -> float:
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

        def of(resample: Resample) -> Floats:
            return rho_within(score[resample.index], resample.ap, study.members)

        return interval(study, rule, seed, of)[0] > 0.0

    return sum(is_above() for _ in range(studies)) / studies


def student_interval(values: Sequence[float]) -> Interval:
    """Return Student's interval (95 %) of the mean of three, four or six values."""
    half = STUDENT[len(values) - 1] * float(np.std(values, ddof=1)) / math.sqrt(len(values))
    middle = float(np.mean(values))
    return middle - half, middle + half


def better_ones(ap: Floats, hardware: NDArray, groups: NDArray, tie: float) -> NDArray[np.bool_]:
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

"""Rank correlation within vehicles: rho, permutation tests, bootstrap intervals, ordered pairs.

A placement is a sample. Placements of one vehicle are a group; a statistic is the mean over the
groups, so that a difference between vehicles is no correlation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .plan import StatisticsRule

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Interval = tuple[float, float]

SAME = 1e-9
"""Correlations that differ by less than this are equal."""
MIN_GROUP = 3
"""A group of fewer placements has no rank correlation worth the name."""
AT_ONCE = 2_000_000
"""Comparisons that are done at once, to limit memory."""


@dataclass(frozen=True, eq=False)
class PlacementSamples:
    """Placements with AP of each seed.

    Attributes
    ----------
    aps : (P, S) float
        AP by placement and seed.
    groups : (P,) str or int
        Vehicle of each placement.
    hardware : (P,) str or int
        Hardware of each placement.
    """

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


def ranks_of(values: Floats) -> Floats:
    """Return midranks along the last axis, from 1 up; equal values have the mean of their ranks."""
    lower = (values[..., None, :] < values[..., :, None]).sum(axis=-1)
    equal = (values[..., None, :] == values[..., :, None]).sum(axis=-1)
    return lower + (equal + 1) / 2.0


def standardized(values: Floats) -> Floats:
    """Return midranks minus their mean, scaled to length 1; zeros where all values are equal."""
    ranks = ranks_of(values)
    centred = ranks - ranks.mean(axis=-1, keepdims=True)
    length = np.sqrt((centred**2).sum(axis=-1, keepdims=True))
    return centred / np.where(length > 0.0, length, 1.0)


def rho_within(score: Floats, ap: Floats, members: Sequence[Ints]) -> Floats:
    """Return the mean over groups of Spearman's rho, (...); arrays are (..., P)."""
    rhos = [
        (standardized(score[..., index]) * standardized(ap[..., index])).sum(axis=-1)
        for index in members
    ]
    return np.mean(rhos, axis=0)


def partial_rho(score: Floats, ap: Floats, given: Floats, members: Sequence[Ints]) -> Floats:
    """Return the mean over groups of the partial rank correlation of score and AP, given a third.

    The partial correlation of ranks: (r_xy - r_xz r_yz) / sqrt((1 - r_xz^2) (1 - r_yz^2)).
    """
    parts = []
    for index in members:
        x, y, z = (standardized(w[..., index]) for w in (score, ap, given))
        xy, xz, yz = (x * y).sum(axis=-1), (x * z).sum(axis=-1), (y * z).sum(axis=-1)
        free = np.sqrt(np.maximum((1.0 - xz**2) * (1.0 - yz**2), 0.0))
        parts.append(np.where(free > SAME, (xy - xz * yz) / np.maximum(free, SAME), 0.0))
    return np.mean(parts, axis=0)


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
        fixed, moved = standardized(score[index]), standardized(samples.ap[index])
        tiled = np.broadcast_to(moved, (rule.permutations, len(index)))
        total += (rng.permuted(tiled, axis=1) * fixed).sum(axis=1)
    extreme = np.abs(total / len(samples.members)) >= abs(observed) - SAME
    return float((1 + extreme.sum()) / (1 + rule.permutations))


@dataclass(frozen=True, eq=False)
class Resample:
    """Bootstrap samples: indices of placements (R, P), in their groups, and mean AP (R, P)."""

    index: Ints
    ap: Floats


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
    samples: PlacementSamples,
    rule: StatisticsRule,
    seed: int,
    statistic: Callable[[Resample], Floats],
) -> Interval:
    """Return the percentile interval of a statistic, which maps a portion to (R,) numbers."""
    values = np.concatenate([statistic(portion) for portion in resamples(samples, rule, seed)])
    low, high = np.nanpercentile(values, [2.5, 97.5])
    return float(low), float(high)


def ordered_share(
    score: Floats, ap: Floats, hardware: NDArray, groups: NDArray, tie: float
) -> float:
    """Return the share of pairs with different hardware that a score orders as AP does.

    Pairs that differ in AP by less than `tie` are not counted; a tie of the score counts half.
    NaN without any pair.

    Parameters
    ----------
    score, ap : (P,) float
    hardware, groups : (P,)
    tie : float
    """
    counted = (groups[:, None] == groups) & (hardware[:, None] != hardware)
    difference = ap[:, None] - ap
    counted &= difference >= tie  # each pair once, the better one first
    if not counted.any():
        return float("nan")
    of_score = (score[:, None] - score)[counted]
    return float(((of_score > 0.0) + 0.5 * (of_score == 0.0)).mean())


def pooled_noise(samples: PlacementSamples) -> float:
    """Return the standard deviation over seeds, pooled over the placements; NaN for one seed."""
    if samples.aps.shape[1] < 2:
        return float("nan")
    return float(np.sqrt(samples.aps.var(axis=1, ddof=1).mean()))


def better_half(samples: PlacementSamples) -> tuple[Ints, PlacementSamples]:
    """Return the half of each group with the higher AP at the first seed, with the other seeds.

    Selection and result do not share their noise.

    Returns
    -------
    tuple of (Q,) int and PlacementSamples
        Indices of the placements, and those placements.
    """
    chosen = [
        index[np.argsort(-samples.aps[index, 0], kind="stable")[: (len(index) + 1) // 2]]
        for index in samples.members
    ]
    index = np.sort(np.concatenate(chosen))
    part = samples.subset(index)
    return index, PlacementSamples(part.aps[:, 1:], part.groups, part.hardware)

"""Rank correlation: Spearman's rho, what chance gives, and corrections for several tests."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

MAX_PLACEMENTS = 9
"""9! permutations are 360 thousand; one more placement would make 3.6 million."""
SAME = 1e-9
"""Correlations that differ by less than this are equal."""


def midranks(values: ArrayLike) -> Floats:
    """Return ranks along the last axis, from 1 up; equal values have the mean of their ranks."""
    array = np.asarray(values, dtype=float)
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


def spearman(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Return Spearman's rho; None where all values of one of the two are equal."""
    a, b = standard_ranks(first), standard_ranks(second)
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
def permutations(count: int) -> NDArray[np.int64]:
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
    adjusted, highest = [0.0] * count, 0.0
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

"""Rank correlation of so few placements that all their permutations can be evaluated."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MAX_PLACEMENTS = 9
"""9! permutations are 360 thousand; one more placement would make 3.6 million."""
SAME = 1e-9
"""Correlations that differ by less than this are equal."""


def midranks(values: Sequence[float]) -> Floats:
    """Return ranks from 1 up, (n,); equal values have the mean of their ranks."""
    array = np.asarray(values, dtype=float)
    less = (array[None, :] < array[:, None]).sum(axis=1)
    equal = (array[None, :] == array[:, None]).sum(axis=1)
    return less + (equal + 1) / 2.0


def standard_ranks(values: Sequence[float]) -> Floats | None:
    """Return midranks minus their mean, scaled to length 1; None where all values are equal.

    Spearman's rho is the scalar product of two of these.
    """
    centred = midranks(values) - (len(values) + 1) / 2.0
    length = float(np.sqrt((centred**2).sum()))
    return centred / length if length > 0.0 else None


def spearman(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Return Spearman's rho; None where all values of one of the two are equal."""
    a, b = standard_ranks(first), standard_ranks(second)
    return None if a is None or b is None else float((a * b).sum())


def mean_ranks(aps: Sequence[Sequence[float]]) -> Floats:
    """Return the mean of several detectors' standard ranks, (n,).

    The scalar product of a score's standard ranks with it is the score's mean rho.
    """
    ranks = [standard_ranks(values) for values in aps]
    return np.mean([r for r in ranks if r is not None], axis=0)


def under_chance(score: Sequence[float], aps: Sequence[Sequence[float]]) -> Floats | None:
    """Return the distribution of the mean rho under chance, (n!,), sorted; None as in `spearman`.

    It has the mean rho over the detectors for every permutation of the placements. A permutation
    is the same for all detectors: detectors that were trained on the same placements are no
    further samples.

    Parameters
    ----------
    score : sequence of float
        The score of each placement.
    aps : sequence of sequence of float
        AP of each placement, by detector.
    """
    ranks = standard_ranks(score)
    if ranks is None:
        return None
    ap_ranks = mean_ranks(aps)
    return np.sort((ranks[permutations(len(ranks))] * ap_ranks).sum(axis=1))


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

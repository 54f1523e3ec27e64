"""Rank correlation where there are so few placements that every order of them can be looked at."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MOST_PLACEMENTS = 9
"""9! orders are 360 thousand; one more would be 3.6 million."""
SAME = 1e-9
"""Correlations nearer than this are one value."""


def midranks(values: Sequence[float]) -> Floats:
    """Ranks from 1 up, (n,); equal values share the mean of theirs."""
    given = np.asarray(values, dtype=float)
    less = (given[None, :] < given[:, None]).sum(axis=1)
    equal = (given[None, :] == given[:, None]).sum(axis=1)
    return less + (equal + 1) / 2.0


def standard_ranks(values: Sequence[float]) -> Floats | None:
    """Midranks less their mean, of length 1: Spearman's rho is a product of two of these.

    None where all values are one: nothing is ranked.
    """
    centred = midranks(values) - (len(values) + 1) / 2.0
    length = float(np.sqrt((centred**2).sum()))
    return centred / length if length > 0.0 else None


def spearman(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Spearman's rho; None where one of the two ranks nothing."""
    a, b = standard_ranks(first), standard_ranks(second)
    return None if a is None or b is None else float((a * b).sum())


def mean_ranks(aims: Sequence[Sequence[float]]) -> Floats:
    """Mean of several detectors' standard ranks: a score's product with it is its mean rho."""
    ranked = [standard_ranks(values) for values in aims]
    return np.mean([r for r in ranked if r is not None], axis=0)


def under_chance(score: Sequence[float], aims: Sequence[Sequence[float]]) -> Floats | None:
    """Mean rho over detectors for every order of the placements, sorted; None as in `spearman`.

    The placements are what is shuffled, for all detectors together: detectors trained on the same
    placements are no placements more.
    """
    ranked = standard_ranks(score)
    if ranked is None:
        return None
    aim = mean_ranks(aims)
    return np.sort((ranked[orders(len(ranked))] * aim).sum(axis=1))


@cache
def orders(count: int) -> NDArray[np.int64]:
    """All orders of so many placements: (count!, count)."""
    if count > MOST_PLACEMENTS:
        raise ValueError(f"{count} placements have too many orders")
    return np.array(list(itertools.permutations(range(count))))


def exact_p(observed: float, chance: Floats) -> float:
    """Share of all orders whose mean rho is as far from zero, either way: two-sided."""
    return float((np.abs(chance) >= abs(observed) - SAME).mean())


def exact_p_of_mean(observed: float, first: Floats, second: Floats) -> float:
    """As `exact_p` for the mean of two papers' rho, of all pairs of orders: two-sided.

    `first` and `second` are sorted, as `under_chance` has them.
    """
    edge = 2.0 * abs(observed) - SAME
    at_least = len(second) - np.searchsorted(second, edge - first, side="left")
    at_most = np.searchsorted(second, -edge - first, side="right")
    return float(min(1.0, (at_least.sum() + at_most.sum()) / (len(first) * len(second))))


def holm(p_values: Sequence[float]) -> list[float]:
    """Holm's adjusted p values, in the order given."""
    count = len(p_values)
    adjusted, highest = [0.0] * count, 0.0
    for rank, place in enumerate(sorted(range(count), key=lambda i: p_values[i])):
        highest = max(highest, min(1.0, (count - rank) * p_values[place]))
        adjusted[place] = highest
    return adjusted


def agreement(aims: Sequence[Sequence[float]]) -> float | None:
    """How well detectors agree: the mean of each one's rho with the mean ranks of the others.

    No score can be expected to rank like detectors that do not rank like each other.
    """
    found = [
        spearman(aims[i], mean_ranks([*aims[:i], *aims[i + 1 :]]).tolist())
        for i in range(len(aims))
    ]
    known = [rho for rho in found if rho is not None]
    return float(np.mean(known)) if known else None

"""Pairs of rigs: by how much their scores differ, and whether the better one has the higher AP."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pe_core.base import Flags, Floats, Ints

from ..ranks import SAME

STEPS = 200
"""Steps of the search for k; it halves its bracket where a step of Newton's leaves it."""
SMALLEST = 1e-12
"""A change of k, relative to k, that ends the search."""
CLIP = 0.001
"""P is kept this far from 0 and 1 in a log loss."""


@dataclass(frozen=True, eq=False)
class Group:
    """Rigs that are compared with each other alone.

    `scores` has values (P,) by score, higher for better; `aps` (D, P) has the AP by detector.
    """

    name: str
    scores: Mapping[str, Floats]
    aps: Floats

    @property
    def size(self) -> int:
        """Number of rigs."""
        return int(self.aps.shape[1])


@dataclass(frozen=True, eq=False)
class Pairs:
    """The pairs of a kind whose scores differ, in order of that difference.

    Attributes
    ----------
    first, second : (N,) int
        The rigs of each pair, numbered over all groups.
    d : (N,) float
        By how much the better score is better, in its unit.
    right : (N,) float
        1 where the rig with the better score has the higher AP, 0.5 for equal AP, else 0.
    group : (R,) int
        The group of each rig.
    ties : int
        Pairs with equal scores, which are left out.
    """

    first: Ints
    second: Ints
    d: Floats
    right: Floats
    group: Ints
    ties: int

    @property
    def rigs(self) -> int:
        """Number of rigs of all groups."""
        return len(self.group)

    def share(self, weights: Floats | None = None) -> float:
        """Return the share of right pairs; NaN without a pair."""
        shares = np.ones(len(self.d)) if weights is None else weights
        total = float(shares.sum())
        return float((shares * self.right).sum()) / total if total > 0.0 else math.nan

    def has(self, rig: int) -> Flags:
        """Return whether each pair has a rig, (N,)."""
        return np.asarray((self.first == rig) | (self.second == rig))

    def slope(self, weights: Floats | None = None) -> float:
        """Return k of P = 1 / (1 + exp(-k d)) by maximum likelihood.

        Infinite where all pairs are right, minus infinite where all are wrong, NaN without a pair.
        `weights` (N,) count pairs several times, or not at all.
        """
        shares = np.ones(len(self.d)) if weights is None else weights
        share = self.share(shares)
        if math.isnan(share) or share in (0.0, 1.0):
            return {0.0: -math.inf, 1.0: math.inf}.get(share, math.nan)
        kept = shares > 0.0
        unit = float(np.average(self.d[kept], weights=shares[kept]))
        return _root(self.d[kept] / unit, self.right[kept], shares[kept]) / unit


def _root(d: Floats, right: Floats, weights: Floats) -> float:
    """Return where the likelihood's slope, which falls with k, is 0."""
    low = -math.inf
    high = math.inf
    k = 0.0
    for _ in range(STEPS):
        p = probability(k, d)
        slope = float((weights * d * (right - p)).sum())
        curvature = float((weights * d * d * p * (1.0 - p)).sum())
        if slope > 0.0:
            low = k
        else:
            high = k
        new = k + slope / curvature if curvature > 0.0 else math.nan
        if not low <= new <= high:
            outward = 2.0 * k + math.copysign(1.0, slope)
            new = (low + high) / 2.0 if math.isfinite(low + high) else outward
        if abs(new - k) <= SMALLEST * max(abs(k), 1.0):
            break
        k = new
    return k


def probability(k: float, d: Floats) -> Floats:
    """Return P(higher AP | d) = 1 / (1 + exp(-k d)); 1 or 0 for an infinite k."""
    if math.isinf(k):
        return np.full(len(d), 1.0 if k > 0.0 else 0.0)
    exponent = np.clip(-k * np.asarray(d), -700.0, 700.0)
    return np.asarray(1.0 / (1.0 + np.exp(exponent)))


def log_loss(p: Floats, right: Floats) -> Floats:
    """Return the log loss of each pair, (N,); P is kept within `CLIP` and 1 - `CLIP`."""
    kept = np.clip(p, CLIP, 1.0 - CLIP)
    return np.asarray(-(right * np.log(kept) + (1.0 - right) * np.log(1.0 - kept)))


def pairs_of(groups: Sequence[Group], score: str) -> Pairs:
    """Return the pairs of a kind by one of its scores: two rigs of one group, by each detector."""
    first: list[int] = []
    second: list[int] = []
    d: list[float] = []
    right: list[float] = []
    ties = 0
    start = 0
    for group in groups:
        values = group.scores[score]
        for ap in group.aps:
            for i in range(group.size):
                for j in range(i):
                    by = float(values[i] - values[j])
                    more = float(ap[i] - ap[j])
                    if abs(by) < SAME:
                        ties += 1
                        continue
                    first.append(start + i)
                    second.append(start + j)
                    d.append(abs(by))
                    right.append(0.5 if abs(more) < SAME else float((by > 0.0) == (more > 0.0)))
        start += group.size
    order = np.argsort(d, kind="stable")
    return Pairs(
        first=np.array(first, dtype=np.int64)[order],
        second=np.array(second, dtype=np.int64)[order],
        d=np.array(d)[order],
        right=np.array(right)[order],
        group=np.repeat(np.arange(len(groups)), [group.size for group in groups]),
        ties=ties,
    )

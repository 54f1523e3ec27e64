"""A body's rank: what a detector's frames of one body have in common (docs/time.md).

A body has a hidden rank u between 0 and 1, how hard it is to find, and a frame finds it when u is
below the frame's chance p. So each frame finds it with exactly p, whatever the others did, and a
frame in which nothing sees it, p = 0, says nothing of the rank.

The rank drifts: z, the quantile of u, is a stationary Gaussian process with correlation ``exp(-t /
T)``, T the correlation time (Ornstein-Uhlenbeck). It is computed as a chain of `BINS` states, which
are bins of z. In a bin u is anywhere between the bin's edges, anew in each frame. Rates between
neighbours are ``pdf(edge) / (difference of the bins' means)``, for one T: then the bins keep their
shares, and the correlation of the bins' means is ``exp(-t / T)`` exactly, for any edges.
"""

from dataclasses import dataclass
from functools import cache
from statistics import NormalDist

import numpy as np

from ..base.arrays import Floats

BINS = 64
FARTHEST_Z = 3.2
"""The first and the last bin begin here; shares and moments differ by less than 0.001 from those
of many more bins (tests/engine/test_time.py)."""


@dataclass(frozen=True, slots=True, eq=False)
class RankChain:
    """The chain of ranks.

    `edges` (R + 1,): Ranks between the bins, 0 and 1 included.
    `shares` (R,): How likely each bin is.
    `decays` (R,): Eigenvalues of the chain's rates, times T; the first is 0.
    `modes` (R, R): The eigenvectors, orthonormal, of the rates between the roots of the shares.
    """

    edges: Floats
    shares: Floats
    decays: Floats
    modes: Floats

    def step(self, lag: float) -> Floats:
        """Return how likely each bin (R, R) follows each after a time, in correlation times.

        inf: the bins' shares, independent of the bin before.
        """
        kept = np.ones(len(self.decays))
        kept[1:] = np.exp(self.decays[1:] * lag)
        roots = np.sqrt(self.shares)
        between = (self.modes * kept) @ self.modes.T
        return np.maximum(between * roots / roots[:, None], 0.0)

    def found(self, chance: Floats) -> Floats:
        """Return the probability (..., R) in each bin that a frame of a chance (...) finds it."""
        below = (np.asarray(chance)[..., None] - self.edges[:-1]) / self.shares
        return np.clip(below, 0.0, 1.0)


@cache
def rank_chain() -> RankChain:
    """Return the chain."""
    normal = NormalDist()
    inner = np.linspace(-FARTHEST_Z, FARTHEST_Z, BINS - 1).tolist()
    edges = np.array([0.0, *map(normal.cdf, inner), 1.0])
    density = np.array([0.0, *map(normal.pdf, inner), 0.0])
    shares = np.diff(edges)
    means = -np.diff(density) / shares
    roots = np.sqrt(shares)
    flow = density[1:-1] / np.diff(means)
    rates = np.diag(flow / (roots[:-1] * roots[1:]), 1)
    rates = rates + rates.T
    leaving = np.concatenate([flow, [0.0]]) + np.concatenate([[0.0], flow])
    decays, modes = np.linalg.eigh(rates - np.diag(leaving / shares))
    return RankChain(edges, shares, decays[::-1], modes[:, ::-1])

"""Whether figures of several scores differ, or only seem to.

A difference is *clear* when it is larger than the last digit that is shown and, on samples, than
its standard error times a factor: with 95 % certainty for all pairs of a row together (Bonferroni),
by Student's t as the error itself is estimated from few batches.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import NormalDist

from ..scoring.sampling import BLOCKS
from ..scoring.scatter import FigureKey, paired_error
from ..scoring.score import PartScore, Score

CERTAINTY = 0.95
LEAST = {"entropy": 0.005, "coverage": 0.0005, "ap": 0.0005, "reach": 0.05, "blind": 0.05}
"""Half of the last digit that is shown, by measure: smaller differences are not told."""


def sure_factor(studies: int, degrees: int = BLOCKS - 1) -> float:
    """Return how many standard errors a difference has to exceed to be clear.

    Parameters
    ----------
    studies : int
        All their pairs are compared: by Bonferroni each has its share of the 5 % for an error.
    degrees : int
        Degrees of freedom of the standard errors: the batches they are estimated from, less one.
    """
    pairs = max(studies * (studies - 1) // 2, 1)
    z = NormalDist().inv_cdf(1.0 - (1.0 - CERTAINTY) / (2.0 * pairs))
    # Abramowitz & Stegun 26.7.5, quantile of Student's t from that of the normal distribution.
    terms = (
        z,
        (z**3 + z) / 4.0,
        (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / 96.0,
        (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / 384.0,
        (79.0 * z**9 + 776.0 * z**7 + 1482.0 * z**5 - 1920.0 * z**3 - 945.0 * z) / 92160.0,
    )
    return math.fsum(term / degrees**k for k, term in enumerate(terms))


def degrees_of(scores: Iterable[Score]) -> int:
    """Return the degrees of freedom of the errors of several scores: the fewest of any."""
    batches = [score.scatter.batches for score in scores if score.scatter is not None]
    return max(min(batches, default=BLOCKS) - 1, 1)


def difference_errors(scores: Sequence[Score], figure: FigureKey) -> tuple[tuple[float, ...], ...]:
    """Return the standard errors of the differences of a figure between all pairs of scores.

    Scores on the same sample are paired (`scoring.scatter`); the errors of others are independent
    and add up in square. 0 for scores of the whole grid, and for reach, which is not sampled.
    """
    own = [_error(score, figure) for score in scores]
    rows = []
    for i, one in enumerate(scores):
        row = []
        for j, other in enumerate(scores):
            paired = paired_error(one.scatter, other.scatter, figure)
            row.append(0.0 if i == j else math.hypot(own[i], own[j]) if paired is None else paired)
        rows.append(tuple(row))
    return tuple(rows)


def _error(score: Score, figure: FigureKey) -> float:
    """Return the standard error of a figure of one score."""
    if not score.stderr or figure[2] == "reach":
        return 0.0
    if figure == ("rig", "", "entropy"):
        return score.stderr
    known = None if score.scatter is None else score.scatter.error(figure)
    return _bound(score, figure) if known is None else known


def _bound(score: Score, figure: FigureKey) -> float:
    """Return an error that was not kept as told of objects, else on the safe side."""
    group, name, measure = figure
    found = score.objects
    own = None if found is None or group != "class" else found.per_class.get(name)
    if found is not None and measure == "ap":
        return found.ap_stderr if own is None else own.ap_stderr
    if own is not None and measure == "entropy":
        return own.stderr
    parts: Mapping[str, PartScore] = score.per_zone if group == "zone" else score.per_class
    share = parts[name].share if name in parts else 1.0
    if measure == "entropy":
        return score.stderr / math.sqrt(share)  # as if its part of the sample were drawn by lot
    looked_at = score.voxels if found is None else found.objects
    return 0.5 / math.sqrt(max(share * looked_at, 1.0))  # the most that a share can scatter

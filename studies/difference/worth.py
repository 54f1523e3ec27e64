"""By kind and score: the curve of P by d, its interval, what it foretells, and the verdicts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pe_core.base import Floats

from ..ranks import SAME
from ..results_file import Json
from .pairs import Group, Pairs, log_loss, pairs_of, probability

HOLDS = "holds"
REFUTED = "refuted"
UNDECIDED = "not decided"
NEAR = 0.10
FAR = 0.20
"""A third is calibrated within `NEAR` of its share, and refutes that if off by more than `FAR`."""
THIRDS = 3
MIN_RIGS = 12
"""A kind with fewer rigs in its smallest group has no row in the table."""
LARGEST = 0.95
"""Quantile of d beyond which d counts as it."""
DIGITS = 4


@dataclass(frozen=True)
class DifferenceEffort:
    """How intervals are computed."""

    seed: int = 20261130
    resamples: int = 2000


@dataclass(frozen=True, eq=False)
class Kind:
    """Rigs of one kind: its name, what it is called, its source, and its groups.

    `of_class` and `within` [m] narrow what its scores are of: objects of a class in traffic, x and
    y within a distance. Else they are of all classes, voxels, in the default space. `sensors` has
    the fewest and the most sensors of a rig, where they differ.
    """

    name: str
    label: str
    source: str
    groups: Sequence[Group]
    of_class: str = ""
    within: float = 0.0
    sensors: tuple[int, ...] = ()

    @property
    def smallest(self) -> int:
        """Number of rigs in the smallest group."""
        return min(group.size for group in self.groups)


def worth_of(kind: Kind, score: str, effort: DifferenceEffort) -> Json:
    """Return all figures of a kind and a score, the verdicts, and whether it has a table row."""
    pairs = pairs_of(kind.groups, score)
    k = pairs.slope()
    low, high = slope_interval(pairs, effort)
    judged = left_out(pairs)
    thirds = calibration(pairs, judged.p)
    found: Json = {
        "rigs": pairs.rigs,
        "pairs": len(pairs.d),
        "ties": pairs.ties,
        "share": _rounded(pairs.share()),
        "k": _rounded(k),
        "interval": [_rounded(low), _rounded(high)],
        "largest": _rounded(float(np.quantile(pairs.d, LARGEST))),
        "log_loss": {
            "curve": _rounded(judged.curve),
            "coin": _rounded(math.log(2.0)),
            "constant": _rounded(judged.constant),
        },
        "thirds": thirds,
    }
    found["verdicts"] = {
        "1": HOLDS if low > 0.0 else REFUTED if high < 0.0 else UNDECIDED,
        "2": foretells(judged.curve, judged.constant),
        "3": calibrated(thirds),
    }
    found["in_table"] = enters(found["verdicts"], kind.smallest) and math.isfinite(k)
    return found


def slope_interval(pairs: Pairs, effort: DifferenceEffort) -> tuple[float, float]:
    """Return the percentile interval (95 %) of k: rigs are drawn again within their groups.

    A pair counts as often as both of its rigs are drawn together; two draws of one rig are none.
    """
    rng = np.random.default_rng([effort.seed, 1])
    members = [np.flatnonzero(pairs.group == g) for g in np.unique(pairs.group)]
    slopes = []
    for _ in range(effort.resamples):
        drawn = [index[rng.integers(0, len(index), len(index))] for index in members]
        counts = np.bincount(np.concatenate(drawn), minlength=pairs.rigs).astype(float)
        slopes.append(pairs.slope(counts[pairs.first] * counts[pairs.second]))
    known = [slope for slope in slopes if not math.isnan(slope)]
    low, high = np.quantile(known, [0.025, 0.975], method="inverted_cdf")
    return float(low), float(high)


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Pairs judged by what was fitted without one of their rigs: P (N,), mean of both folds.

    `curve` and `constant` are the mean log loss of the curve and of the others' share.
    """

    p: Floats
    curve: float
    constant: float


def left_out(pairs: Pairs) -> LeftOut:
    """Return the pairs judged without each of their rigs in turn."""
    total = np.zeros(len(pairs.d))
    of_curve = list[Floats]()
    of_share = list[Floats]()
    for rig in range(pairs.rigs):
        own = pairs.has(rig)
        others = (~own).astype(float)
        k = pairs.slope(others)
        if not own.any() or math.isnan(k):
            raise ValueError(f"rig {rig} leaves no pair to judge, or none to fit")
        p = probability(k, pairs.d[own])
        total[own] += p
        of_curve.append(log_loss(p, pairs.right[own]))
        of_share.append(log_loss(np.full(len(p), pairs.share(others)), pairs.right[own]))
    curve, constant = (float(np.concatenate(rows).mean()) for rows in (of_curve, of_share))
    return LeftOut(total / 2.0, curve, constant)


def calibration(pairs: Pairs, p: Floats) -> list[Json]:
    """Return by third of d: its range, the share of right pairs, and the mean P."""
    return [
        {
            "d": [_rounded(float(pairs.d[rows[0]])), _rounded(float(pairs.d[rows[-1]]))],
            "share": _rounded(float(pairs.right[rows].mean())),
            "p": _rounded(float(p[rows].mean())),
        }
        for rows in np.array_split(np.arange(len(pairs.d)), THIRDS)
    ]


def foretells(curve: float, constant: float) -> str:
    """Return the verdict of statement 2 from two log losses; a coin's is ln 2."""
    coin = math.log(2.0)
    return HOLDS if curve < min(coin, constant) else REFUTED if curve > coin else UNDECIDED


def calibrated(thirds: Sequence[Mapping[str, float]]) -> str:
    """Return the verdict of statement 3."""
    off = max(abs(third["share"] - third["p"]) for third in thirds)
    return HOLDS if off <= NEAR + SAME else REFUTED if off > FAR + SAME else UNDECIDED


def enters(verdicts: Mapping[str, str], smallest: int) -> bool:
    """Whether a row enters the table: 1 and 2 hold, 3 is not refuted, and rigs are enough."""
    both = verdicts["1"] == verdicts["2"] == HOLDS
    return both and verdicts["3"] != REFUTED and smallest >= MIN_RIGS


def _rounded(value: float) -> float | None:
    """Return a figure with `DIGITS` digits; None for one that is not finite."""
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None

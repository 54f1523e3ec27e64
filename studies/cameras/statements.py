"""What the plan asks of the scores: correlations, their intervals and p, and its verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pe_core.base import Floats

from ..ranks import SAME, PlacementSamples, exact_p, holm, rank_figures, spearman, under_chance
from ..results_file import Json
from .published_rigs import APART, FAMILY, OUTCOMES, PublishedRigs, positions_of
from .scores import CARS_OUTCOME, SCORES, SEEN, CameraEffort, values_of_score

HOLDS = "holds"
REFUTED = "refuted"
UNDECIDED = "not decided"
USEFUL_RHO = 0.48
ALPHA = 0.05
MAX_WRONG_SIDE = 2
"""At most so many of the five pairs in the right order refute statement 6."""
SUBSETS = {"family": FAMILY, "apart": APART}


def all_figures(rigs: PublishedRigs, scores: Mapping[str, Json], effort: CameraEffort) -> Json:
    """Return correlations by outcome and score, those of the rivals, and the family's pairs.

    `scores` has our scores by rig and outcome, in the order of the rigs.
    """
    rivals = {
        name: np.array([rig.rivals[name] for rig in rigs.rigs]) for name in rigs.rigs[0].rivals
    }
    found: Json = {}
    for outcome in OUTCOMES:
        values = {name: values_of_score(scores, outcome, name) for name in SCORES}
        rows = {name: _row(rigs, outcome, own, effort) for name, own in values.items()}
        for row, p in zip(rows.values(), holm([r["p"] for r in rows.values()]), strict=True):
            row["holm"] = p
        for name, own in values.items():
            rows[name]["given"] = {} if own is None else _given(rigs, outcome, own, rivals, effort)
        found[outcome] = {
            "scores": rows,
            "rivals": {name: _row(rigs, outcome, own, effort) for name, own in rivals.items()},
        }
    return {"outcomes": found, "pairs": _pairs(rigs, scores)}


def samples_of(ap: Floats) -> PlacementSamples:
    """Return rigs as samples of one group with one AP each."""
    same = np.zeros(len(ap))
    return PlacementSamples(ap[:, None], same, same)


def _row(rigs: PublishedRigs, outcome: str, values: Floats | None, effort: CameraEffort) -> Json:
    """Return rho of values with an outcome over all rigs, by detector, and over parts of them."""
    ap = rigs.ap(outcome)
    row: Json = {"rho": None, "interval": [None, None], "p": 1.0}
    if values is None or np.ptp(values) <= SAME:
        return row
    ranked = near_equal(values)
    if spearman(ranked, ap) is not None:
        row = rank_figures(ranked, samples_of(ap), effort, effort.seed)
    row["by_detector"] = {
        name: spearman(ranked, by_outcome[outcome]) for name, by_outcome in rigs.by_detector.items()
    }
    for name, members in SUBSETS.items():
        index = positions_of(members)
        row[name] = _exact(ranked[index], ap[index])
    return row


def near_equal(values: Floats) -> Floats:
    """Return values in which those that differ by less than `SAME` from the next lower are it."""
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    for k in range(1, len(ordered)):
        if ordered[k] - ordered[k - 1] < SAME:
            ordered[k] = ordered[k - 1]
    found = np.empty_like(values)
    found[order] = ordered
    return found


def _exact(values: Floats, ap: Floats) -> Json:
    """Return rho and its exact p; None and 1 where it is not defined."""
    rho = spearman(values, ap)
    chance = under_chance(values.tolist(), [ap.tolist()])
    if rho is None or chance is None:
        return {"rho": None, "p": 1.0}
    return {"rho": rho, "p": exact_p(rho, chance)}


def _given(
    rigs: PublishedRigs,
    outcome: str,
    values: Floats,
    rivals: Mapping[str, Floats],
    effort: CameraEffort,
) -> Json:
    """Return the partial rho given each rival, with p after Holm over the rivals."""
    samples = samples_of(rigs.ap(outcome))
    ranked = near_equal(values)
    rows = {
        name: rank_figures(ranked, samples, effort, effort.seed, given=near_equal(rival))
        for name, rival in rivals.items()
    }
    for row, p in zip(rows.values(), holm([r["p"] for r in rows.values()]), strict=True):
        row["holm"] = p
    return rows


def _pairs(rigs: PublishedRigs, scores: Mapping[str, Json]) -> Json:
    """Return in how many pairs with the family's first rig a score has the sign of cars' AP."""
    first, *others = positions_of(FAMILY)
    found: Json = {}
    for name in SCORES:
        values = values_of_score(scores, CARS_OUTCOME, name)
        found[name] = {
            detector: 0 if values is None else _right(values, aps[CARS_OUTCOME], first, others)
            for detector, aps in rigs.by_detector.items()
        }
    return found


def _right(values: Floats, ap: Floats, first: int, others: Sequence[int]) -> int:
    def sign(of: Floats, other: int) -> int:
        by = float(of[other] - of[first])
        return 0 if abs(by) < SAME else 1 if by > 0.0 else -1

    return sum(sign(values, k) * sign(ap, k) > 0 for k in others)


def beside(interval: Sequence[float | None], edge: float) -> str:
    """Return `HOLDS` if an interval is above an edge, `REFUTED` if it is below."""
    low, high = interval
    if low is None or high is None:
        return UNDECIDED
    return HOLDS if low > edge else REFUTED if high < edge else UNDECIDED


def ranks(row: Mapping[str, Any]) -> str:
    """Return the verdict of statements 1 to 3 from the figures of a score with an outcome."""
    rho = row["rho"]
    if rho is None:
        return UNDECIDED
    if row["interval"][1] < 0.0:
        return REFUTED
    apart = row["apart"]["rho"]
    holds = row["holm"] < ALPHA and rho > 0.0 and apart is not None and apart > 0.0
    return HOLDS if holds else UNDECIDED


def more_than_rival(row: Mapping[str, Any]) -> str:
    """Return the verdict of statement 5 from the partial rho given a rival."""
    if row["interval"][1] < 0.0:
        return REFUTED
    return HOLDS if row["holm"] < ALPHA and row["rho"] > 0.0 else UNDECIDED


def orders_changes(right: Mapping[str, int]) -> str:
    """Return the verdict of statement 6 from the pairs that are right, by detector."""
    counts = right.values()
    if all(count == len(FAMILY) - 1 for count in counts):
        return HOLDS
    return REFUTED if all(count <= MAX_WRONG_SIDE for count in counts) else UNDECIDED


def verdicts(figures: Json) -> Json:
    """Return the verdicts of statements 1 to 6 by score, and whether it is shown for cameras."""
    outcomes = figures["outcomes"]
    found: Json = {}
    for name in SCORES:
        cars, adults, mean = (outcomes[outcome]["scores"][name] for outcome in OUTCOMES)
        row: Json = {
            "1": ranks(cars),
            "2": ranks(adults),
            "3": ranks(mean),
            "4": beside(cars["interval"], USEFUL_RHO),
            "5": {rival: more_than_rival(given) for rival, given in cars["given"].items()},
            "6": orders_changes(figures["pairs"][name]),
        }
        row["shown"] = row["1"] == HOLDS and HOLDS in (row["2"], row["3"])
        found[name] = row
    return found


def seen_becomes_figure(found: Json) -> bool:
    """Whether the entropy of the seen becomes a figure: it is shown, and more than each rival."""
    row = found[SEEN]
    beyond = row["5"].values()
    return bool(row["shown"] and beyond and all(verdict == HOLDS for verdict in beyond))

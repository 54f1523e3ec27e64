"""Scores against AP: rank correlations, and how likely they are by chance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from pe_core.base import Floats

from ..ranks import agreement, exact_p, exact_p_of_mean, holm, spearman, under_chance
from ..results_file import Json, Values, values_of
from .scores import (
    BASE,
    CANDIDATES,
    CLEAN,
    READINGS,
    Paper,
    RankedScore,
    Rating,
    ScoreChoice,
    candidates_of,
    papers,
)
from .tasks import ValidityEffort

ALL = "all"
LEVEL = "none rolled"
LAYOUTS = "LiDAR layouts"
"""Which placements are ranked: all; all without a printed roll; or all, where those that differ
only in their cameras count as one."""
TREATMENTS = {
    (READINGS[0], ALL): "rolls in degrees",
    (READINGS[1], ALL): "rolls in radians",
    (READINGS[0], LEVEL): "without rolled ones",
    (READINGS[0], LAYOUTS): "the second paper's four layouts",
}
"""How doubtful placements are treated: how rolls are read, and which placements are ranked. The
test is made with each of them, all other tables with the first."""
MAIN = next(iter(TREATMENTS))
MAIN_CLASS = "car"
"""The class of the test over both papers; the other classes are only shown."""
MIN_AGREEMENT = 0.5
"""Detectors that agree less than this rank placements too differently to be predicted."""
SIGNIFICANCE = 0.05
"""A correlation with a lower p is significant: it can be told from chance."""


@dataclass(frozen=True)
class RankComparison:
    """A ranking of a paper's placements by the AP of a class, which a score should predict.

    `condition` is "clean" or a corruption of the point clouds, `reading` how printed rolls are
    read, `selection` which placements are ranked.
    """

    paper: Paper
    condition: str
    cls: str
    reading: str
    selection: str

    @property
    def placements(self) -> list[tuple[str, ...]]:
        """The ranked placements: the name of each, or the names of those that count as one."""
        names = self.paper.placements
        if self.selection == LEVEL:
            return [(n,) for n in names if not self.paper.rolled(n)]
        if self.selection == ALL:
            return [(n,) for n in names]
        layouts = dict.fromkeys(map(_layout, names))
        return [tuple(n for n in names if _layout(n) == layout) for layout in layouts]

    @property
    def ap(self) -> dict[str, list[float]]:
        """AP of the placements, by detector."""
        by_detector = self.paper.ap[self.condition]
        return {
            detector: [_mean(by_class[self.cls][n] for n in names) for names in self.placements]
            for detector, by_class in by_detector.items()
        }

    def score_values(
        self, score: RankedScore, values: Values, choice: ScoreChoice = BASE
    ) -> list[float]:
        """Return a score's values for the placements, higher for better."""

        def value(name: str) -> float:
            reading = self.reading if self.paper.rolled(name) else READINGS[0]
            return score.value(Rating(self.paper, name, reading, self.cls, choice=choice), values)

        return [_mean(map(value, names)) for names in self.placements]

    def mean_rho(self, score_values: list[float]) -> float | None:
        """Return the mean of rho over the detectors; None where one of them is not defined."""
        rhos = [spearman(score_values, values) for values in self.ap.values()]
        return None if None in rhos else float(np.mean([rho for rho in rhos if rho is not None]))

    def chance(self, score_values: list[float]) -> Floats | None:
        """Return the distribution of the mean rho under chance."""
        return _chance(tuple(score_values), tuple(map(tuple, self.ap.values())))


@cache
def _chance(score: tuple[float, ...], ap: tuple[tuple[float, ...], ...]) -> Floats | None:
    return under_chance(score, ap)


def _layout(placement: str) -> str:
    """Return the name of a placement's LiDAR layout: what follows the name of its cameras."""
    return placement.rpartition("+")[2]


def _mean(values: Iterable[float]) -> float:
    return float(np.mean(list(values)))


def comparisons(paper: Paper) -> list[RankComparison]:
    """Return all comparisons that a paper's results allow."""
    treatments = list(TREATMENTS)
    if any(map(paper.rolled, paper.placements)):
        treatments = treatments[:3]
    else:
        has_cameras = any("+" in name for name in paper.placements)
        treatments = [treatments[0], treatments[3]] if has_cameras else treatments[:1]
    return [
        RankComparison(paper, condition, cls, *treatment)
        for condition, by_detector in paper.ap.items()
        for cls in paper.classes
        if all(cls in row for row in by_detector.values())
        for treatment in treatments
    ]


def correlations(values: Values, varied: list[ScoreChoice]) -> list[Json]:
    """Return a record for each comparison of each paper and each score.

    The lowest and the highest correlation are over the varied choices, besides `BASE`.
    """
    return [
        _correlation(comparison, score, values, varied)
        for paper in papers()
        for comparison in comparisons(paper)
        for score in candidates_of(paper)
    ]


def _correlation(
    comparison: RankComparison, score: RankedScore, values: Values, varied: list[ScoreChoice]
) -> Json:
    ap = comparison.ap
    score_values = comparison.score_values(score, values)
    chance = comparison.chance(score_values)
    mean = comparison.mean_rho(score_values)
    means = [mean]
    means += [comparison.mean_rho(comparison.score_values(score, values, c)) for c in varied]
    defined = [rho for rho in means if rho is not None]
    return {
        "paper": comparison.paper.id,
        "condition": comparison.condition,
        "class": comparison.cls,
        "reading": comparison.reading,
        "placements": comparison.selection,
        "count": len(comparison.placements),
        "score": score.name,
        "values": score_values,
        "by_detector": {name: spearman(score_values, by_name) for name, by_name in ap.items()},
        "mean": mean,
        "p": None if chance is None or mean is None else exact_p(mean, chance),
        "lowest": min(defined, default=None),
        "highest": max(defined, default=None),
        "agreement": agreement(list(ap.values())),
    }


def over_papers(values: Values, cls: str = MAIN_CLASS) -> list[Json]:
    """Return the test over both papers: a record for each of `TREATMENTS` and each of our scores.

    A record has the mean rho over the papers with clean results, its p, and p after Holm's
    correction. Both papers have the same weight, and the placements of each are permuted.
    """
    records: list[Json] = []
    first, second = papers()
    for reading, selection in TREATMENTS:
        selection_2 = LAYOUTS if selection == LAYOUTS else ALL
        pair = (
            RankComparison(first, CLEAN, cls, reading, selection=selection),
            RankComparison(second, CLEAN, cls, READINGS[0], selection=selection_2),
        )
        tests = [_over_both(score, pair, values) for score in CANDIDATES]
        for test, adjusted in zip(tests, holm([t["p"] for t in tests]), strict=True):
            treatment = {"reading": reading, "placements": selection}
            records.append({**test, "holm": adjusted, **treatment})
    return records


def _over_both(
    score: RankedScore, pair: tuple[RankComparison, RankComparison], values: Values
) -> Json:
    score_values = [comparison.score_values(score, values) for comparison in pair]
    rho = [c.mean_rho(v) for c, v in zip(pair, score_values, strict=True)]
    record: Json = {"score": score.name, "rho": rho, "mean": None, "p": 1.0}
    if rho[0] is not None and rho[1] is not None:
        first, second = (c.chance(v) for c, v in zip(pair, score_values, strict=True))
        assert first is not None and second is not None
        record["mean"] = (rho[0] + rho[1]) / 2.0
        record["p"] = exact_p_of_mean(record["mean"], first, second)
    return record


class ValidityResults:
    """Complete results of ``python -m studies.published``, as page and plots ask for them."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.made: Json = data["made"]
        self.seconds = [entry["seconds"] for entry in data["results"].values()]
        self.effort = ValidityEffort(**self.made["effort"])
        self.values = values_of(data)
        self.correlations: list[Json] = data["correlations"]
        self.tests: list[Json] = data["over_papers"]
        self.scores = [row["score"] for row in self.tests_of(MAIN)]

    def tests_of(self, treatment: tuple[str, str]) -> list[Json]:
        """Return the tests over both papers with a treatment, one for each score."""
        return [row for row in self.tests if (row["reading"], row["placements"]) == treatment]

    def test(self, score: str, treatment: tuple[str, str] = MAIN) -> Json:
        """Return the test of a score over both papers."""
        return next(row for row in self.tests_of(treatment) if row["score"] == score)

    def correlations_of(self, paper: Paper, cls: str) -> list[Json]:
        """Return the correlations of all scores in one paper, clean, with the main treatment."""
        wanted = (paper.id, CLEAN, cls, *MAIN)
        keys = ("paper", "condition", "class", "reading", "placements")
        return [row for row in self.correlations if tuple(row[key] for key in keys) == wanted]

    def correlation_of(self, paper: Paper, cls: str, score: str) -> Json:
        """Return the correlation of one score, with the main treatment."""
        rows = self.correlations_of(paper, cls)
        return next(row for row in rows if row["score"] == score)

    def significant(self) -> dict[str, list[str]]:
        """Return the scores that are significant after Holm's correction, by how often."""
        counts = {
            score: sum(self.test(score, t)["holm"] < SIGNIFICANCE for t in TREATMENTS)
            for score in self.scores
        }
        always = [score for score, count in counts.items() if count == len(TREATMENTS)]
        return {
            "always": always,
            "sometimes": [s for s, n in counts.items() if n and s not in always],
        }

    def opposite_in_papers(self) -> list[str]:
        """Return the scores whose correlations with the two papers' cars differ in sign."""
        rhos = {score: self.test(score)["rho"] for score in self.scores}
        return [s for s, rho in rhos.items() if None not in rho and rho[0] * rho[1] < 0.0]


def detectors_disagree(correlation: Json) -> bool:
    """Return whether the detectors disagree too much for a score to predict their ranking."""
    agreed = correlation["agreement"]
    return agreed is None or agreed < MIN_AGREEMENT

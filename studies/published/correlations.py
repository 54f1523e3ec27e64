"""Scores against AP: rank correlations, and how likely they are by chance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np

from ..results_file import CompleteResults
from ..task_runner import Values
from .published import CLEAN, READINGS, Paper, papers
from .ranks import Floats, agreement, exact_p, exact_p_of_mean, holm, spearman, under_chance
from .scores import BASE, CANDIDATES, RankedScore, Rating, ScoreChoice, candidates_of
from .tasks import ValidityEffort

Json = dict[str, Any]
Record = Mapping[str, Any]

ALL, LEVEL, LAYOUTS = "all", "none rolled", "LiDAR layouts"
"""Which placements are ranked: all; all without a printed roll; or all, where those that differ
only in their cameras count as one."""
TREATMENTS = (
    (READINGS[0], ALL),
    (READINGS[1], ALL),
    (READINGS[0], LEVEL),
    (READINGS[0], LAYOUTS),
)
"""How doubtful placements are treated: how rolls are read, and which placements are ranked. The
test is made with each of them, all other tables with the first."""
MAIN_CLASS = "car"
"""The class of the test over both papers; the other classes are only shown."""
MIN_AGREEMENT = 0.5
"""Detectors that agree less than this rank placements too differently to be predicted."""
SIGNIFICANCE = 0.05
"""A correlation with a lower p is significant: it can be told from chance."""


@dataclass(frozen=True)
class RankComparison:
    """A ranking of a paper's placements by the AP of a class, which a score should predict.

    Attributes
    ----------
    paper : Paper
    condition : str
        "clean", or a corruption of the point clouds.
    cls : str
    reading : str
        How printed rolls are read.
    selection : str
        Which placements are ranked: `ALL`, `LEVEL` or `LAYOUTS`.
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
            return score.value(Rating(self.paper, name, reading, self.cls, choice), values)

        return [_mean(map(value, names)) for names in self.placements]


def _layout(placement: str) -> str:
    """Return the name of a placement's LiDAR layout: what follows the name of its cameras."""
    return placement.rpartition("+")[2]


def _mean(values: Iterable[float]) -> float:
    return float(np.mean(list(values)))


def comparisons(paper: Paper) -> list[RankComparison]:
    """Return all comparisons that a paper's results allow."""
    found = []
    for condition, by_detector in paper.ap.items():
        classes = [cls for cls in paper.classes if all(cls in row for row in by_detector.values())]
        for cls in classes:
            found += [RankComparison(paper, condition, cls, *t) for t in _treatments(paper)]
    return found


def _treatments(paper: Paper) -> list[tuple[str, str]]:
    """Return the treatments that differ for a paper's placements."""
    if not any(map(paper.rolled, paper.placements)):
        has_cameras = any("+" in name for name in paper.placements)
        return [TREATMENTS[0], TREATMENTS[3]] if has_cameras else [TREATMENTS[0]]
    return list(TREATMENTS[:3])


def correlations(values: Values, varied: list[ScoreChoice]) -> list[Json]:
    """Return a record for each comparison of each paper and each score.

    Parameters
    ----------
    values : mapping
        The computed values, by the name of their task.
    varied : list of ScoreChoice
        The choices that the lowest and the highest correlation are over, besides `BASE`.
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
    by_detector = {name: spearman(score_values, by_name) for name, by_name in ap.items()}
    chance = _chance(tuple(score_values), tuple(map(tuple, ap.values())))
    mean = _mean_rho(score_values, ap)
    means = [mean]
    means += [_mean_rho(comparison.score_values(score, values, c), ap) for c in varied]
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
        "by_detector": by_detector,
        "mean": mean,
        "p": None if chance is None or mean is None else exact_p(mean, chance),
        "lowest": min(defined, default=None),
        "highest": max(defined, default=None),
        "agreement": agreement(list(ap.values())),
    }


def _mean_rho(score_values: list[float], ap: Mapping[str, list[float]]) -> float | None:
    """Return the mean of rho over the detectors; None where one of them is not defined."""
    rhos = [spearman(score_values, values) for values in ap.values()]
    return None if None in rhos else float(np.mean([rho for rho in rhos if rho is not None]))


@cache
def _chance(score: tuple[float, ...], ap: tuple[tuple[float, ...], ...]) -> Floats | None:
    return under_chance(score, ap)


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
            RankComparison(first, CLEAN, cls, reading, selection),
            RankComparison(second, CLEAN, cls, READINGS[0], selection_2),
        )
        tests = [_over_both(score, pair, values) for score in CANDIDATES]
        for test, adjusted in zip(tests, holm([t["p"] for t in tests]), strict=True):
            treatment = {"reading": reading, "placements": selection}
            records.append({**test, "holm": adjusted, **treatment})
    return records


def _over_both(
    score: RankedScore, pair: tuple[RankComparison, RankComparison], values: Values
) -> Json:
    rho, chance = [], []
    for comparison in pair:
        score_values, ap = comparison.score_values(score, values), comparison.ap
        rho.append(_mean_rho(score_values, ap))
        chance.append(_chance(tuple(score_values), tuple(map(tuple, ap.values()))))
    record: Json = {"score": score.name, "rho": rho, "mean": None, "p": 1.0}
    if rho[0] is not None and rho[1] is not None:
        assert chance[0] is not None and chance[1] is not None
        record["mean"] = (rho[0] + rho[1]) / 2.0
        record["p"] = exact_p_of_mean(record["mean"], chance[0], chance[1])
    return record


class ValidityResults(CompleteResults):
    """Complete results of ``python -m studies.published``, as the page asks for them."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        super().__init__(data)
        self.effort = ValidityEffort(**self.made["effort"])
        self.correlations: list[Record] = data["correlations"]
        self.tests: list[Record] = data["over_papers"]

    @cached_property
    def treatments(self) -> list[tuple[str, str]]:
        """The treatments of doubtful placements, the main one first: reading and selection."""
        return list(dict.fromkeys((row["reading"], row["placements"]) for row in self.tests))

    def tests_of(self, treatment: tuple[str, str]) -> list[Record]:
        """Return the tests over both papers with a treatment, one for each score."""
        return [row for row in self.tests if (row["reading"], row["placements"]) == treatment]

    @property
    def main_tests(self) -> list[Record]:
        """The tests over both papers with the main treatment."""
        return self.tests_of(self.treatments[0])

    def correlations_of(self, paper: Paper, cls: str, condition: str = CLEAN) -> list[Record]:
        """Return the correlations of all scores in one paper, with the main treatment."""
        wanted = (paper.id, condition, cls, *self.treatments[0])
        keys = ("paper", "condition", "class", "reading", "placements")
        return [row for row in self.correlations if tuple(row[key] for key in keys) == wanted]

    def correlation_of(self, paper: Paper, cls: str, score: str) -> Record:
        """Return the correlation of one score, with clean results and the main treatment."""
        return next(row for row in self.correlations_of(paper, cls) if row["score"] == score)

    def significant(self) -> list[str]:
        """Return the scores that are significant with every treatment, after Holm's correction."""
        names = [row["score"] for row in self.main_tests]
        return [n for n in names if all(self._is_significant(n, t) for t in self.treatments)]

    def sometimes_significant(self) -> list[str]:
        """Return the scores that are significant with some of the treatments, not with all."""
        names = [row["score"] for row in self.main_tests]
        some = [n for n in names if any(self._is_significant(n, t) for t in self.treatments)]
        return [n for n in some if n not in self.significant()]

    def opposite_in_papers(self) -> list[str]:
        """Return the scores whose correlations with the two papers' cars differ in sign."""
        return [
            row["score"]
            for row in self.main_tests
            if None not in row["rho"] and row["rho"][0] * row["rho"][1] < 0.0
        ]

    def _is_significant(self, name: str, treatment: tuple[str, str]) -> bool:
        row = next(row for row in self.tests_of(treatment) if row["score"] == name)
        return bool(row["holm"] < SIGNIFICANCE)


def detectors_disagree(correlation: Record) -> bool:
    """Return whether the detectors disagree too much for a score to predict their ranking."""
    agreed = correlation["agreement"]
    return agreed is None or agreed < MIN_AGREEMENT


def min_significant_rho(count: int) -> float | None:
    """Return the smallest significant rho of so many placements without ties, or None.

    It is significant by the exact p of a single test; there is none for very few placements.
    """
    ranks = list(map(float, range(count)))
    chance = under_chance(ranks, [ranks])
    assert chance is not None
    positive = sorted({round(float(rho), 9) for rho in chance if rho > 0.0})
    return next((rho for rho in positive if exact_p(rho, chance) <= SIGNIFICANCE), None)


def common_classes() -> list[str]:
    """Return the classes that every paper has."""
    first, *others = papers()
    return [cls for cls in first.classes if all(cls in paper.classes for paper in others)]

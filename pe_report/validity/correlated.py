"""Scores against AP: rank correlations, and how far chance would get."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from .choices import BASE, ScoreChoice
from .published import CLEAN, READINGS, Paper, papers
from .ranks import (
    Floats,
    agreement,
    exact_p,
    exact_p_of_mean,
    holm,
    spearman,
    under_chance,
)
from .scores import CANDIDATES, RankedScore, candidates_of

Values = Mapping[str, Any]
Json = dict[str, Any]

ALL, LEVEL, LAYOUTS = "all", "none rolled", "LiDAR layouts"
"""Rolled placements in, or out; or those that differ in their cameras alone taken as one."""
WAYS = ((READINGS[0], ALL), (READINGS[1], ALL), (READINGS[0], LEVEL), (READINGS[0], LAYOUTS))
"""How doubtful placements are taken in the one test: the first way is that of all other tables."""
MAIN_CLASS = "car"
"""The class of the one test over both papers; the others are shown."""
CEILING = 0.5
"""Detectors that agree less than this rank placements too differently to be predicted."""


@dataclass(frozen=True)
class RankQuestion:
    """What a score is asked: to rank a paper's placements as AP of a class does.

    Attributes
    ----------
    paper : Paper
    condition : str
        "clean", or a corruption of the point clouds.
    cls : str
    reading : str
        How printed rolls are read.
    placed : str
        `ALL`, `LEVEL` or `LAYOUTS`.
    """

    paper: Paper
    condition: str
    cls: str
    reading: str
    placed: str

    @property
    def placements(self) -> list[tuple[str, ...]]:
        """Names of the placements that are ranked, those that count as one together."""
        every = self.paper.placements
        if self.placed == LEVEL:
            return [(n,) for n in every if not self.paper.rolled(n)]
        if self.placed == ALL:
            return [(n,) for n in every]
        layouts = dict.fromkeys(map(_layout, every))
        return [tuple(n for n in every if _layout(n) == layout) for layout in layouts]

    @property
    def aims(self) -> dict[str, list[float]]:
        """AP of the placements, by detector."""
        by_detector = self.paper.ap[self.condition]
        return {
            detector: [_mean(by_class[self.cls][n] for n in names) for names in self.placements]
            for detector, by_class in by_detector.items()
        }

    def ranked(
        self, candidate: RankedScore, values: Values, variant: ScoreChoice = BASE
    ) -> list[float]:
        """Return a score's values of the placements, higher for better."""

        def value(name: str) -> float:
            how = self._reading(name), self.cls, variant, values
            return candidate.ranked(self.paper, name, *how)

        return [_mean(map(value, names)) for names in self.placements]

    def _reading(self, placement: str) -> str:
        return self.reading if self.paper.rolled(placement) else READINGS[0]


def _layout(placement: str) -> str:
    """Name of a placement's LiDAR layout: what follows the name of its cameras, if it has any."""
    return placement.rpartition("+")[2]


def _mean(values: Iterable[float]) -> float:
    return float(np.mean(list(values)))


def questions(paper: Paper) -> list[RankQuestion]:
    """Return all that a paper's table lets us ask."""
    found = []
    for condition, by_detector in paper.ap.items():
        classes = [cls for cls in paper.classes if all(cls in row for row in by_detector.values())]
        for cls in classes:
            found += [RankQuestion(paper, condition, cls, *how) for how in _ways(paper)]
    return found


def _ways(paper: Paper) -> list[tuple[str, str]]:
    """Return how a paper's own placements may be taken."""
    if not any(map(paper.rolled, paper.placements)):
        return [WAYS[0], WAYS[3]] if any("+" in n for n in paper.placements) else [WAYS[0]]
    return list(WAYS[:3])


def correlations(values: Values, tried: list[ScoreChoice]) -> list[Json]:
    """Return a row for each paper, condition, class, reading, set of placements and score."""
    return [
        _row(question, candidate, values, tried)
        for paper in papers()
        for question in questions(paper)
        for candidate in candidates_of(paper)
    ]


def _row(
    question: RankQuestion, candidate: RankedScore, values: Values, tried: list[ScoreChoice]
) -> Json:
    aims = question.aims
    score = question.ranked(candidate, values)
    by_detector = {detector: spearman(score, aim) for detector, aim in aims.items()}
    chance = _chance(tuple(score), tuple(map(tuple, aims.values())))
    mean = _mean_rho(score, aims)
    others = [_mean_rho(question.ranked(candidate, values, way), aims) for way in tried]
    known = [rho for rho in (mean, *others) if rho is not None]
    return {
        "paper": question.paper.id,
        "condition": question.condition,
        "class": question.cls,
        "reading": question.reading,
        "placements": question.placed,
        "count": len(question.placements),
        "score": candidate.name,
        "values": score,
        "by_detector": by_detector,
        "mean": mean,
        "p": None if chance is None or mean is None else exact_p(mean, chance),
        "lowest": min(known, default=None),
        "highest": max(known, default=None),
        "agreement": agreement(list(aims.values())),
    }


def _mean_rho(score: list[float], aims: Mapping[str, list[float]]) -> float | None:
    found = [spearman(score, aim) for aim in aims.values()]
    return None if None in found else float(np.mean([rho for rho in found if rho is not None]))


@cache
def _chance(score: tuple[float, ...], aims: tuple[tuple[float, ...], ...]) -> Floats | None:
    return under_chance(score, aims)


def over_papers(values: Values, cls: str = MAIN_CLASS) -> list[Json]:
    """Return, for each score of ours, its mean rho over the papers, clean results, and Holm's p.

    A row for each of `WAYS` and each score; the papers count alike, and in each of them all
    placements are shuffled.
    """
    rows: list[Json] = []
    first, second = papers()
    for reading, placed in WAYS:
        asked = (
            RankQuestion(first, CLEAN, cls, reading, placed),
            RankQuestion(second, CLEAN, cls, READINGS[0], LAYOUTS if placed == LAYOUTS else ALL),
        )
        found = [_over_both(candidate, asked, values) for candidate in CANDIDATES]
        for row, adjusted in zip(found, holm([row["p"] for row in found]), strict=True):
            rows.append({**row, "holm": adjusted, "reading": reading, "placements": placed})
    return rows


def _over_both(
    candidate: RankedScore, asked: tuple[RankQuestion, RankQuestion], values: Values
) -> Json:
    rho, chance = [], []
    for question in asked:
        score, aims = question.ranked(candidate, values), question.aims
        rho.append(_mean_rho(score, aims))
        chance.append(_chance(tuple(score), tuple(map(tuple, aims.values()))))
    row: Json = {"score": candidate.name, "rho": rho, "mean": None, "p": 1.0}
    if rho[0] is not None and rho[1] is not None:
        assert chance[0] is not None and chance[1] is not None
        row["mean"] = (rho[0] + rho[1]) / 2.0
        row["p"] = exact_p_of_mean(row["mean"], chance[0], chance[1])
    return row

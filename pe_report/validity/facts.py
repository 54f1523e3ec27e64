"""What the results of ``pe validate`` say, by question."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from .correlated import CEILING, MAIN_CLASS
from .effort import ValidityEffort
from .published import CLEAN, Paper, papers
from .ranks import exact_p, under_chance

Figures = Mapping[str, Any]
LEVEL_5 = 0.05
"""What is called told from chance."""


class ValidityFacts:
    """Look-ups in complete results; `said` has the verdicts that were drawn from them, by name."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.made: Mapping[str, Any] = data["made"]
        self.effort = ValidityEffort(**self.made["effort"])
        self.rows: list[Figures] = data["correlations"]
        self.tests: list[Figures] = data["over_papers"]
        self.seconds = {name: entry["seconds"] for name, entry in data["results"].items()}
        self.said: dict[str, str] = {}

    def say(self, name: str, words: str) -> str:
        """Note a verdict by name, and return its words."""
        self.said[name] = words
        return words

    @cached_property
    def ways(self) -> list[tuple[str, str]]:
        """How rolled placements were taken: reading, and which placements; the main way first."""
        return list(dict.fromkeys((row["reading"], row["placements"]) for row in self.tests))

    def tested(self, way: tuple[str, str]) -> list[Figures]:
        """Return the scores' tests over both papers."""
        return [row for row in self.tests if (row["reading"], row["placements"]) == way]

    def correlated(self, paper: Paper, cls: str, condition: str = CLEAN) -> list[Figures]:
        """Return the scores' correlations in one paper, rolls read the main way, all placements."""
        reading, placed = self.ways[0]
        wanted = (paper.id, condition, cls, reading, placed)
        keys = ("paper", "condition", "class", "reading", "placements")
        return [row for row in self.rows if tuple(row[key] for key in keys) == wanted]

    def rho(self, paper: Paper, cls: str, score: str) -> Figures:
        """Return one of them."""
        return next(row for row in self.correlated(paper, cls) if row["score"] == score)

    def told_apart(self) -> list[str]:
        """Scores that Holm's correction tells from chance, whichever way the rolls are taken."""
        names = [row["score"] for row in self.tested(self.ways[0])]
        return [n for n in names if all(self._holds(n, way) for way in self.ways)]

    def sometimes(self) -> list[str]:
        """Scores that are told from chance in some of the ways, not in all."""
        names = [row["score"] for row in self.tested(self.ways[0])]
        some = [n for n in names if any(self._holds(n, way) for way in self.ways)]
        return [n for n in some if n not in self.told_apart()]

    def opposite(self) -> list[str]:
        """Scores whose correlations with the two papers' cars differ in sign."""
        return [
            row["score"]
            for row in self.tested(self.ways[0])
            if None not in row["rho"] and row["rho"][0] * row["rho"][1] < 0.0
        ]

    def greyed(self, row: Figures) -> bool:
        """Whether the detectors disagree so much that nothing can be held against them."""
        agreed = row["agreement"]
        return agreed is None or agreed < CEILING

    def _holds(self, name: str, way: tuple[str, str]) -> bool:
        row = next(row for row in self.tested(way) if row["score"] == name)
        return bool(row["holm"] < LEVEL_5)


def least_told_apart(count: int) -> float | None:
    """Return the least rho of so many placements, without ties, whose exact p is below 5 %."""
    ranks = list(map(float, range(count)))
    chance = under_chance(ranks, [ranks])
    assert chance is not None
    positive = sorted({round(float(rho), 9) for rho in chance if rho > 0.0})
    found = [rho for rho in positive if exact_p(rho, chance) <= LEVEL_5]
    return found[0] if found else None


def classes() -> list[str]:
    """Return the classes that every paper has."""
    first, *others = papers()
    return [cls for cls in first.classes if all(cls in paper.classes for paper in others)]


__all__ = ["LEVEL_5", "MAIN_CLASS", "ValidityFacts", "classes", "least_told_apart"]

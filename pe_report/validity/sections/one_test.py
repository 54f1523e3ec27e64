"""The one test: each score's mean rho over the papers, held against all orders, after Holm."""

from __future__ import annotations

from ...words import table
from ..correlated import LAYOUTS, LEVEL
from ..facts import LEVEL_5, MAIN_CLASS, Figures, ValidityFacts
from ..published import papers


def one_test(facts: ValidityFacts) -> str:
    """Return the tables of the one test."""
    first, second = papers()
    return f"""
## The test

For each score: Spearman's rho with the AP of {MAIN_CLASS}s, mean over the detectors, in each paper (clean
results); the mean of the two; how often all orders of the placements, shuffled in each paper on their
own, give a mean as far from zero (p, exact, two-sided); and that after Holm's correction for the
{len(facts.tested(facts.ways[0]))} scores compared. A rho above zero is the right way round. Bold: below {LEVEL_5:.0%}.

{"".join(_way(facts, way) for way in facts.ways)}
![Rank correlation of every score with both papers](over_papers.png)

*Dots: {first.short} and {second.short}, cars, choices as fixed; bars: the range when what was chosen is
varied. Between the dashed lines a rho over eight placements is not told from chance on its own.*
"""


def _way(facts: ValidityFacts, way: tuple[str, str]) -> str:
    titles = ["score", *(p.short for p in papers()), "mean", "p", "p after Holm"]
    lines = [_line(facts, way, row) for row in facts.tested(way)]
    return f"### {way_text(way)}\n\n{table(titles, lines)}\n\n"


def way_text(way: tuple[str, str]) -> str:
    """Say how the rolled placements are taken."""
    reading, placed = way
    if placed == LEVEL:
        return "Without the rolled placements"
    if placed == LAYOUTS:
        return "The second paper's four LiDAR layouts, cameras averaged"
    return f"All placements, rolls in {reading}"


def _line(facts: ValidityFacts, way: tuple[str, str], row: Figures) -> list[str]:
    told = share(row["holm"])
    if row["holm"] < LEVEL_5:
        told = f"**{told}**"
    figures = [signed(value) for value in (*row["rho"], row["mean"])]
    name = f"test: {row['score']}, {', '.join(way)}"
    return [row["score"], *figures, share(row["p"]), facts.say(name, told)]


def signed(value: float | None) -> str:
    """Return a rho as it is shown; a dash where a score has one value for all."""
    return "-" if value is None else f"{round(value, 2) + 0.0:+.2f}"


def share(p: float) -> str:
    """Return a p value as it is shown."""
    return f"{p:.3f}" if p >= 0.001 else "< 0.001"

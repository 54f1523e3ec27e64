"""Class by class, choice by choice, condition by condition."""

from __future__ import annotations

from ...words import table
from ..choices import variants
from ..correlated import CEILING
from ..facts import MAIN_CLASS, Figures, ValidityFacts
from ..published import CLEAN, Paper, papers
from .one_test import share, signed, way_text


def by_class(facts: ValidityFacts) -> str:
    """Return the tables of all classes and detectors, clean."""
    return f"""
## Every class and detector

{way_text(facts.ways[0])}; clean results. The last line of each table is the ceiling: how well the
detectors rank placements like one another (mean rho of each with the others' mean ranks). Where it is
below {CEILING:g} they want different placements, nothing can be held against them, and the column is *in
italics* here and grey in the plot.

![Rank correlation by class](by_class.png)

{"".join(_tables(facts, paper) for paper in papers())}"""


def _tables(facts: ValidityFacts, paper: Paper) -> str:
    return "".join(_table(facts, paper, cls) for cls in paper.classes)


def _table(facts: ValidityFacts, paper: Paper, cls: str) -> str:
    rows = facts.correlated(paper, cls)
    detectors = list(rows[0]["by_detector"])
    lines = [_line(facts, row, detectors) for row in rows]
    ceiling = f"{rows[0]['agreement']:+.2f}"
    lines.append(["detectors with each other", *([""] * len(detectors)), ceiling, ""])
    titles = ["score", *detectors, "mean", "p"]
    return f"### {paper.short}: {paper.classes[cls]}\n\n{table(titles, lines)}\n\n"


def _line(facts: ValidityFacts, row: Figures, detectors: list[str]) -> list[str]:
    figures = [signed(row["by_detector"][name]) for name in detectors]
    p = "-" if row["p"] is None else share(row["p"])
    told = [*figures, signed(row["mean"]), p]
    if facts.greyed(row):
        told = [f"*{figure}*" for figure in told]
    return [row["score"], *told]


def ranges(facts: ValidityFacts) -> str:
    """Return how far each score's correlation moves with what had to be chosen."""
    tried = [way.name for way in variants(facts.effort.all_variants) if way.name]
    if not tried:
        return ""
    titles = ["score", *(f"{p.short}, lowest to highest" for p in papers())]
    names = [row["score"] for row in facts.tested(facts.ways[0])]
    lines = [[name, *(_range(facts.rho(p, MAIN_CLASS, name)) for p in papers())] for name in names]
    return f"""
## What had to be chosen, varied

One at a time: {"; ".join(tried)}. Mean rho with the AP of {MAIN_CLASS}s, {way_text(facts.ways[0]).lower()}, over the
choice that was fixed and all of these.

{table(titles, lines)}
"""


def _range(row: Figures) -> str:
    return f"{signed(row['lowest'])} to {signed(row['highest'])}"


def by_condition(facts: ValidityFacts) -> str:
    """Return the correlations under corruptions of the point clouds."""
    parts = [_conditions(facts, paper) for paper in papers() if len(paper.ap) > 1]
    return f"""
## In bad weather

The first paper also has the AP of {MAIN_CLASS}s when the clean-trained detectors are given corrupted point
clouds. Mean rho over the detectors, {way_text(facts.ways[0]).lower()}; *italics* where they do not agree among
themselves. The scores know nothing of weather.

{"".join(parts)}"""


def _conditions(facts: ValidityFacts, paper: Paper) -> str:
    conditions = [c for c in paper.ap if c != CLEAN]
    found = {c: facts.correlated(paper, MAIN_CLASS, c) for c in conditions}
    names = [row["score"] for row in found[conditions[0]]]
    lines = [[n, *(_cell(facts, found[c][k]) for c in conditions)] for k, n in enumerate(names)]
    agreed = [f"{found[c][0]['agreement']:+.2f}" for c in conditions]
    lines.append(["detectors with each other", *agreed])
    titles = ["score", *(c.replace("_", " ") for c in conditions)]
    return f"{table(titles, lines)}\n\n"


def _cell(facts: ValidityFacts, row: Figures) -> str:
    told = signed(row["mean"])
    return f"*{told}*" if facts.greyed(row) else told

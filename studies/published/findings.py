"""What the comparison with published results says: verdicts and tables for the page."""

from __future__ import annotations

import math

from ..pages import p_text, rho_text
from ..ranks import min_significant_rho
from ..results_file import Json
from .correlations import (
    MAIN_CLASS,
    MIN_AGREEMENT,
    SIGNIFICANCE,
    TREATMENTS,
    ValidityResults,
    detectors_disagree,
)
from .published import CLEAN, Paper, papers
from .scores import BODY_M, CANDIDATES, candidates_of, variants

HEIGHT = "mean height"
TRUE_RHO = (0.3, 0.5, 0.7, 0.9)
"""True correlations that a further experiment is planned for."""
Z_TWO_SIDED, Z_POWER = 1.959964, 0.841621
"""Normal quantiles: 5 % two-sided, and a power of 80 %."""
SPEARMAN_VARIANCE = 1.06
"""Variance of Fisher's z of Spearman's rho, times n - 3 (Fieller, Hartley and Pearson 1957)."""
GPU_HOURS, SEEDS, DETECTORS = 10, 3, 2
"""Assumed cost of a training, and trainings of a placement."""


def page_values(results: ValidityResults, own: str) -> Json:
    """Return what the template of the page is given; `own` is the answer of our own study."""
    rows = [row for row in results.tests if row["mean"] is not None][: len(results.scores)]
    disagreements = [
        f"{paper.classes[cls]} in {paper.short}"
        for paper in papers()
        for cls in papers()[0].classes
        if cls in paper.classes and detectors_disagree(results.correlations_of(paper, cls)[0])
    ]
    return {
        "results": results,
        "own": own,
        "papers": papers(),
        "significant": results.significant(),
        "significance": SIGNIFICANCE,
        "opposite": results.opposite_in_papers(),
        "height": [results.correlation_of(p, MAIN_CLASS, HEIGHT)["mean"] for p in papers()],
        "worst": min(rows, key=lambda row: row["mean"]),
        "best": max(rows, key=lambda row: row["mean"]),
        "positive": [row["score"] for row in rows if min(row["rho"]) > 0.0],
        "disagreements": disagreements,
        "evidence": [_paper_line(paper) for paper in papers()],
        "least_rho": min_significant_rho(8),
        "candidates": _candidates(),
        "body": " x ".join(f"{side:g}" for side in BODY_M),
        "treatments": list(TREATMENTS.values()),
        "tests": [_test_line(results, score) for score in results.scores],
        "conditions": [c.replace("_", " ") for c in _conditions()],
        "by_condition": _by_condition(results),
        "min_agreement": MIN_AGREEMENT,
        "choices": [c.name for c in variants(results.effort.all_variants) if c.name],
        "needed": [_needed(rho) for rho in TRUE_RHO],
        "seeds": SEEDS,
        "detectors": DETECTORS,
        "gpu_hours": GPU_HOURS,
    }


def _paper_line(paper: Paper) -> list[str]:
    lidar, detectors = paper.lidar, list(next(iter(paper.ap.values())))
    return [
        f"{paper.citation} ({paper.repository})",
        str(len(paper.placements)),
        f"{lidar['channels']:.0f} channels, {lidar['low_deg']:g} to {lidar['high_deg']:g} deg",
        ", ".join(paper.classes.values()),
        ", ".join(detectors),
        ", ".join(paper.ap).replace("_", " "),
    ]


def _candidates() -> list[list[str]]:
    """Return the lines of the table of scores; those in traffic are in the text."""
    lines = [[c.name, c.about] for c in CANDIDATES if "traffic" not in c.name]
    authors = [f"{name} ({p.short})" for p in papers() for name in p.surrogates]
    return [
        *lines,
        [", ".join(authors), "the authors' own scores of their placements, as published"],
    ]


def _test_line(results: ValidityResults, score: str) -> list[str]:
    """Return rho in both papers, and the mean rho with its p by treatment."""
    cells = []
    for treatment in TREATMENTS:
        row = results.test(score, treatment)
        corrected = p_text(row["holm"])
        corrected = f"**{corrected}**" if row["holm"] < SIGNIFICANCE else corrected
        cells.append(f"{rho_text(row['mean'])} ({p_text(row['p'])}, {corrected})")
    return [score, *map(rho_text, results.test(score)["rho"]), *cells]


def _cell(row: Json) -> str:
    """Return a mean rho, in italics where the detectors do not agree."""
    return f"*{rho_text(row['mean'])}*" if detectors_disagree(row) else rho_text(row["mean"])


def _conditions() -> list[str]:
    return [condition for condition in papers()[0].ap if condition != CLEAN]


def _by_condition(results: ValidityResults) -> list[list[str]]:
    paper = papers()[0]

    def rows(score: str) -> list[Json]:
        return [results.correlation_of(paper, MAIN_CLASS, score, c) for c in _conditions()]

    names = [score.name for score in candidates_of(paper)]
    lines = [[name, *map(_cell, rows(name))] for name in names]
    agreements = [rho_text(row["agreement"]) for row in rows(names[0])]
    return [*lines, ["detectors with each other", *agreements]]


def placements_for(rho: float) -> int:
    """Return how many placements find a true rho significant with a power of 80 %."""
    needed = ((Z_TWO_SIDED + Z_POWER) / math.atanh(rho)) ** 2
    return 3 + math.ceil(SPEARMAN_VARIANCE * needed)


def _needed(rho: float) -> list[str]:
    trainings = placements_for(rho) * DETECTORS * SEEDS
    return [f"{rho:g}", f"{placements_for(rho)}", f"{trainings}", f"{trainings * GPU_HOURS:,}"]


def summary(results: ValidityResults) -> str:
    """Return the test over both papers in a few lines, for people."""
    return "\n".join(
        f"{row['score']:34} {' '.join(map(rho_text, row['rho']))}  mean {rho_text(row['mean'])}"
        f"  p {row['p']:.3f}  after Holm {row['holm']:.3f}"
        for row in map(results.test, results.scores)
    )

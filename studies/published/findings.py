"""What the comparison with published results says: verdicts and tables for the page."""

from __future__ import annotations

from ..pages import p_text, rho_text
from ..ranks import min_significant_rho
from ..results_file import Json
from .correlations import MAIN_CLASS, SIGNIFICANCE, TREATMENTS, ValidityResults, detectors_disagree
from .published import Paper, papers
from .scores import BODY_M

HEIGHT = "mean height"


def page_values(results: ValidityResults) -> Json:
    """Return what the template of the page is given."""
    rows = [row for row in results.tests if row["mean"] is not None][: len(results.scores)]
    disagreements = [
        f"{paper.classes[cls]} in {paper.short}"
        for paper in papers()
        for cls in papers()[0].classes
        if cls in paper.classes and detectors_disagree(results.correlations_of(paper, cls)[0])
    ]
    return {
        "results": results,
        "papers": papers(),
        "significant": results.significant(),
        "opposite": results.opposite_in_papers(),
        "height": [results.correlation_of(p, MAIN_CLASS, HEIGHT)["mean"] for p in papers()],
        "worst": min(rows, key=lambda row: row["mean"]),
        "best": max(rows, key=lambda row: row["mean"]),
        "disagreements": disagreements,
        "evidence": [_paper_line(paper) for paper in papers()],
        "least_rho": min_significant_rho(8),
        "surrogates": [f"{name} ({p.short})" for p in papers() for name in p.surrogates],
        "body": " x ".join(f"{side:g}" for side in BODY_M),
        "treatments": list(TREATMENTS.values()),
        "tests": [_test_line(results, score) for score in results.scores],
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


def _test_line(results: ValidityResults, score: str) -> list[str]:
    """Return rho in both papers, and the mean rho with its p by treatment."""
    cells = []
    for treatment in TREATMENTS:
        row = results.test(score, treatment)
        corrected = p_text(row["holm"])
        corrected = f"**{corrected}**" if row["holm"] < SIGNIFICANCE else corrected
        cells.append(f"{rho_text(row['mean'])} ({p_text(row['p'])}, {corrected})")
    return [score, *map(rho_text, results.test(score)["rho"]), *cells]


def summary(results: ValidityResults) -> str:
    """Return the test over both papers in a few lines, for people."""
    return "\n".join(
        f"{row['score']:34} {' '.join(map(rho_text, row['rho']))}  mean {rho_text(row['mean'])}"
        f"  p {row['p']:.3f}  after Holm {row['holm']:.3f}"
        for row in map(results.test, results.scores)
    )

"""``python -m studies.published``: compare the scores with published results of detectors."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import main, page_parser
from ..pages import PAGE, check_page, render, rho_text
from ..ranks import min_significant_rho
from ..results_file import RESULTS, Json, compute, read_complete
from .correlations import (
    MAIN_CLASS,
    SIGNIFICANCE,
    TREATMENTS,
    ValidityResults,
    correlations,
    detectors_disagree,
    over_papers,
)
from .plots import draw_all
from .scores import BASE, BODY_M, papers, variants
from .tasks import FULL, QUICK, ValidityEffort, plan

TITLE = "# Do the scores rank placements as detectors do?"
FOLDER = "docs/validity/published"
QUICK_FOLDER = "validity-quick"


def validate(args: argparse.Namespace, folder: Path) -> Answer:
    """Compute the scores that are missing, correlate them, write the page and its plots."""
    folder = prepare_folder(folder)
    check_page(folder, TITLE, "published")
    data = read_results(folder / RESULTS) if args.page_only else _computed(args, folder)
    results = ValidityResults(data)
    write_bytes(folder / PAGE, page(results).encode())
    draw_all(results, folder)
    return dump_json(data) if args.json else summary(results), DONE


def _computed(args: argparse.Namespace, folder: Path) -> Json:
    effort = QUICK if args.quick else FULL
    results = compute(folder, effort, partial(plan, effort), args.workers)
    return results.save(**conclusions(results.values, effort))


def conclusions(values: Json, effort: ValidityEffort) -> Json:
    """Return what follows from the scores: correlations, and the test over both papers."""
    varied = [choice for choice in variants(effort.all_variants) if choice != BASE]
    return {"correlations": correlations(values, varied), "over_papers": over_papers(values)}


def read_results(path: Path) -> Json:
    """Read a complete results.json; its correlations must follow from its scores."""

    def following(values: Json, effort: Json) -> Json:
        return conclusions(values, ValidityEffort(**effort))

    return read_complete(path, following, "correlations", "over_papers")


def page(results: ValidityResults) -> str:
    """Return the page as Markdown."""
    rows = [row for row in results.tests if row["mean"] is not None][: len(results.scores)]
    disagreements = [
        f"{paper.classes[cls]} in {paper.short}"
        for paper in papers()
        for cls in papers()[0].classes
        if cls in paper.classes and detectors_disagree(results.correlations_of(paper, cls)[0])
    ]
    height = [results.correlation_of(p, MAIN_CLASS, "mean height")["mean"] for p in papers()]
    values = {
        "results": results,
        "papers": papers(),
        "significant": results.significant(),
        "significance": SIGNIFICANCE,
        "opposite": results.opposite_in_papers(),
        "height": height,
        "worst": min(rows, key=lambda row: row["mean"]),
        "best": max(rows, key=lambda row: row["mean"]),
        "disagreements": disagreements,
        "least_rho": min_significant_rho(8),
        "surrogates": [f"{name} ({p.short})" for p in papers() for name in p.surrogates],
        "body": " x ".join(f"{side:g}" for side in BODY_M),
        "treatments": TREATMENTS,
    }
    return render(Path(__file__).with_name("page.md.j2"), values)


def summary(results: ValidityResults) -> str:
    """Return the test over both papers in a few lines, for people."""
    return "\n".join(
        f"{row['score']:34} {' '.join(map(rho_text, row['rho']))}  mean {rho_text(row['mean'])}"
        f"  p {row['p']:.3f}  after Holm {row['holm']:.3f}"
        for row in map(results.test, results.scores)
    )


if __name__ == "__main__":
    parser, _ = page_parser(
        "published",
        "compare the scores with published results of detectors",
        (FOLDER, QUICK_FOLDER),
        "on few voxels and objects, in a minute",
    )
    main(parser, validate)

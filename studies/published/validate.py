"""Compute the scores, correlate them, write the page and its plots."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.base import dump_json, write_bytes
from pe_tools.cli import DONE, Answer

from ..results_file import RESULTS, read_complete, read_json, values_of
from ..task_runner import compute
from ..wording import PAGE, check_page
from .correlations import ValidityResults, correlations, over_papers
from .findings import rho_text
from .page import TITLE, page
from .plots import draw_all
from .scores import BASE, variants
from .tasks import FULL, QUICK, ValidityEffort, plan

CONCLUSIONS = ("correlations", "over_papers")
"""The keys of results.json that follow from the scores."""


def validate(args: argparse.Namespace, folder: Path) -> Answer:
    """Run the verb."""
    folder = prepare_folder(folder)
    check_page(folder, TITLE, "python -m studies.published")
    data = _results(args, folder)
    results = ValidityResults(data)
    write_bytes(folder / PAGE, page(results, own_answer(folder)).encode())
    draw_all(data, folder)
    return dump_json(data) if args.json else summary(results), DONE


def own_answer(folder: Path) -> str:
    """Return the answer of our own study, whose results are in a folder of its own within."""
    path = folder / "own" / RESULTS
    return str(read_json(path)["answer"]) if path.exists() else "it is not done here."


def _results(args: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Return complete results: those of the folder, or computed ones."""
    if args.page_only:
        return read_results(folder / RESULTS)
    effort = QUICK if args.quick else FULL
    results = compute(folder, effort, partial(plan, effort), args.workers)
    return results.save(**conclusions(results.values, effort))


def conclusions(values: Mapping[str, Any], effort: ValidityEffort) -> dict[str, Any]:
    """Return what follows from the scores: correlations, and the test over both papers."""
    varied = [choice for choice in variants(effort.all_variants) if choice != BASE]
    return {"correlations": correlations(values, varied), "over_papers": over_papers(values)}


def summary(results: ValidityResults) -> str:
    """Return the test over both papers in a few lines, for people."""
    return "\n".join(
        f"{row['score']:34} {' '.join(map(rho_text, row['rho']))}  mean {rho_text(row['mean'])}"
        f"  p {row['p']:.3f}  after Holm {row['holm']:.3f}"
        for row in results.main_tests
    )


def read_results(path: Path) -> dict[str, Any]:
    """Read a complete results.json; its correlations must follow from its scores."""
    data = read_complete(path, *CONCLUSIONS)
    effort = ValidityEffort(**data["made"]["effort"])
    for key, value in conclusions(values_of(data), effort).items():
        if data[key] != json.loads(dump_json(value)):
            raise InputError(path, key, "those that follow from the scores", "others")
    return data

"""Compute the paper's experiments, compare with the paper, write the page and its plots."""

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

from ..results_file import RESULTS, ResultsFile, read_complete, values_of
from ..task_runner import compute, print_progress
from ..wording import PAGE, check_page
from .claims import claims
from .page import TITLE, page
from .plan import FULL, QUICK, Effort, effort_from_dict, plan, scores_and_figures
from .plots import draw_all
from .result_view import ReproductionResults

DIFFERENT = 1
"""Exit status when a claim holds under none of the priors, or a result is not reproduced."""


def reproduce(args: argparse.Namespace, folder: Path) -> Answer:
    """Run the verb."""
    if args.check:
        return _check_results(folder)
    folder = prepare_folder(folder)
    check_page(folder, TITLE, "python -m studies.paper")
    data = _results(args, folder)
    write_bytes(folder / PAGE, page(ReproductionResults(data)).encode())
    draw_all(data, folder)
    text = dump_json(data) if args.json else summary(data)
    return text, DONE if _agrees_with_paper(data) else DIFFERENT


def _check_results(folder: Path) -> Answer:
    """Compute again what needs no search, and report what is not equal."""
    data = read_results(folder / RESULTS)
    tasks = scores_and_figures(effort_from_dict(data["made"]["effort"]))
    different = []
    for done, task in enumerate(tasks, 1):
        value = json.loads(dump_json(task.function(**task.arguments)))
        equal = value == data["results"][task.name]["value"]
        print_progress(f"[{done}/{len(tasks)}] {task.name}  {'equal' if equal else 'NOT EQUAL'}")
        if not equal:
            different.append(f"not equal: {task.name}")
    equal_count = len(tasks) - len(different)
    lines = [*different, f"{equal_count} of {len(tasks)} scores and figures are equal"]
    return "\n".join(lines), DIFFERENT if different else DONE


def _results(args: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Return complete results: those of the folder, or computed ones."""
    if args.page_only:
        return read_results(folder / RESULTS)
    effort = QUICK if args.quick else FULL
    results = compute(folder, effort, partial(plan, effort), args.workers)
    return with_claims(results, effort)


def with_claims(results: ResultsFile, effort: Effort) -> dict[str, Any]:
    """Write the complete results, with the paper's claims; return their data."""
    return results.save(claims=[claim.to_dict() for claim in claims(results.values, effort)])


def summary(data: Mapping[str, Any]) -> str:
    """Return the claims in a few lines, for people."""
    results, lines = ReproductionResults(data), []
    for claim in data["claims"]:
        verdict = "holds" if claim["holds"] else "DOES NOT HOLD"
        verdict = verdict if results.is_decided(claim) else "not decided"
        lines.append(
            f"{verdict:13}  {claim['text']} ({claim['where']}, {claim['prior']}): "
            f"{claim['better']} {claim['better_entropy']:.4f}, "
            f"{claim['worse']} {claim['worse_entropy']:.4f}"
        )
    return "\n".join(lines)


def _agrees_with_paper(data: Mapping[str, Any]) -> bool:
    """Return whether every claim holds under at least one of the priors."""
    holding = {c["text"] for c in data["claims"] if c["holds"]}
    return holding == {c["text"] for c in data["claims"]}


def read_results(path: Path) -> dict[str, Any]:
    """Read a complete results.json; its claims must follow from its values."""
    data = read_complete(path, "claims")
    claimed = claims(values_of(data), effort_from_dict(data["made"]["effort"]))
    if data["claims"] != json.loads(dump_json([claim.to_dict() for claim in claimed])):
        raise InputError(path, "claims", "those that follow from the results", "other claims")
    return data

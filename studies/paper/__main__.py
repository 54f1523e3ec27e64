"""``python -m studies.paper``: run the paper's experiments, compare, write the page and plots."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import main, page_parser
from ..pages import PAGE, check_page, render
from ..results_file import RESULTS, Json, compute, plain, print_progress, read_complete
from .claims import claims
from .experiments import FULL, QUICK, Effort, plan, scores_and_figures
from .findings import Findings, page_values
from .plots import draw_all

TITLE = "# The paper's experiments, reproduced"
FOLDER = "docs/reproduction"
QUICK_FOLDER = "reproduction-quick"
DIFFERENT = 1
"""Exit status when a claim holds under none of the priors, or a result is not reproduced."""


def reproduce(args: argparse.Namespace, folder: Path) -> Answer:
    """Compute what is missing, write page and plots, and return the claims."""
    if args.check:
        return _check_results(folder)
    folder = prepare_folder(folder)
    check_page(folder, TITLE, "paper")
    data = read_results(folder / RESULTS) if args.page_only else _computed(args, folder)
    findings = Findings(data)
    write_bytes(folder / PAGE, page(findings).encode())
    draw_all(findings, folder)
    agrees = {c["text"] for c in data["claims"]} == {
        c["text"] for c in data["claims"] if c["holds"]
    }
    return dump_json(data) if args.json else summary(findings), DONE if agrees else DIFFERENT


def _computed(args: argparse.Namespace, folder: Path) -> Json:
    effort = QUICK if args.quick else FULL
    results = compute(folder, effort, partial(plan, effort), args.workers)
    return results.save(claims=[claim.to_dict() for claim in claims(results.values, effort)])


def read_results(path: Path) -> Json:
    """Read a complete results.json; its claims must follow from its values."""

    def conclusions(values: Json, effort: Json) -> Json:
        found = claims(values, Effort.from_dict(effort))
        return {"claims": [claim.to_dict() for claim in found]}

    return read_complete(path, conclusions, "claims")


def _check_results(folder: Path) -> Answer:
    """Compute again what needs no search, and report what is not equal."""
    data = read_results(folder / RESULTS)
    tasks = scores_and_figures(Effort.from_dict(data["made"]["effort"]))
    different = []
    for done, task in enumerate(tasks, 1):
        equal = plain(task.function(**task.arguments)) == data["results"][task.name]["value"]
        print_progress(f"[{done}/{len(tasks)}] {task.name}  {'equal' if equal else 'NOT EQUAL'}")
        if not equal:
            different.append(f"not equal: {task.name}")
    equal_count = len(tasks) - len(different)
    lines = [*different, f"{equal_count} of {len(tasks)} scores and figures are equal"]
    return "\n".join(lines), DIFFERENT if different else DONE


def page(findings: Findings) -> str:
    """Return the page as Markdown."""
    return render(Path(__file__).with_name("page.md.j2"), page_values(findings))


def summary(findings: Findings) -> str:
    """Return the claims in a few lines, for people."""
    return "\n".join(
        f"{findings.verdict(c).replace('does not hold', 'DOES NOT HOLD'):13}  {c['text']} "
        f"({c['where']}, {c['prior']}): {c['better']} {c['better_entropy']:.4f}, "
        f"{c['worse']} {c['worse_entropy']:.4f}"
        for c in findings.claims
    )


if __name__ == "__main__":
    parser, alternatives = page_parser(
        "paper",
        "run the paper's experiments and report on them",
        (FOLDER, QUICK_FOLDER),
        "check all orderings in a minute",
    )
    alternatives.add_argument(
        "--check",
        action="store_true",
        help="compute again what needs no search, and compare it with the folder's results",
    )
    main(parser, reproduce)

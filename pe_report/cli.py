"""The verbs ``fit`` and ``reproduce`` of the command ``pe``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from pe_core.app import DONE, INTERRUPTED, Answer
from pe_core.errors import InputError
from pe_core.study import prepare_folder
from pe_core.text import dump_json

from .claims import claims
from .effort import FULL, QUICK, Effort
from .fitting import add_fit, matplotlib_figures
from .ledger import RESULTS, Ledger, read_results
from .page import write_page
from .problems import STUDIES
from .runner import run_all

UNLIKE_THE_PAPER = 1
"""Exit status of ``reproduce`` when an ordering holds under none of the priors."""
FOLDER, QUICK_FOLDER = "docs/reproduction", "reproduction-quick"


def add_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verbs to the parser of ``pe``."""
    add_fit(verbs)
    reproduce = verbs.add_parser("reproduce", help="run the paper's experiments and report on them")
    reproduce.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        help=f"folder for page, plots and results.json (default {FOLDER}, or {QUICK_FOLDER})",
    )
    reproduce.add_argument("--quick", action="store_true", help="check all orderings in a minute")
    reproduce.add_argument(
        "--page-only",
        action="store_true",
        help="write page and plots of the results that are there",
    )
    reproduce.add_argument("--json", action="store_true", help="print results.json on stdout")
    reproduce.add_argument("--workers", type=int, metavar="N", help="processes (default: all)")
    reproduce.set_defaults(function=_reproduce)


def _reproduce(args: argparse.Namespace) -> Answer:
    if not STUDIES.is_dir():
        found = "none: the paper's studies come with a checkout, not with the installed engine"
        raise InputError(str(STUDIES), "folder", "study files of the experiments", found)
    folder = prepare_folder(args.output or (QUICK_FOLDER if args.quick else FOLDER))
    figures = matplotlib_figures()  # complains now, not after an hour, where matplotlib is missing
    if args.page_only:
        data = read_results(folder / RESULTS)
    else:
        computed = _computed(folder, QUICK if args.quick else FULL, args.workers)
        if computed is None:
            return "", INTERRUPTED
        data = computed
    figures.draw_all(data, folder)
    write_page(data, folder)
    text = dump_json(data) if args.json else summary(data)
    return text, DONE if _like_the_paper(data) else UNLIKE_THE_PAPER


def _computed(folder: Path, effort: Effort, workers: int | None) -> dict[str, Any] | None:
    """Compute what is not there yet; return the complete results, None when interrupted."""
    ledger = Ledger(folder, effort)
    if ledger.found:
        _tell(f"going on from {ledger.path}, which has {ledger.found} results")
    try:
        run_all(effort, ledger, workers, _tell)
    except KeyboardInterrupt:
        _tell(f"pe: interrupted; {ledger.path} keeps what is done, the same command goes on")
        return None
    return finish(ledger, effort)


def finish(ledger: Ledger, effort: Effort) -> dict[str, Any]:
    """Judge the orderings, and write the complete results."""
    judged = [claim.to_dict() for claim in claims(ledger.values, effort)]
    return ledger.save(claims=judged)


def summary(data: dict[str, Any]) -> str:
    """Return the orderings in a few lines, for people."""
    lines = []
    for claim in data["claims"]:
        verdict = "holds" if claim["holds"] else "DOES NOT HOLD"
        lines.append(
            f"{verdict:13}  {claim['text']} ({claim['where']}, {claim['prior']}): "
            f"{claim['better']} {claim['better_entropy']:.4f}, "
            f"{claim['worse']} {claim['worse_entropy']:.4f}"
        )
    return "\n".join(lines)


def _like_the_paper(data: dict[str, Any]) -> bool:
    """Whether every ordering holds under one of the priors at least."""
    held = {c["text"] for c in data["claims"] if c["holds"]}
    return held == {c["text"] for c in data["claims"]}


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)

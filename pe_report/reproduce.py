"""What ``pe reproduce`` does: compute, judge, draw, write the page."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.app import DONE, Answer, show, tell
from pe_core.text import dump_json

from .again import differences
from .claims import claims
from .cli import FOLDER, QUICK_FOLDER
from .drawing import EXTRA, figures, has_matplotlib
from .effort import FULL, QUICK, Effort
from .ledger import RESULTS, Ledger
from .page import check_ours, write_page
from .problems import STUDIES
from .read import read_results
from .runner import Ended, run_all

UNLIKE = 1
"""Exit status when an ordering holds under none of the priors, or a figure came out otherwise."""


def reproduce(args: argparse.Namespace) -> Answer:
    """Run the verb."""
    if not STUDIES.is_dir():
        found = "none: the paper's studies come with a checkout, not with the installed engine"
        raise InputError(str(STUDIES), "folder", "study files of the experiments", found)
    folder = Path(args.output or (QUICK_FOLDER if args.quick else FOLDER))
    if args.check:
        return _checked(folder)
    folder = prepare_folder(folder)
    check_ours(folder)
    drawn = has_matplotlib()
    if not (drawn or args.json):
        figures()  # complains now, not after an hour
    data = _results(args, folder)
    write_page(data, folder)
    if drawn:
        figures().draw_all(data, folder)
    else:
        tell(f"no plots, for want of matplotlib: {EXTRA}")
    text = dump_json(data) if args.json else summary(data)
    return text, DONE if _like_the_paper(data) else UNLIKE


def _checked(folder: Path) -> Answer:
    """Compute again what needs no search, and say what came out otherwise."""
    data = read_results(folder / RESULTS)
    compared, unlike = differences(data, _tell)
    lines = [*unlike, f"{compared - len(unlike)} of {compared} scores and figures are equal"]
    return "\n".join(lines), UNLIKE if unlike else DONE


def _results(args: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Return complete results, those that are there or new ones."""
    if args.page_only:
        return read_results(folder / RESULTS)
    effort = QUICK if args.quick else FULL
    ledger = Ledger(folder, effort)
    if ledger.found:
        _tell(f"going on from {ledger.path}, which has {ledger.found} results")
    if ledger.aside:
        _tell(f"results of another run go to {ledger.aside}")
    try:
        run_all(effort, ledger, args.workers, _tell)
    except Ended as end:
        end.note = f"{ledger.path} keeps what is done, the same command goes on"
        raise
    return finish(ledger, effort)


def finish(ledger: Ledger, effort: Effort) -> dict[str, Any]:
    """Judge the orderings, and write the complete results."""
    judged = [claim.to_dict() for claim in claims(ledger.values, effort)]
    return ledger.save(claims=judged)


def summary(data: Mapping[str, Any]) -> str:
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


def _like_the_paper(data: Mapping[str, Any]) -> bool:
    """Whether every ordering holds under one of the priors at least."""
    held = {c["text"] for c in data["claims"] if c["holds"]}
    return held == {c["text"] for c in data["claims"]}


def _tell(line: str) -> None:
    """Say how far it is; whoever closed stderr is not told."""
    show(f"{line}\n", sys.stderr)

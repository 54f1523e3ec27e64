"""What ``pe validate`` does: score the published placements, correlate, draw, write the page."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.app import DONE, Answer, show, tell
from pe_core.text import dump_json, write_bytes

from ..cli import QUICK_VALIDITY_FOLDER, VALIDITY_FOLDER
from ..drawing import EXTRA, has_matplotlib, validity_figures
from ..ledger import RESULTS, Ledger
from ..page import PAGE, check_ours, put_together
from ..problems import STUDIES
from ..runner import Ended, run_all
from .effort import FULL, QUICK
from .facts import ValidityFacts
from .plan import plan
from .results import checked_results, judged, read_results
from .sections import SECTIONS
from .sections.head import TITLE
from .sections.one_test import signed

VERB = "pe validate"


def validate(args: argparse.Namespace) -> Answer:
    """Run the verb."""
    if not STUDIES.is_dir():
        found = "none: the sedan comes with a checkout, not with the installed engine"
        raise InputError(str(STUDIES), "folder", "study files of the experiments", found)
    folder = prepare_folder(
        args.output or (QUICK_VALIDITY_FOLDER if args.quick else VALIDITY_FOLDER)
    )
    check_ours(folder, TITLE, VERB)
    drawn = has_matplotlib()
    if not (drawn or args.json):
        validity_figures()  # complains now, not after the scores
    data = _results(args, folder)
    facts = ValidityFacts(data)
    page = put_together(section(facts) for section in SECTIONS)
    write_bytes(folder / PAGE, page.encode())
    if drawn:
        validity_figures().draw_all(data, folder)
    else:
        tell(f"no plots, for want of matplotlib: {EXTRA}")
    return dump_json(data) if args.json else summary(facts), DONE


def _results(args: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Return complete results, those that are there or new ones."""
    if args.page_only:
        return read_results(folder / RESULTS)
    effort = QUICK if args.quick else FULL
    ledger = Ledger(folder, effort, checked_results)
    if ledger.found:
        _tell(f"going on from {ledger.path}, which has {ledger.found} results")
    if ledger.aside:
        _tell(f"results of another run go to {ledger.aside}")
    try:
        run_all(effort, ledger, args.workers, _tell, plan)
    except Ended as end:
        end.note = f"{ledger.path} keeps what is done, the same command goes on"
        raise
    return ledger.save(**judged(ledger.values, effort))


def summary(facts: ValidityFacts) -> str:
    """Return the one test in a few lines, for people."""
    rows = facts.tested(facts.ways[0])
    return "\n".join(
        f"{row['score']:34} {' '.join(signed(v) for v in row['rho'])}  mean {signed(row['mean'])}"
        f"  p {row['p']:.3f}  after Holm {row['holm']:.3f}"
        for row in rows
    )


def _tell(line: str) -> None:
    """Say how far it is; whoever closed stderr is not told."""
    show(f"{line}\n", sys.stderr)

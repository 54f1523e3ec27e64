"""``python -m studies.detectors.second``: the missing runs of the second plan."""

from __future__ import annotations

import argparse
from pathlib import Path

from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer, count_up_to

from ...command import main, page_parser
from ...results_file import RESULTS, Json, print_progress
from ..runs import MAX_RUNS, Run, RunFiles, do_runs
from ..scores import placement_scores
from .analysis import second_analysis
from .plan import (
    EQUAL_M,
    GOOD,
    SECOND,
    full_second_plan,
    good_placements,
    quick_second_plan,
    second_runs,
)


def validate_second(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for; return how many are done."""
    plan = quick_second_plan() if args.quick else full_second_plan()
    files = RunFiles(prepare_folder(folder), plan.study, second_runs(plan))

    def result_of(run: Run) -> Json:
        from ..one_run import run_one  # TensorFlow is loaded when a run is missing

        return run_one(plan.study, run)

    do_runs(args, files, result_of)
    results, scores = files.read(), dict[str, Json]()
    if len(results) == len(files.all):
        rigs = [(placement, placement.rig()) for placement in good_placements(plan)]
        scores = placement_scores(plan.study, rigs, folder, print_progress)
    found = second_analysis(plan, results, scores)
    write_bytes(folder / RESULTS, dump_json(found).encode())
    return dump_json(found) if args.json else _summary(found), DONE


def _summary(found: Json) -> str:
    """Return what is done and what follows, for people."""
    lines = [f"{found['done']} of {found['planned']} runs are done"]
    for rows, row in ((found[EQUAL_M] or {}).get("minus_first") or {}).items():
        lines.append(f"{row['tie']:12} equal m ties: {rows} rows {row['mean']:+.3f} AP")
    for name, row in ((found[GOOD] or {}).get("figures") or {}).items():
        lines.append(f"{row['verdict']:12} {name} ranks among the good: rho {row['rho']:+.2f}")
    return "\n".join(lines)


if __name__ == "__main__":
    parser, _ = page_parser(
        "detectors.second",
        "train detectors at the placements of the second plan",
        (f"docs/validity/own/{SECOND}", "validity-second-quick"),
        "a few runs of few scenes, in minutes",
    )
    parser.add_argument("--resume", action="store_true", help="go on where the folder's runs end")
    about = "do at most so many runs now"
    parser.add_argument("--runs", type=count_up_to(MAX_RUNS), metavar="N", help=about)
    main(parser, validate_second)

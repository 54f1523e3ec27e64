"""``python -m studies.detectors.second``: the missing runs of the second plan."""

from __future__ import annotations

import argparse
from pathlib import Path

from pe_core.base import dump_json
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer, count_up_to

from ...command import main, page_parser
from ...results_file import Json
from ..runs import MAX_RUNS, Run, RunFiles, do_runs
from .plan import SECOND, full_second_plan, quick_second_plan, second_runs


def validate_second(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for; return how many are done."""
    plan = quick_second_plan() if args.quick else full_second_plan()
    files = RunFiles(prepare_folder(folder), plan.study, second_runs(plan))

    def result_of(run: Run) -> Json:
        from ..one_run import run_one  # TensorFlow is loaded when a run is missing

        return run_one(plan.study, run)

    do_runs(args, files, result_of)
    done, planned = len(files.read()), len(files.all)
    if args.json:
        return dump_json({"done": done, "planned": planned}), DONE
    return f"{done} of {planned} runs are done", DONE


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

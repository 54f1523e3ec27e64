"""``python -m studies.detectors.frames``: the missing runs, and the page of what they say."""

from __future__ import annotations

import argparse
from pathlib import Path

from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ...command import main, page_parser
from ...pages import PAGE, check_page, render
from ...results_file import RESULTS, Json, print_progress
from ..runs import Run, RunFiles, add_run_options, do_runs
from ..scores import placement_scores
from .analysis import frame_scorer, frames_analysis
from .plan import FRAMES, frames_placements, frames_runs, full_frames_plan, quick_frames_plan

TITLE = "# One frame and five, in motion"


def rank_over_frames(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for; write results.json and the page."""
    plan = quick_frames_plan() if args.quick else full_frames_plan()
    check_page(folder, TITLE, "detectors.frames")
    files = RunFiles(prepare_folder(folder), plan.study, frames_runs(plan))

    def result_of(run: Run) -> Json:
        from ..one_run import run_frames  # TensorFlow is loaded when a run is missing

        return run_frames(plan, run)

    do_runs(args, files, result_of)
    results, scores = files.read(), dict[str, Json]()
    if len(results) == len(files.all):
        rigs = [(placement, placement.rig()) for placement in frames_placements(plan)]
        scores = placement_scores(plan.study, rigs, folder, print_progress, frame_scorer(plan))
    found = frames_analysis(plan, results, scores)
    write_bytes(folder / RESULTS, dump_json(found).encode())
    page = render(Path(__file__).parent, {"plan": plan, "found": found, "title": TITLE})
    write_bytes(folder / PAGE, page.encode())
    return dump_json(found) if args.json else page, DONE


if __name__ == "__main__":
    parser, _ = page_parser(
        "detectors.frames",
        "train detectors with one frame and with five, on moving scenes",
        (f"docs/validity/own/{FRAMES}", "validity-frames-quick"),
        "a few runs of few scenes, in minutes",
    )
    add_run_options(parser)
    main(parser, rank_over_frames)

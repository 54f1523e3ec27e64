"""``python -m studies.detectors``: train detectors at the placements of the plan, write the page.

The study of LiDARs, that of cameras or that after a search: the missing runs, then the page of all.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pe_core as pe
from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import main, page_parser
from ..pages import PAGE, check_page
from ..results_file import RESULTS, Json, print_progress
from .after_search.analysis import after_search_analysis
from .after_search.plan import full_after_search_plan, quick_after_search_plan
from .after_search.searches import searched_placements
from .afterwards import afterwards
from .analysis import Results, analysis
from .cameras.analysis import camera_analysis
from .cameras.placements import camera_placements
from .cameras.plan import full_camera_plan, quick_camera_plan
from .curve_file import write_curves
from .findings import answer_after_search, short_answer
from .page import OWN, TITLE, Plans, Study, page
from .placements import Placement, placements
from .plan import AFTER_SEARCH, CAMERAS, StudyPlan, full_plan, quick_plan
from .runs import Run, RunFiles, add_run_options, do_runs, runs, seed_by_seed
from .scan_curves import scan_curves
from .scores import placement_scores
from .segmentation import segmentation_scores

FOLDER, QUICK_FOLDER = "docs/validity/own", "validity-own-quick"


def validate_own(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for, then draw the conclusions and write the page."""
    check_page(folder, TITLE, "detectors")
    folder = prepare_folder(folder)
    plans = _plans(args.quick)
    report = print_progress if args.after_search and not args.page_only else None
    searched = searched_placements(plans.searches, folder / AFTER_SEARCH, report)
    files = _files(plans, folder, searched)
    name = AFTER_SEARCH if args.after_search else CAMERAS if args.cameras else OWN
    do_runs(args, files[name], lambda run: _run(plans, name, run))
    study, scores = _study(plans, files, searched)
    if args.curves:
        write_curves(Path(args.curves), study.found["ap_curves"])
    outside = {} if args.quick else segmentation_scores(folder, print_progress)
    write_bytes(folder / PAGE, page(study, outside).encode())
    _draw(study, folder, scores)
    found = {OWN: study.found, CAMERAS: study.of_cameras, AFTER_SEARCH: study.searched}[name]
    return dump_json(found) if args.json else _summary(name, study), DONE


def _plans(quick: bool) -> Plans:
    if quick:
        return Plans(quick_plan(), quick_camera_plan(), quick_after_search_plan())
    return Plans(full_plan(), full_camera_plan(), full_after_search_plan())


def _files(plans: Plans, folder: Path, searched: list[Placement]) -> dict[str, RunFiles]:
    """Return the files of the runs of each study, by its folder."""
    cameras, searches = plans.cameras.study, plans.searches.study
    with_cameras = seed_by_seed(cameras, camera_placements(plans.cameras))
    return {
        OWN: RunFiles(folder, plans.own, runs(plans.own)),
        AFTER_SEARCH: RunFiles(folder / AFTER_SEARCH, searches, seed_by_seed(searches, searched)),
        CAMERAS: RunFiles(folder / CAMERAS, cameras, with_cameras),
    }


def _run(plans: Plans, name: str, run: Run) -> Json:
    from .one_run import run_camera, run_one  # TensorFlow is loaded when a run is missing

    if name == CAMERAS:
        return run_camera(plans.cameras, run)
    return run_one(plans.searches.study if name == AFTER_SEARCH else plans.own, run)


def _study(
    plans: Plans, files: dict[str, RunFiles], searched: list[Placement]
) -> tuple[Study, dict[str, Results]]:
    """Return what follows from the results of all runs, written to files, and the scores."""
    results = {name: each.read() for name, each in files.items()}
    if len(searched) == len(plans.searches.rigs):  # no search is done
        searched, results[AFTER_SEARCH] = [], {}
    tried = [r.placement for r in files[CAMERAS].all if r.name in results[CAMERAS]]
    with_cameras = [placement for placement in tried if placement is not None]
    scores: dict[str, Results] = {
        OWN: _scores(files[OWN], _scored(plans.own, results[OWN])),
        AFTER_SEARCH: _scores(files[AFTER_SEARCH], searched),
        CAMERAS: _scores(files[CAMERAS], with_cameras, plans.cameras.model),
    }
    cameras = camera_analysis(plans.cameras, results[CAMERAS], scores[CAMERAS])
    after = after_search_analysis(plans.searches, results[AFTER_SEARCH], scores[AFTER_SEARCH])
    found = analysis(plans.own, results[OWN], scores[OWN])
    found["ap_curves"] = scan_curves(plans.own, results[OWN])
    found["afterwards"] = afterwards(plans.own, results[OWN], scores[OWN], found["ap_curves"])
    found["answer"] = short_answer(plans.own, found, after, cameras)
    for name, conclusions in ((OWN, found), (AFTER_SEARCH, after), (CAMERAS, cameras)):
        if name == OWN or scores[name]:
            write_bytes(files[name].folder / RESULTS, dump_json(conclusions).encode())
    return Study(plans, found, cameras, after, results), scores


def _scores(
    files: RunFiles, chosen: list[Placement], model: pe.Camera | None = None
) -> dict[str, Json]:
    if not chosen:
        return {}
    rigs = [(placement, placement.rig(model)) for placement in chosen]
    return placement_scores(files.plan, rigs, files.folder, print_progress)


def _scored(plan: StudyPlan, results: Results) -> list[Placement]:
    """Return the placements that have a result."""
    named = {p for run in results.values() for p in run.get("placements", ())}
    tried = {run.placement.name for run in runs(plan) if run.placement and run.name in results}
    return [p for p in placements(plan) if p.name in named | tried]


def _draw(study: Study, folder: Path, scores: dict[str, Results]) -> None:
    from .study_plots import draw_all, draw_cameras

    draw_all(study, folder, scores[OWN])
    if study.runs[CAMERAS]:
        draw_cameras(study, folder / CAMERAS, scores[CAMERAS])


def _summary(name: str, study: Study) -> str:
    """Return what is done and what follows, for people."""
    if name == AFTER_SEARCH:
        found = study.searched
        done = f"{found['done']} of {found['planned']} runs before and after a search are done"
        return f"{done}\n{answer_after_search(found)}"
    if name == CAMERAS:
        found = study.of_cameras
        done = f"{found['done']} of {found['planned']} runs of cameras are done"
        return f"{done}\n{found['verdict']:12} The better-scored placement of cameras finds more"
    counts, rows = study.found["runs"], study.found["statements"]
    lines = [f"{row['verdict']:12} {row['statement']}" for row in rows]
    return "\n".join([f"{counts['done']} of {counts['planned']} runs are done", *lines])


if __name__ == "__main__":
    parser, _ = page_parser(
        "detectors",
        "train detectors at the placements of the plan",
        (FOLDER, QUICK_FOLDER),
        "a few runs of few scenes, in minutes",
    )
    which = parser.add_mutually_exclusive_group()
    about = "the study of camera placements instead of that of LiDARs"
    which.add_argument("--cameras", action="store_true", help=about)
    about = "the study before and after a search: its searches, unless they are done, and its runs"
    which.add_argument("--after-search", action="store_true", help=about)
    add_run_options(parser)
    about = 'write the curves of [ap] model = "scans", fitted to the runs, to this file'
    parser.add_argument("--curves", metavar="FILE", help=about)
    main(parser, validate_own)

"""``python -m studies.detectors``: train detectors at the placements of the plan, write the page.

The study of LiDARs, that of cameras or that after a search: the missing runs, then the page of all.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import main, page_parser
from ..pages import PAGE, check_page
from ..results_file import RESULTS, Json, print_progress
from .after_search import after_search_analysis, searched_placements
from .afterwards import afterwards, segmentation_scores
from .analysis import Results, analysis, camera_analysis
from .page import TITLE, Study, answer_after_search, page, short_answer
from .placements import Placement, camera_model, camera_placements, placements
from .plan import AFTER_SEARCH, CAMERAS, OWN, Plan, plans_of
from .runs import RunFiles, add_run_options, do_runs, runs, seed_by_seed
from .scan_curves import scan_curves, write_curves
from .scores import placement_scores

FOLDER = "docs/validity/own"
QUICK_FOLDER = "validity-own-quick"


def validate_own(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for, then draw the conclusions and write the page."""
    check_page(folder, TITLE, "detectors")
    folder = prepare_folder(folder)
    plans = plans_of(args.quick)
    report = print_progress if args.after_search and not args.page_only else None
    searched = searched_placements(plans[AFTER_SEARCH], folder / AFTER_SEARCH, report)
    planned = {
        OWN: runs(plans[OWN]),
        CAMERAS: seed_by_seed(plans[CAMERAS], camera_placements(plans[CAMERAS])),
        AFTER_SEARCH: seed_by_seed(plans[AFTER_SEARCH], searched),
    }
    files = {name: RunFiles(folder / name, plans[name], planned[name]) for name in plans}
    name = AFTER_SEARCH if args.after_search else CAMERAS if args.cameras else OWN
    do_runs(args, files[name])
    study, scores = _study(plans, files, searched)
    found = study.found[name]
    if args.curves:
        write_curves(Path(args.curves), study.found[OWN]["ap_curves"])
    outside = {} if args.quick else segmentation_scores(folder, print_progress)
    write_bytes(folder / PAGE, page(study, outside).encode())
    _draw(study, folder, scores)
    return dump_json(found) if args.json else _summary(name, found), DONE


def _study(
    plans: dict[str, Plan], files: dict[str, RunFiles], searched: list[Placement]
) -> tuple[Study, Mapping[str, Results]]:
    """Return what follows from the results of all runs, written to files, and the scores."""
    results = {name: each.read() for name, each in files.items()}
    if len(searched) == len(plans[AFTER_SEARCH].searches.rigs):  # no search is done
        searched = []
        results[AFTER_SEARCH] = {}
    tried = [r.placement for r in files[CAMERAS].all if r.name in results[CAMERAS]]
    chosen = {
        OWN: _tested(plans[OWN], results[OWN]),
        CAMERAS: [placement for placement in tried if placement is not None],
        AFTER_SEARCH: searched,
    }
    scores = {name: _scores(files[name], chosen[name]) for name in plans}
    own = plans[OWN]
    done = (results[OWN], scores[OWN])
    found = {
        OWN: analysis(own, *done),
        CAMERAS: camera_analysis(plans[CAMERAS], results[CAMERAS], scores[CAMERAS]),
        AFTER_SEARCH: after_search_analysis(
            plans[AFTER_SEARCH], results[AFTER_SEARCH], scores[AFTER_SEARCH]
        ),
    }
    curves = scan_curves(own, results[OWN])
    found[OWN] |= {"ap_curves": curves, "afterwards": afterwards(own, *done, curves)}
    found[OWN]["answer"] = short_answer(own, found[OWN], found[AFTER_SEARCH], found[CAMERAS])
    for name, conclusions in found.items():
        if name == OWN or scores[name]:
            write_bytes(files[name].folder / RESULTS, dump_json(conclusions).encode())
    return Study(plans, found, results), scores


def _scores(files: RunFiles, chosen: list[Placement]) -> dict[str, Json]:
    if not chosen:
        return {}
    plan = files.plan
    model = camera_model(plan.cameras.rig) if "cameras" in plan else None
    rigs = [(placement, placement.rig(model)) for placement in chosen]
    return placement_scores(plan, rigs, files.folder, print_progress)


def _tested(plan: Plan, results: Results) -> list[Placement]:
    """Return the placements that have a result."""
    named = {p for run in results.values() for p in run.get("placements", ())}
    tried = {run.placement.name for run in runs(plan) if run.placement and run.name in results}
    return [p for p in placements(plan) if p.name in named | tried]


def _draw(study: Study, folder: Path, scores: Mapping[str, Results]) -> None:
    from .study_plots import draw_all, draw_cameras

    draw_all(study, folder, scores[OWN])
    if study.runs[CAMERAS]:
        draw_cameras(study, folder / CAMERAS, scores[CAMERAS])


def _summary(name: str, found: Json) -> str:
    """Return what is done and what follows, for people."""
    counts = found.get("runs", found)
    done = f"{counts['done']} of {counts['planned']} runs"
    if name == AFTER_SEARCH:
        return f"{done} before and after a search are done\n{answer_after_search(found)}"
    if name == CAMERAS:
        better = "The better-scored placement of cameras finds more"
        return f"{done} of cameras are done\n{found['verdict']:12} {better}"
    lines = [f"{row['verdict']:12} {row['statement']}" for row in found["statements"]]
    return "\n".join([f"{done} are done", *lines])


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

"""``python -m studies.detectors``: train detectors at the placements of the plan, write the page.

The study of LiDARs, that of cameras or that after a search: the missing runs, then the page of all.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path

import pe_core as pe
from pe_core import InputError, prepare_folder
from pe_core.base import dump_json, write_bytes
from pe_tools.cli import DONE, Answer, count_up_to, noted_when_interrupted

from ..command import main, page_parser
from ..pages import PAGE, check_page
from ..results_file import RESULTS, Json, print_progress
from .after_search.analysis import after_search_analysis
from .after_search.plan import full_after_search_plan, quick_after_search_plan
from .after_search.searches import searched_placements
from .afterwards import afterwards, history
from .analysis import Results, analysis
from .cameras.analysis import camera_analysis
from .cameras.placements import camera_placements
from .cameras.plan import full_camera_plan, quick_camera_plan
from .curve_file import write_curves
from .findings import answer_after_search, short_answer
from .page import TITLE, Study, page
from .placements import Placement, placements
from .plan import AFTER_SEARCH, CAMERAS, StudyPlan, full_plan, quick_plan
from .runs import Run, RunFiles, runs, seed_by_seed
from .scan_curves import scan_curves
from .scores import placement_scores
from .segmentation import segmentation_scores

FOLDER, QUICK_FOLDER = "docs/validity/own", "validity-own-quick"
MAX_RUNS = 10_000


def validate_own(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for, then draw the conclusions and write the page."""
    check_page(folder, TITLE, "detectors")
    folder = prepare_folder(folder)
    plan = quick_plan() if args.quick else full_plan()
    cameras = quick_camera_plan() if args.quick else full_camera_plan()
    searches = quick_after_search_plan() if args.quick else full_after_search_plan()
    files = RunFiles(folder, plan, runs(plan))
    of_cameras = seed_by_seed(cameras.study, camera_placements(cameras))
    camera_files = RunFiles(folder / CAMERAS, cameras.study, of_cameras)
    report = print_progress if args.after_search and not args.page_only else None
    searched = searched_placements(searches, folder, report)
    after_runs = seed_by_seed(searches.study, searched)
    after_files = RunFiles(folder / AFTER_SEARCH, searches.study, after_runs)

    def run(run: Run) -> Json:
        from .one_run import run_camera, run_one  # TensorFlow is loaded when a run is missing

        if args.cameras:
            return run_camera(cameras, run)
        return run_one(searches.study if args.after_search else plan, run)

    own = after_files if args.after_search else camera_files if args.cameras else files
    do_runs(args, own, run)
    results, of_cameras_found = files.read(), camera_files.read()
    scores = _scores(files, _scored(plan, results))
    with_cameras = [p for r in camera_files.all if r.name in of_cameras_found if (p := r.placement)]
    camera_scores = _scores(camera_files, with_cameras, cameras.model)
    found_of_cameras = camera_analysis(cameras, of_cameras_found, camera_scores)
    if of_cameras_found:
        _write(camera_files.folder / RESULTS, found_of_cameras)
    done_after, after_scores = {}, {}
    is_searched = len(searched) > len(searches.rigs)
    if is_searched:
        done_after, after_scores = after_files.read(), _scores(after_files, searched)
    found_after = after_search_analysis(searches, done_after, after_scores)
    if is_searched:
        _write(after_files.folder / RESULTS, found_after)
    found = analysis(plan, results, scores) | {"ap_curves": scan_curves(plan, results)}
    found["afterwards"] = afterwards(plan, results, scores, found["ap_curves"])
    found["answer"] = short_answer(plan, found, found_after, found_of_cameras)
    groups = {".": results, AFTER_SEARCH: done_after, CAMERAS: of_cameras_found}
    found["history"] = history(folder, groups)
    _write(folder / RESULTS, found)
    if args.curves:
        write_curves(Path(args.curves), found["ap_curves"])
    study = Study(
        plan,
        cameras,
        searches,
        found,
        found_of_cameras,
        found_after,
        results,
        of_cameras_found,
        done_after,
    )
    outside = {} if args.quick else segmentation_scores(folder, print_progress)
    write_bytes(folder / PAGE, page(study, outside).encode())
    _draw(study, folder, scores, camera_scores)
    shown = found_after if args.after_search else found_of_cameras if args.cameras else found
    return dump_json(shown) if args.json else _summary(args, study), DONE


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


def _write(path: Path, found: Json) -> None:
    write_bytes(path, dump_json(found).encode())


def _draw(study: Study, folder: Path, scores: Results, camera_scores: Results) -> None:
    from .study_plots import draw_all, draw_cameras

    draw_all(study, folder, scores)
    if study.camera_runs:
        draw_cameras(study, folder / CAMERAS, camera_scores)


def _summary(args: argparse.Namespace, study: Study) -> str:
    """Return what is done and what follows, for people."""
    if args.after_search:
        found = study.searched
        done = f"{found['done']} of {found['planned']} runs before and after a search are done"
        return f"{done}\n{answer_after_search(found)}"
    if args.cameras:
        found = study.of_cameras
        done = f"{found['done']} of {found['planned']} runs of cameras are done"
        return f"{done}\n{found['verdict']:12} The better-scored placement of cameras finds more"
    counts, rows = study.found["runs"], study.found["statements"]
    lines = [f"{row['verdict']:12} {row['statement']}" for row in rows]
    return "\n".join([f"{counts['done']} of {counts['planned']} runs are done", *lines])


def do_runs(args: argparse.Namespace, files: RunFiles, result_of: Callable[[Run], Json]) -> None:
    """Do the missing runs of a plan, at most `args.runs` of them.

    Results that are there without `args.resume` are an `InputError`.
    """
    files.read()  # complains now, not after hours
    missing, total = files.missing(), len(files.all)
    done = total - len(missing)
    if args.page_only or args.runs == 0 or not missing:
        return
    if done and not args.resume:
        found = f"{done} of {total} runs; pass --resume to go on"
        raise InputError(files.folder, "folder", "a folder without results", found)
    note = f"{files.folder} keeps the finished runs; --resume goes on from them"
    with noted_when_interrupted(note):
        for run in missing[: args.runs]:
            data = result_of(run)
            files.write(run, data)
            done = total - len(files.missing())
            print_progress(f"[{done}/{total}] {run.name}  {_brief(data)}")


def _brief(data: Mapping[str, Json]) -> str:
    ap = f"AP {data['ap']:.3f}, " if "ap" in data else ""
    return f"{ap}{data['training']['epochs']} epochs, {data['seconds']:.0f} s"


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
    parser.add_argument("--resume", action="store_true", help="go on where the folder's runs end")
    about = "do at most so many runs now"
    parser.add_argument("--runs", type=count_up_to(MAX_RUNS), metavar="N", help=about)
    about = 'write the curves of [ap] model = "scans", fitted to the runs, to this file'
    parser.add_argument("--curves", metavar="FILE", help=about)
    main(parser, validate_own)

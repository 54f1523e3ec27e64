"""Our own study of LiDARs, of cameras or after a search: the missing runs, then the page."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.base import dump_json, write_bytes
from pe_tools.cli import DONE, Answer, noted_when_interrupted

from ..task_runner import print_progress
from ..wording import PAGE, check_page
from .after_search.plan import (
    AfterSearchPlan,
    full_after_search_plan,
    quick_after_search_plan,
)
from .after_search.searches import FOLDER as AFTER_SEARCH
from .after_search.searches import searched_placements
from .after_search.section import after_search_section, answer
from .after_search.study import AfterSearchFiles, after_search_analysis
from .afterwards import afterwards
from .afterwards_section import afterwards_section, short_answer
from .analysis import CAMERAS, analysis, designs_of
from .cameras.plan import CameraPlan, full_camera_plan, quick_camera_plan
from .cameras.section import PICTURES, SHOWN_SCENE, camera_section
from .cameras.study import CameraFiles, CameraRun, camera_analysis, design_of_cameras
from .curve_section import PLOT as CURVE_PLOT
from .curve_section import curve_section, write_curves
from .history import history, history_section
from .placements import Placement, placements
from .plan import StudyPlan, full_plan, quick_plan
from .result_files import R, ResultFiles
from .runs import Run, RunFiles, runs
from .scan_curves import scan_curves
from .scores import placement_scores
from .segmentation import section, segmentation_scores
from .study_page import TITLE, page, pairs_plot_name, plot_name

CONCLUSIONS = "results.json"
"""What follows from the runs."""


def validate_own(args: argparse.Namespace, folder: Path) -> Answer:
    """Run the verb."""
    check_page(folder, TITLE, "python -m studies.detectors")
    folder = prepare_folder(folder)
    plan, of_cameras = (
        (quick_plan(), quick_camera_plan()) if args.quick else (full_plan(), full_camera_plan())
    )
    after_search = quick_after_search_plan() if args.quick else full_after_search_plan()
    files, camera_files = RunFiles(folder, plan), CameraFiles(folder, of_cameras)
    if args.after_search:
        _do_after_search(args, after_search, folder)
    elif args.cameras:
        do_runs(args, camera_files, lambda run: _camera_run(of_cameras, run))
    else:
        do_runs(args, files, lambda run: _run(plan, run))
    results = files.read()
    cameras, section_of_cameras = _of_cameras(of_cameras, camera_files)
    searched, done_after, section_of_searches = _of_searches(after_search, folder)
    rigs = [(p, p.rig(plan)) for p in _scored(plan, results)]
    scores = placement_scores(plan, rigs, folder, print_progress)
    outside = "" if args.quick else _from_outside(plan, folder)
    found = analysis(plan, results, scores) | {"ap_curves": scan_curves(plan, results)}
    found["afterwards"] = afterwards(plan, results, scores, found["ap_curves"])
    found["answer"] = short_answer(plan, found, searched, cameras)
    groups = {".": results, AFTER_SEARCH: done_after, CAMERAS: camera_files.read()}
    found["history"] = history(folder, groups)
    write_bytes(folder / CONCLUSIONS, dump_json(found).encode())
    if args.curves:
        write_curves(Path(args.curves), found["ap_curves"])
    curves = curve_section(found["ap_curves"])
    more = (
        *(afterwards_section(found), curves, section_of_searches, section_of_cameras, outside),
        history_section(found["history"]),
    )
    text = page(plan, found, results, *more)
    write_bytes(folder / PAGE, text.encode())
    _draw(plan, results, scores, folder)
    _draw_curves(found["ap_curves"], folder)
    _draw_cameras(of_cameras, camera_files)
    if args.after_search:
        return dump_json(searched) if args.json else _after_search_summary(searched), DONE
    if args.json:
        return dump_json(cameras if args.cameras else found), DONE
    return _camera_summary(of_cameras, cameras) if args.cameras else _summary(found), DONE


def _do_after_search(args: argparse.Namespace, plan: AfterSearchPlan, folder: Path) -> None:
    """Do the searches that are missing, then the missing runs."""
    report = None if args.page_only else print_progress
    files = AfterSearchFiles(folder, plan, searched_placements(plan, folder, report))
    do_runs(args, files, lambda run: _run(plan.study, run))


def _run(plan: StudyPlan, run: Run) -> dict[str, Any]:
    from .one_run import run_one  # TensorFlow is loaded when a run is missing

    return run_one(plan, run)


def _camera_run(plan: CameraPlan, run: CameraRun) -> dict[str, Any]:
    from .cameras.one_run import run_camera

    return run_camera(plan, run)


def _of_searches(
    plan: AfterSearchPlan, folder: Path
) -> tuple[Mapping[str, Any], dict[str, Any], str]:
    """Return what the runs before and after the searches say, them, and their section."""
    placements = searched_placements(plan, folder)
    files = AfterSearchFiles(folder, plan, placements)
    if len(placements) == len(plan.rigs):  # no search is done
        return after_search_analysis(plan, {}, {}), {}, ""
    results, rigs = files.read(), [(p, p.rig(plan.study)) for p in placements]
    scores = placement_scores(plan.study, rigs, files.folder, print_progress)
    found = after_search_analysis(plan, results, scores)
    write_bytes(files.folder / CONCLUSIONS, dump_json(found).encode())
    return found, results, after_search_section(plan, found, results)


def _of_cameras(plan: CameraPlan, files: CameraFiles) -> tuple[Mapping[str, Any], str]:
    """Return what the runs of the cameras say, and its section of the page."""
    results = files.read()
    found = camera_analysis(plan, results, _camera_scores(plan, files, results))
    if results:
        write_bytes(files.folder / CONCLUSIONS, dump_json(found).encode())
    return found, camera_section(plan, found, results)


def _camera_scores(
    plan: CameraPlan, files: CameraFiles, results: Mapping[str, Any]
) -> dict[str, Any]:
    rigs = [(r.placement, r.placement.rig_of(plan.model)) for r in files.all if r.name in results]
    return placement_scores(plan.study, rigs, files.folder, print_progress) if rigs else {}


def _from_outside(plan: StudyPlan, folder: Path) -> str:
    scores = segmentation_scores(folder, print_progress)
    return section(scores, plan.statistics, plan.seed)


def _scored(plan: StudyPlan, results: Mapping[str, Any]) -> list[Placement]:
    """Return the placements that have a result."""
    named = {p for run in results.values() for p in run.get("placements", ())}
    tried = {run.placement.name for run in runs(plan) if run.placement and run.name in results}
    return [p for p in placements(plan) if p.name in named | tried]


def _draw(
    plan: StudyPlan, results: Mapping[str, Any], scores: Mapping[str, Any], folder: Path
) -> None:
    from .study_plots import ap_against_scores, pairs_by_distance

    for design in designs_of(plan, results):
        if design.has_figures:
            ap_against_scores(folder / plot_name(design.name), plan, design, scores)
            pairs_by_distance(folder / pairs_plot_name(design.name), design, scores)


def _draw_curves(found: Mapping[str, Any], folder: Path) -> None:
    from .study_plots import expected_against_found

    if found["classes"]:
        expected_against_found(folder / CURVE_PLOT, found["classes"])


def _draw_cameras(plan: CameraPlan, files: CameraFiles) -> None:
    from .cameras.rendering import Renderer
    from .study_plots import ap_against_scores, pictures_of_scene

    results = files.read()
    if not results:
        return
    scene = Renderer(plan, files.all[0].placement).pictures(*SHOWN_SCENE)
    pictures_of_scene(files.folder / PICTURES, scene.pictures)
    if (design := design_of_cameras(plan, results)).has_figures:
        scores = _camera_scores(plan, files, results)
        ap_against_scores(files.folder / plot_name(CAMERAS), plan.study, design, scores)


def _summary(found: Mapping[str, Any]) -> str:
    """Return the statements and their verdicts, for people."""
    done, planned = found["runs"]["done"], found["runs"]["planned"]
    lines = [f"{row['verdict']:12} {row['statement']}" for row in found["statements"]]
    return "\n".join([f"{done} of {planned} runs are done", *lines])


def _camera_summary(plan: CameraPlan, found: Mapping[str, Any]) -> str:
    return (
        f"{found['done']} of {found['planned']} runs of cameras are done\n"
        f"{found['verdict']:12} The better-scored placement of cameras finds more "
        f"({plan.study.statistics.primary})"
    )


def _after_search_summary(found: Mapping[str, Any]) -> str:
    done = f"{found['done']} of {found['planned']} runs before and after a search are done"
    return f"{done}\n{answer(dict(found))}"


def do_runs(
    args: argparse.Namespace,
    files: ResultFiles[R],
    result_of: Callable[[R], dict[str, Any]],
) -> None:
    """Do the missing runs of a plan, at most `args.runs` of them.

    Parameters
    ----------
    args : Namespace
    files : ResultFiles
    result_of : callable
        Returns the result of a run.

    Raises
    ------
    InputError
        When there are results and `args.resume` is not set.
    """
    files.read()  # complains now, not after hours
    missing = files.missing()
    total = len(files.all)
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


def _brief(data: dict[str, Any]) -> str:
    training = data["training"]
    ap = f"AP {data['ap']:.3f}, " if "ap" in data else ""
    return f"{ap}{training['epochs']} epochs, {data['seconds']:.0f} s"

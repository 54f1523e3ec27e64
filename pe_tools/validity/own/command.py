"""``pe validate --own``: do the runs that are missing, then write the page."""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.base import dump_json, write_bytes
from pe_core.base.plugins import install_hint, required_plugin

from ...cli import DONE, Answer, noted_when_interrupted, tell
from ...reproduction.plotting import EXTRA, has_matplotlib
from ...reproduction.task_runner import print_progress
from ...reproduction.wording import PAGE, check_page
from .analysis import analysis, designs_of
from .placements import Placement, placements
from .plan import StudyPlan, full_plan, quick_plan
from .runs import RunFiles, runs
from .scores import placement_scores
from .segmentation import section, segmentation_scores
from .study_page import TITLE, page, pairs_plot_name, plot_name

CONCLUSIONS = "results.json"
"""What follows from the runs."""
CAST = "cast"
"""Folder of the scenes that were cast; it may be deleted."""
ONE_THREAD = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
"""JAX computes with one thread, so that results do not depend on the machine's processors."""


def validate_own(args: argparse.Namespace, folder: Path) -> Answer:
    """Run the verb."""
    check_page(folder, TITLE, "pe validate --own")
    files = do_runs(args, folder)
    plan, results = files.plan, files.read()
    scores = placement_scores(plan, _scored(plan, results), folder, print_progress)
    outside = "" if args.quick else _from_outside(plan, folder)
    found = analysis(plan, results, scores)
    write_bytes(folder / CONCLUSIONS, dump_json(found).encode())
    write_bytes(folder / PAGE, page(plan, found, results, outside).encode())
    if has_matplotlib():
        _draw(plan, results, scores, folder)
    else:
        tell(f"no plots, as matplotlib is missing: {EXTRA}")
    return dump_json(found) if args.json else _summary(found), DONE


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


def _summary(found: Mapping[str, Any]) -> str:
    """Return the statements and their verdicts, for people."""
    done, planned = found["runs"]["done"], found["runs"]["planned"]
    lines = [f"{row['verdict']:12} {row['statement']}" for row in found["statements"]]
    return "\n".join([f"{done} of {planned} runs are done", *lines])


def do_runs(args: argparse.Namespace, folder: Path) -> RunFiles:
    """Do the missing runs of the plan, at most `args.runs` of them; return the files of all.

    Raises
    ------
    InputError
        When there are results and `args.resume` is not set, or JAX is not installed.
    """
    plan = quick_plan() if args.quick else full_plan()
    folder = prepare_folder(folder)
    files = RunFiles(folder, plan)
    files.read()  # complains now, not after hours
    missing = files.missing()
    done = len(files.all) - len(missing)
    if args.page_only or not missing:
        return files
    if done and not args.resume:
        found = f"{done} of {len(files.all)} runs; pass --resume to go on"
        raise InputError(folder, "folder", "a folder without results", found)
    run_one = _run_one()
    note = f"{folder} keeps the finished runs; --resume goes on from them"
    with noted_when_interrupted(note):
        for run in missing[: args.runs]:
            data = run_one(plan, run, folder / CAST)
            files.write(run, data)
            done += 1
            print_progress(f"[{done}/{len(files.all)}] {run.name}  {_brief(data)}")
    return files


def _run_one() -> Any:
    """Return the function that needs JAX, or raise `InputError` that says how to install it."""
    os.environ.setdefault("XLA_FLAGS", ONE_THREAD)
    hint = install_hint("library", "detector")
    return required_plugin("library", "detector", "validate", "--own", hint)[1]


def _brief(data: dict[str, Any]) -> str:
    training = data["training"]
    ap = f"AP {data['ap']:.3f}, " if "ap" in data else ""
    return f"{ap}{training['epochs']} epochs, {data['seconds']:.0f} s"

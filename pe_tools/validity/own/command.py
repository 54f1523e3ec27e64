"""``pe validate --own``: do the runs that are missing, then write the page."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.base.plugins import install_hint, required_plugin

from ...cli import DONE, Answer, noted_when_interrupted
from ...reproduction.task_runner import print_progress
from .plan import full_plan, quick_plan
from .runs import RunFiles

CAST = "cast"
"""Folder of the scenes that were cast; it may be deleted."""
ONE_THREAD = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
"""JAX computes with one thread, so that results do not depend on the machine's processors."""


def validate_own(args: argparse.Namespace, folder: Path) -> Answer:
    """Run the verb."""
    files = do_runs(args, folder)
    return f"{len(files.all) - len(files.missing())} of {len(files.all)} runs are done", DONE


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

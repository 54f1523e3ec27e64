"""The command ``pe``: score and optimize study files without Blender."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points

from ..study.jobs import Job, OptimizeJob, ScoreJob
from ..study.results import prepare_folder, result_dict, write_outcome
from ..study.study_file import load_study
from ..version import __version__
from .command import Answer, add_run_options, add_sensors_verb, answer, drive, run, with_options

VERBS = "pe_core.verbs"
"""Packages built on the engine add verbs by entry points of this group: functions that take the
parser's verbs."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status: 0, 1 bad input, 2 usage, 130 interrupted."""
    args = parser().parse_args(argv)
    return run(lambda: args.function(args))


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    top = argparse.ArgumentParser(prog="pe", description="Perception entropy of vehicle sensors.")
    top.add_argument("--version", action="version", version=f"pe {__version__}")
    verbs = top.add_subparsers(required=True, metavar="VERB")
    score = verbs.add_parser("score", help="score a study's rig")
    optimize = verbs.add_parser("optimize", help="search for a better placement")
    for verb, job in ((score, ScoreJob), (optimize, OptimizeJob)):
        verb.add_argument("study", metavar="STUDY", help="study file (TOML)")
        add_run_options(verb, search=job is OptimizeJob)
        verb.set_defaults(function=_run_job, job=job)
    add_sensors_verb(verbs)
    for other in entry_points(group=VERBS):
        other.load()(verbs)
    return top


def _run_job(args: argparse.Namespace) -> Answer:
    study = with_options(load_study(args.study), args)
    if (report := study.prior.report(study.space)) is not None:
        print(f"pe: {report}", file=sys.stderr)
    output = None if args.output is None else prepare_folder(args.output)
    job: Job = args.job(study, args.workers)
    outcome = drive(job, output)
    data = result_dict(outcome) if output is None else write_outcome(outcome, output)
    return answer(outcome, data, as_json=args.json)

"""The command ``pe``: score and optimize study files without Blender."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.plugins import call_plugin, find_plugins, load_plugin, plugin_name
from pe_core.search.payload import keep_freed_memory
from pe_core.study import STUDY, Study, load_study
from pe_core.version import __version__

from ..jobs import OptimizeJob, ScoreJob, front_study, prepare_folder, result_names
from .check_verb import add_check_options, add_requirements_verb, check
from .choose_verb import choose, front_job, has_front, resumed
from .command import Parser, add_run_options, add_sensors_verb, as_typed, run, with_options
from .exchange_verbs import (
    add_export_options,
    add_import_options,
    add_rigs_verb,
    export,
    import_study,
)
from .explain_verbs import add_compare_options, add_explain_options, compare, explain, named_by_file
from .new_verb import add_new_verb
from .run_job import add_page_option, begun_search, carry_out, job_and_folder, with_pages
from .setup_verbs import add_setup_verbs
from .sweep_verb import add_sweep_options, sweep
from .terminal import Answer, open_missing_streams, tell


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status.

    0: done; 1: bad input, or results in a fallback folder; 2: usage; 3: a requirement is not met;
    128 plus the number of a signal.
    """
    open_missing_streams()
    keep_freed_memory()

    def work() -> Answer:
        given = sys.argv[1:] if argv is None else argv
        args = parser().parse_args(given)
        args.command_line = as_typed("pe", given)
        answer: Answer = args.function(args)
        return answer

    return run(work)


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    top: argparse.ArgumentParser = Parser(
        prog="pe", description="Perception entropy of vehicle sensors."
    )
    top.add_argument("--version", action="version", version=f"pe {__version__}")
    verbs = top.add_subparsers(required=True, metavar="VERB")
    score = verbs.add_parser("score", help="score a study's rig")
    optimize = verbs.add_parser("optimize", help="search for a better placement")
    for verb, job in ((score, ScoreJob), (optimize, OptimizeJob)):
        search = job is OptimizeJob
        needed = "?" if search else None
        verb.add_argument("study", metavar="STUDY", nargs=needed, help="study file (TOML)")
        add_run_options(verb, search=search)
        verb.set_defaults(
            function=_run_job, job=job, kind=verb.prog.split()[-1], usage_error=verb.error
        )
    verb = verbs.add_parser("explain", help="a study's score in words, or one place of it")
    verb.usage = f"{verb.prog} STUDY [--at X Y [Z]] [options]"
    verb.add_argument("study", metavar="STUDY", help="study file (TOML)")
    add_explain_options(verb)
    verb.set_defaults(function=_explain)
    verb = verbs.add_parser("check", help="hold a study to its requirements; 3: some are not met")
    verb.add_argument("study", metavar="STUDY", help="study file (TOML)")
    add_check_options(verb)
    verb.set_defaults(function=_check)
    verb = verbs.add_parser("compare", help="score several studies and put them side by side")
    verb.add_argument("studies", nargs="+", metavar="STUDY", help="study file (TOML)")
    add_compare_options(verb)
    verb.set_defaults(function=_compare)
    verb = verbs.add_parser("export", help="write a study's rig for another program")
    verb.add_argument("study", metavar="STUDY", help="study file (TOML)")
    add_export_options(verb)
    verb.set_defaults(function=_export)
    verb = verbs.add_parser("import", help="make a study of another program's rig")
    add_import_options(verb)
    verb.set_defaults(function=import_study)
    verb = verbs.add_parser("sweep", help="run many studies, or one with many changes")
    verb.usage = f"{verb.prog} STUDY... [--set KEY=VALUE,...]... -o DIR [options]"
    verb.add_argument("studies", nargs="+", metavar="STUDY", help="study file (TOML)")
    add_sweep_options(verb)
    verb.set_defaults(function=_sweep)
    add_sensors_verb(verbs)
    add_rigs_verb(verbs)
    add_requirements_verb(verbs)
    add_new_verb(verbs)
    add_setup_verbs(verbs, parser)
    for plugin in find_plugins("verb"):
        _add_plugin_verbs(plugin, verbs)
    add_page_option(optimize)
    return top


def _add_plugin_verbs(point: EntryPoint, verbs: Any) -> None:
    """Add the verbs of a plugin, a function that takes the parser's verbs.

    A plugin that fails is reported by name; all other verbs work.
    """
    try:
        call_plugin(point, load_plugin(point), verbs)
    except ImportError as error:
        found = " ".join(str(error).split())
        tell(
            f"{plugin_name(point)}: expected what it imports, found {found}; its verbs are missing"
        )
    except InputError as error:
        tell(f"{error}; its verbs are missing")


def _run_job(args: argparse.Namespace) -> Answer:
    given = load_study(args.study) if args.study is not None else _front_begun(args)
    given = None if given is None else with_options(given, args)
    if given is not None and args.kind == "optimize" and has_front(given):
        return _choose(given, args)
    begun = begun_search(args)
    if given is None and begun is None:
        args.usage_error("expected STUDY, or --resume DIR")
    study = given if given is not None or begun is None else with_options(begun.study, args)
    assert study is not None
    (job, output), more = job_and_folder(study, args, begun), with_pages(args)
    if output is not None:
        if args.study is not None:
            _refuse_to_replace(Path(args.study), Path(output))
        more_names = more.names if more else ()
        prepare_folder(output, [*result_names(study, args.kind), *more_names])
    _print_boxes(study)
    folder = None if output is None else Path(output)
    scheduler = getattr(args, "scheduler", None)
    return carry_out(job, folder, as_json=args.json, more=more, scheduler=scheduler)


def _front_begun(args: argparse.Namespace) -> Study | None:
    """Return the study of the front that ``--resume`` names; None without one."""
    folder = getattr(args, "resume", None)
    return None if folder is None else front_study(folder)


def _choose(study: Study, args: argparse.Namespace) -> Answer:
    """Search for sensors and poses; write the Pareto front to the folder of results."""
    job = front_job(study, args.workers)
    folder = resumed(job, args)
    _print_boxes(study)
    output = None if folder is None else Path(folder)
    return choose(job, output, as_json=args.json, scheduler=args.scheduler)


def _print_boxes(study: Study) -> None:
    if (report := study.prior.report(study.space)) is not None:
        tell(str(report))


def _explain(args: argparse.Namespace) -> Answer:
    return explain(with_options(load_study(args.study), args), args)


def _check(args: argparse.Namespace) -> Answer:
    return check(args.study, args)


def _export(args: argparse.Namespace) -> Answer:
    return export(load_study(args.study), args)


def _compare(args: argparse.Namespace) -> Answer:
    files = named_by_file(args.studies)
    studies = {name: with_options(load_study(path), args) for name, path in files.items()}
    return compare(studies, args)


def _sweep(args: argparse.Namespace) -> Answer:
    return sweep(named_by_file(args.studies), args)


def _refuse_to_replace(study: Path, output: Path) -> None:
    """Raise `InputError` when the results would replace the study that is read."""
    try:
        same = (output / STUDY).samefile(study)
    except (OSError, ValueError):
        return
    if same:
        expected = "another folder than the study's folder"
        raise InputError(
            study, "output", expected, f"the study's folder: {STUDY} would be overwritten"
        )

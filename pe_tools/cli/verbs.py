"""The command ``pe``: its verbs, and what each does with study files, without Blender."""

import argparse
import platform
import sys
from collections.abc import Callable, Sequence
from functools import partial
from importlib.metadata import EntryPoint
from typing import Any, NamedTuple

import numpy as np

from pe_core.base.errors import InputError
from pe_core.base.plugins import call_plugin, find_plugins, load_plugin, plugin_name
from pe_core.search.payload import keep_freed_memory
from pe_core.study import Study, load_study
from pe_core.version import __version__

from ..jobs import read_search
from . import exchange_verbs, run_job
from .check_verb import add_check_options, add_requirements_verb, check
from .command import (
    Parser,
    add_curves_verb,
    add_run_options,
    add_sensors_verb,
    as_typed,
    run,
    with_options,
)
from .drive_by_verb import add_list_option, drive_by
from .explain_verbs import add_compare_options, add_explain_options, compare, explain, named_by_file
from .new_verb import add_new_verb
from .set_verb import add_set_options, set_keys
from .sweep_verb import add_sweep_options, sweep
from .terminal import Answer, open_missing_streams, tell
from .where_verb import add_where_options, where

ONE, PERHAPS, SOME = "one", "?", "+"  # How many study files a verb takes
GROUPS = {
    "begin": "new set import rigs sensors curves requirements",
    "score": "score explain check compare drive-by",
    "place": "where optimize sweep fit",
    "show": "review export",
}  # Verbs by their groups in the help; what is in none of them is listed last


class _InGroups(argparse.HelpFormatter):
    """Help with the verbs in groups."""

    def _iter_indented_subactions(self, action: argparse.Action) -> Any:
        verbs = {verb.dest: verb for verb in getattr(action, "_choices_actions", ())}
        rest = [name for name in verbs if name not in " ".join(GROUPS.values()).split()]
        for title, names in {**GROUPS, "more": " ".join(rest)}.items():
            if found := [verbs[name] for name in names.split() if name in verbs]:
                yield argparse.Action([], "", metavar=title)
                self._indent()
                yield from found
                self._dedent()


class Verb(NamedTuple):
    """A verb of study files."""

    name: str
    about: str
    add_options: Callable[[argparse.ArgumentParser], None]
    studies: str
    function: Callable[[argparse.Namespace], Answer]
    usage: str = ""

    def add(self, verbs: Any) -> None:
        """Add the verb to the parser of the command."""
        verb = verbs.add_parser(self.name, help=self.about)
        verb.usage = f"{verb.prog} {self.usage}" if self.usage else None
        if self.studies:
            name = "studies" if self.studies == SOME else "study"
            count = None if self.studies == ONE else self.studies
            verb.add_argument(name, nargs=count, metavar="STUDY", help="study file (TOML)")
        self.add_options(verb)
        verb.set_defaults(function=self.function, kind=self.name, usage_error=verb.error)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status. 0: done; 1: bad input, or results that cannot be
    written; 2: usage; 3: a requirement is not met; 128 plus the number of a signal."""
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
        prog="pe",
        description="Perception entropy of vehicle sensors.",
        formatter_class=_InGroups,
        epilog="Manual: docs/index.md of the source.",
    )
    about = f"pe {__version__}, NumPy {np.__version__}, Python {platform.python_version()}"
    about += f", {platform.platform()}"
    top.add_argument("--version", action="version", version=about)
    verbs = top.add_subparsers(required=True, metavar="VERB")
    for verb in VERBS:
        verb.add(verbs)
    add_sensors_verb(verbs)
    add_curves_verb(verbs)
    exchange_verbs.add_rigs_verb(verbs)
    add_requirements_verb(verbs)
    add_new_verb(verbs)
    for plugin in find_plugins("verb"):
        _add_plugin_verbs(plugin, verbs)
    run_job.add_page_option(verbs.choices["optimize"])
    return top


def _add_plugin_verbs(point: EntryPoint, verbs: Any) -> None:
    """Add the verbs of a plugin, a function that takes the parser's verbs. A plugin that fails is
    reported by name; all other verbs work."""
    try:
        call_plugin(point, load_plugin(point), verbs)
    except ImportError as error:
        found = " ".join(str(error).split())
        tell(
            f"{plugin_name(point)}: expected what it imports, found {found}; its verbs are missing"
        )
    except InputError as error:
        tell(f"{error}; its verbs are missing")


def _study(path: str, args: argparse.Namespace) -> Study:
    """Read a study, with the changes of the options; what they do not find in it names its file."""
    study = load_study(path, starts_anywhere=getattr(args, "snap", False))
    try:
        return with_options(study, args)
    except InputError as error:
        if error.source != "study":
            raise
        raise InputError(path, error.field, error.expected, error.found) from None


def _run_job(args: argparse.Namespace) -> Answer:
    resume = getattr(args, "resume", None)
    if args.study is not None:
        study = _study(args.study, args)
    elif resume is not None:
        study = with_options(read_search(resume).study, args)
    else:
        args.usage_error("expected STUDY, or --resume DIR")
    return run_job.run_study(study, args)


_add_search_options = partial(add_run_options, search=True)
VERBS = (
    Verb("score", "score a study's rig", partial(add_run_options, search=False), ONE, _run_job),
    Verb("optimize", "search for a better placement", _add_search_options, PERHAPS, _run_job),
    Verb(
        "explain",
        "a study's score in words, or one place of it",
        add_explain_options,
        ONE,
        lambda args: explain(_study(args.study, args), args),
        "STUDY [--at X Y [Z]] [options]",
    ),
    Verb(
        "check",
        "hold a study to its requirements; 3: some are not met",
        add_check_options,
        ONE,
        check,
    ),
    Verb(
        "where",
        "score one more sensor all over the vehicle's surface",
        add_where_options,
        ONE,
        lambda args: where(load_study(args.study), args),
    ),
    Verb(
        "drive-by",
        "when tracks of what moves are confirmed; 3: some too late",
        add_list_option,
        PERHAPS,
        drive_by,
    ),
    Verb(
        "compare",
        "score several studies and put them side by side",
        add_compare_options,
        SOME,
        lambda args: compare(
            {name: _study(path, args) for name, path in named_by_file(args.studies).items()}, args
        ),
    ),
    Verb(
        "export",
        "write a study's rig for another program",
        exchange_verbs.add_export_options,
        ONE,
        lambda args: exchange_verbs.export(load_study(args.study), args),
    ),
    Verb(
        "import",
        "make a study of another program's rig",
        exchange_verbs.add_import_options,
        "",
        exchange_verbs.import_study,
    ),
    Verb("set", "change keys of a study file; its comments stay", add_set_options, ONE, set_keys),
    Verb(
        "sweep",
        "run many studies, or one with many changes",
        add_sweep_options,
        SOME,
        lambda args: sweep(named_by_file(args.studies), args),
        "STUDY... [--set KEY=VALUE,...]... -o DIR [options]",
    ),
)

"""What the commands of the studies share: options, exit status, signals."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from pe_core import InputError
from pe_core.base.input_files import not_noting_inputs
from pe_tools.cli import Answer, Parser, leave, run, whole

MAX_WORKERS = 1024


def page_parser(
    name: str, about: str, folders: tuple[str, str], quick: str
) -> tuple[argparse.ArgumentParser, argparse._MutuallyExclusiveGroup]:
    """Return the parser of a study, and the group of what it can do instead of a full run.

    `folders` are those of a full and of a quick run by default; `quick` says what the latter does.
    """
    parser = Parser(prog=f"python -m studies.{name}", description=about)
    about = f"folder for page, plots and results.json (default {folders[0]}, or {folders[1]})"
    parser.add_argument("-o", "--output", metavar="DIR", help=about)
    parser.set_defaults(default_folders=folders)
    parser.add_argument("--quick", action="store_true", help=quick)
    alternatives = parser.add_mutually_exclusive_group()
    about = "write page and plots from the results that the folder has"
    alternatives.add_argument("--page-only", action="store_true", help=about)
    parser.add_argument("--json", action="store_true", help="print results.json on stdout")
    about = "number of processes (default and maximum: one per processor)"
    parser.add_argument("--workers", type=whole(MAX_WORKERS), metavar="N", help=about)
    return parser, alternatives


def logs_parser(name: str, about: str, folder: str) -> argparse.ArgumentParser:
    """Return the parser of a study of logs, whose page is in a folder by default."""
    parser = Parser(prog=f"python -m studies.{name}", description=about)
    about = "a folder of logs, each in a folder; without it the page is written from results.json"
    parser.add_argument("logs", metavar="FOLDER", nargs="?", help=about)
    about = f"folder for page and results.json (default {folder})"
    parser.add_argument("-o", "--output", metavar="DIR", help=about)
    parser.add_argument("--json", action="store_true", help="print results.json on stdout")
    parser.set_defaults(default_folders=(folder,), quick=False)
    return parser


def main(
    parser: argparse.ArgumentParser, study: Callable[[argparse.Namespace, Path], Answer]
) -> NoReturn:
    """Run a study with the options of the command line, and exit with its status."""
    args = parser.parse_args()
    folder = Path(args.output or args.default_folders[args.quick])

    def answer() -> Answer:
        try:
            with not_noting_inputs():  # a study reads results of its own to go on from them
                return study(args, folder)
        except ImportError as error:
            hint = "pip install -e '.[studies]'"
            found = " ".join(str(error).split())
            raise InputError("studies", "package", hint, found) from error

    leave(run(answer))

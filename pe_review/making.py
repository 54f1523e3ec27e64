"""The verb ``review``, and the page beside a search's results."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from .about import About
from .engine import app, pe, studies
from .folder import command_of_folder, outcome_of_folder
from .page import PAGE, page_bytes, write_page
from .reviewed import MOST_STUDIES, Reviewed

NOTHING_WRITTEN = "no page was written"
TOLD = ("perception-entropy", "numpy", "python")
"""Programs that the page tells the versions of by itself."""


def review(args: argparse.Namespace) -> app.Answer:
    """Score studies and write their page; Ctrl-C ends it, and then nothing is written."""
    with app.noted_when_interrupted(NOTHING_WRITTEN):
        return _review(args)


def _review(args: argparse.Namespace) -> app.Answer:
    paths = [str(Path(each).resolve()) if Path(each).is_dir() else each for each in args.studies]
    files = app.named_by_file(paths)
    _check(len(files), args)
    read = {name: _study(path) for name, path in files.items()}
    changed = {name: app.with_options(study, args) for name, study in read.items()}
    app.refuse_different(changed)
    each = []
    for name, study in changed.items():
        outcome = _searched(files[name], args) or app.scored(study, args.workers)
        searched = outcome.kind == "optimize"
        command = command_of_folder(Path(files[name])) if searched else args.command_line
        each.append(Reviewed(name, outcome, command=command))
    return _written(each, args)


def review_studies(
    asked: Mapping[str, pe.Study],
    args: argparse.Namespace,
    picture: Callable[[pe.Outcome], bytes] | None = None,
    versions: Mapping[str, str] | None = None,
) -> app.Answer:
    """Score studies by name and write their page.

    Parameters
    ----------
    asked : mapping of name to Study
    args : Namespace
        Of `add_review_options` and of the score's options.
    picture : callable, optional
        Renders a picture (PNG) of what was found.
    versions : mapping of str, optional
        Programs besides the engine's.
    """
    with app.noted_when_interrupted(NOTHING_WRITTEN):
        return _review_studies(asked, args, picture, versions)


def _review_studies(
    asked: Mapping[str, pe.Study],
    args: argparse.Namespace,
    picture: Callable[[pe.Outcome], bytes] | None,
    versions: Mapping[str, str] | None,
) -> app.Answer:
    _check(len(asked), args)
    changed = {name: app.with_options(study, args) for name, study in asked.items()}
    app.refuse_different(changed)
    each = []
    for name, study in changed.items():
        outcome = app.scored(study, args.workers)
        shown = None if picture is None else picture(outcome)
        told = {"command": args.command_line, "versions": versions or {}}
        each.append(Reviewed(name, outcome, picture=shown, **told))
    return _written(each, args)


def leave(outcome: pe.Outcome, data: dict[str, Any], folder: Path) -> None:
    """Write the page of a search beside its results; a picture rendered there is on it."""
    there = data["run"].get("files", {})
    picture = (folder / studies.REVIEW).read_bytes() if studies.REVIEW in there else None
    host = {k: v for k, v in data["run"]["versions"].items() if k not in TOLD}
    command = str(data["run"].get("command", ""))
    name = folder.resolve().name
    one = Reviewed(name, outcome, picture=picture, command=command, versions=host)
    studies.add_to_result(data, folder, {PAGE: page_bytes([one])})


def _check(of_studies: int, args: argparse.Namespace) -> None:
    """Refuse what could not be written, or has no room on a page, before any is scored."""
    if of_studies > MOST_STUDIES:
        raise pe.InputError("command line", "STUDY", f"{MOST_STUDIES} at most", of_studies)
    _about(args)
    pe.prepare_folder(args.output, () if args.replace else (PAGE,))


def _written(each: Sequence[Reviewed], args: argparse.Namespace) -> app.Answer:
    path = write_page(each, args.output, replace=args.replace, about=_about(args))
    return str(path), app.DONE


def _about(args: argparse.Namespace) -> About:
    return About(args.title, args.author, args.date, args.revision)


def _study(path: str) -> pe.Study:
    """Read a study, or the one in a folder of results."""
    return pe.load_study(Path(path) / studies.STUDY if Path(path).is_dir() else path)


def _searched(path: str, args: argparse.Namespace) -> pe.Outcome | None:
    """Return the outcome of a folder's search; None where the path is no such folder."""

    def score(study: pe.Study) -> pe.Outcome:
        return app.scored(app.with_options(study, args), args.workers)

    return outcome_of_folder(Path(path), score) if Path(path).is_dir() else None

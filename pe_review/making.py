"""The verb ``review``, and the page beside a search's results."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from .engine import app, pe, studies
from .page import PAGE, page_bytes, write_page
from .reviewed import MOST_STUDIES, Reviewed


def review(args: argparse.Namespace) -> app.Answer:
    """Score studies and write their page; Ctrl-C ends it, and then nothing is written."""
    files = app.named_by_file(args.studies)
    if len(files) > MOST_STUDIES:
        expected = f"{MOST_STUDIES} studies at most"
        raise pe.InputError("command line", "STUDY", expected, len(files))
    pe.prepare_folder(args.output, () if args.replace else (PAGE,))
    asked = {name: app.with_options(_study(path), args) for name, path in files.items()}
    app.refuse_different(asked)
    each = [Reviewed(n, app.scored(study, args.workers)) for n, study in asked.items()]
    return str(write_page(each, args.output, replace=args.replace)), app.DONE


def leave(outcome: pe.Outcome, data: dict[str, Any], folder: Path) -> None:
    """Write the page of a search beside its results; a picture rendered there is on it."""
    there = data["run"].get("files", {})
    picture = (folder / studies.REVIEW).read_bytes() if studies.REVIEW in there else None
    one = Reviewed(folder.resolve().name, outcome, picture=picture)
    studies.add_to_result(data, folder, {PAGE: page_bytes([one])})


def _study(path: str) -> pe.Study:
    """Read a study, or the one in a folder of results."""
    return pe.load_study(Path(path) / studies.STUDY if Path(path).is_dir() else path)

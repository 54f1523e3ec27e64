"""Options of jobs that resume an earlier search or write the review page."""

from __future__ import annotations

import argparse
from pathlib import Path

from pe_core.study import Study

from ..jobs import BegunSearch, OptimizeJob, Outcome, ScoreJob, read_search
from .run_job import Data, More
from .terminal import tell

AnyJob = ScoreJob | OptimizeJob


def begun_search(args: argparse.Namespace) -> BegunSearch | None:
    """Return the search to resume; None without the option ``--resume``."""
    folder = getattr(args, "resume", None)
    return None if folder is None else read_search(folder)


def job_and_folder(
    study: Study, args: argparse.Namespace, begun: BegunSearch | None
) -> tuple[AnyJob, str | None]:
    """Return the job that `args.job` makes of a study, and the folder for its results.

    Raises
    ------
    InputError
        The search to resume belongs to another study.
    """
    job: AnyJob = args.job(study, args.workers)
    if begun is None or not isinstance(job, OptimizeJob):
        return job, args.output
    job.journal, job.inputs = begun.journal_of(study), begun.inputs
    tell(f"going on after {len(begun.judged):,} placements")
    return job, args.resume


pages: list[More] = []
"""Additional files of a search; packages with further verbs append to this list."""


def add_page_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that leaves the pages out."""
    names = ", ".join(name for page in pages for name in page.names)
    parser.add_argument(
        "--no-review", action="store_false", dest="review", help=f"no {names or 'review'}"
    )


def with_pages(args: argparse.Namespace, more: More | None = None) -> More | None:
    """Return the additional files of a run: `more`, and for a search the requested pages."""
    asked = args.kind == "optimize" and args.review
    each = [*([more] if more else []), *(pages if asked else [])]
    if not each:
        return None

    def write(outcome: Outcome, data: Data, folder: Path) -> None:
        # Pages show the command that repeats the run.
        data["run"] = {**data["run"], "command": args.command_line}
        for one in each:
            one.write(outcome, data, folder)

    return More([name for one in each for name in one.names], write)

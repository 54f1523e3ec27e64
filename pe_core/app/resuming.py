"""``--resume DIR``: a search goes on from the state in the folder of its results."""

from __future__ import annotations

import argparse

from ..study import BegunSearch, OptimizeJob, ScoreJob, Study, read_search
from .terminal import tell

AnyJob = ScoreJob | OptimizeJob


def begun_search(args: argparse.Namespace) -> BegunSearch | None:
    """Return the search to go on with; None where none was asked for."""
    folder = getattr(args, "resume", None)
    return None if folder is None else read_search(folder)


def job_and_folder(
    study: Study, args: argparse.Namespace, begun: BegunSearch | None
) -> tuple[AnyJob, str | None]:
    """Return the job that `args.job` makes of a study, and the folder for its results.

    Raises
    ------
    InputError
        When the search that was begun is of another study.
    """
    job: AnyJob = args.job(study, args.workers)
    if begun is None or not isinstance(job, OptimizeJob):
        return job, args.output
    job.journal, job.inputs = begun.journal_of(study), begun.inputs
    tell(f"going on after {len(begun.judged):,} placements")
    return job, args.resume

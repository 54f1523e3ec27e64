"""Run a job of a verb's options, and keep its results."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from pe_core.base import dump_json
from pe_core.base.errors import InputError
from pe_core.study import STUDY, Study

from .. import jobs
from .executors import evaluated_by
from .interrupts import Interrupted, stop_at_first
from .progress_line import Reporter
from .terminal import BAD_INPUT, DONE, Answer, one_line, printable, show, summary, tell


def written(write: Callable[[Path], object], folder: Path) -> bool:
    """Write to a folder; return whether that worked. If not, what goes wrong is printed."""
    try:
        write(folder)
    except InputError as error:
        tell(str(error))
        return False
    return True


Data = dict[str, Any]


class More(NamedTuple):
    """Additional files of a run: their names, and the function that writes them.

    `write` takes the outcome, the data of result.json, in which it lists the files, and the folder.
    """

    names: Sequence[str]
    write: Callable[[jobs.Outcome, Data, Path], None]


def carry_out(
    job: jobs.Job,
    output: Path | None,
    *,
    as_json: bool,
    host: dict[str, str] | None = None,
    more: More | None = None,
    executor: str | None = None,
) -> Answer:
    """Run a job, keep its results, and return what is printed with the exit status.

    The first Ctrl-C, SIGTERM or SIGHUP stops the job: the best placement so far is scored and kept.
    The second one ends at once and keeps the best placement without its score. Where results cannot
    be written to `output`, a line on stderr says so, and the status is 1.
    """
    tell_boxes(job.study)
    print_vehicle(job.study)
    with evaluated_by(job, executor), stop_at_first(job.stop) as received:
        outcome = drive(job, output)
        if outcome is None:
            note = "no score was complete, so nothing was written"
            raise Interrupted(received.signum or signal.SIGINT, note)
        status, data = DONE, jobs.result_dict(outcome, host)
        if output is not None:
            status, data = keep(outcome, output, host, more)
        text = dump_json(data) if as_json else summary(outcome)
        return text, status or received.status(DONE)


def refuse_own_folder(study: Path, output: Path) -> None:
    """Raise `InputError` when the results would replace the study that is read."""
    try:
        is_same = (output / STUDY).samefile(study)
    except (OSError, ValueError):
        return
    if is_same:
        found = f"the study's folder: {STUDY} would be overwritten"
        raise InputError(study, "output", "another folder than the study's folder", found)


def tell_boxes(study: Study) -> None:
    """Print a line about labelled boxes: what is used of them."""
    if (report := study.prior.report(study.space)) is not None:
        tell(str(report))


def print_vehicle(study: Study) -> None:
    """Print one line about the study's vehicle on stderr: its size and orientation."""
    if study.vehicle_line is not None:
        show(f"{one_line(study.vehicle_line)}\n", sys.stderr)


def drive(job: jobs.Job, output: Path | None = None) -> jobs.Outcome | None:
    """Run a job to its end, with progress on stderr; return its outcome.

    The outcome is None if the job was stopped before its first score. During a search, checkpoints
    are saved in `output`: after every round, and when an exception ends the search.
    """
    reporter, failed = Reporter(sys.stderr), False
    saved = None
    if isinstance(job, jobs.OptimizeJob) and output is not None:
        saved = job, jobs.Checkpoint(job), output
    try:
        for progress in job:
            reporter.report(progress)
            if saved is None or not saved[1].due():
                continue
            try:
                saved[1].save(saved[2])
                if job.stopped:
                    tell(f"the best placement so far is in {saved[2] / STUDY}; it is being scored")
            except InputError as error:
                if not failed:
                    tell(f"{error}; the search goes on")
                failed = True
    except BaseException:
        is_kept = saved and len(saved[0].history) > 1 and written(saved[1].save, saved[2])
        if saved and is_kept:
            tell(f"the best placement so far is in {saved[2] / STUDY}")
        raise
    finally:
        reporter.clear()
    return job.outcome


def keep(
    outcome: jobs.Outcome, output: Path, host: dict[str, str] | None, more: More | None
) -> tuple[int, Data]:
    """Write the results to a folder; return the exit status and the content of result.json."""
    data = jobs.result_dict(outcome, host)
    names = more.names if more else ()

    def write(folder: Path) -> None:
        nonlocal data
        jobs.prepare_folder(folder, names)  # the user may have added a file meanwhile
        data = jobs.write_outcome(outcome, folder, host, names)
        if more is not None:
            more.write(outcome, data, folder)

    is_whole = written(write, output)
    for name in jobs.files_of_other_runs(output):  # checkpoints may lie beside an older result
        tell(f"{output / name}: not of this run")
    return (DONE if is_whole else BAD_INPUT), data


def print_answer(text: str, status: int, out: TextIO | None) -> int:
    """Print the text of a command; return its exit status."""
    encoding = getattr(out, "encoding", None)
    shown = printable(text.removesuffix("\n"), encoding)
    error = show(f"{shown}\n", out) if text else None
    if error is None or isinstance(error, BrokenPipeError):  # as `head` closes the pipe
        return status
    tell(f"output: {getattr(error, 'strerror', None) or error}")
    return status or BAD_INPUT


def begun_search(args: argparse.Namespace) -> jobs.BegunSearch | None:
    """Return the search to resume; None without the option ``--resume``."""
    folder = getattr(args, "resume", None)
    return None if folder is None else jobs.read_search(folder)


def job_and_folder(
    study: Study, args: argparse.Namespace, begun: jobs.BegunSearch | None
) -> tuple[jobs.ScoreJob | jobs.OptimizeJob, str | None]:
    """Return the job of a study that `args.kind` names, and the folder for its results.

    Raises `InputError` where the search to resume belongs to another study.
    """
    if args.kind == "score":
        return jobs.ScoreJob(study, args.workers), args.output
    job = jobs.OptimizeJob(study, args.workers)
    if begun is None:
        return job, args.output
    job.journal, job.inputs = begun.journal_of(study), begun.inputs
    tell(f"going on after {len(begun.evaluated):,} placements")
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

    def write(outcome: jobs.Outcome, data: Data, folder: Path) -> None:
        # Pages show the command that repeats the run.
        data["run"] = {**data["run"], "command": args.command_line}
        for one in each:
            one.write(outcome, data, folder)

    return More([name for one in each for name in one.names], write)

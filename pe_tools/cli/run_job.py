"""Run a job of a verb's options, and keep its results."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Protocol, TextIO, TypeAlias

from pe_core.base import dump_json
from pe_core.base.errors import InputError
from pe_core.base.files import require_new, write_bytes
from pe_core.base.input_files import refuse_input
from pe_core.base.plugins import shipped
from pe_core.study import REVIEW_PAGE, STUDY, Study

from .. import jobs
from ..advice import Advice
from .front_text import front_summary
from .interrupts import Interrupted, stop_at_first
from .progress_line import Reporter
from .terminal import BAD_INPUT, DONE, Answer, one_line, printable, show, summary, tell

Data = dict[str, Any]


def written(write: Callable[[Path], object], folder: Path) -> bool:
    """Write to a folder; return whether that worked. If not, what goes wrong is printed."""
    try:
        write(folder)
    except InputError as error:
        tell(str(error))
        return False
    return True


def output_file(name: str | None, args: argparse.Namespace) -> Path | None:
    """Return the file that a verb is to write, if it has one; `InputError`, before the work, where
    it cannot be written. To be called when all inputs are read: it must not replace one."""
    if name is None:
        return None
    require_new(path := Path(name), replace=args.replace)
    if not path.parent.is_dir():
        raise InputError(path, "file", "a file in a folder that exists", "no such folder")
    return path


def save_text(path: Path | None, text: str) -> int:
    """Write what a verb found to its file, if it has one; return the exit status of that. The
    answer is printed also where it cannot be written."""
    if path is None:
        return DONE
    data = text.encode(errors="backslashreplace")
    if not written(lambda to: write_bytes(to, data), path):
        return BAD_INPUT
    tell(f"wrote {path}")
    return DONE


Found: TypeAlias = "jobs.Outcome | jobs.TradeOff"
Runs: TypeAlias = "jobs.ScoreJob | jobs.OptimizeJob | jobs.FrontJob"


class More(NamedTuple):
    """Additional files of a run: their names, and the function that writes them. `write` takes the
    outcome or the front, the data of its JSON file, in which an outcome lists them, the folder."""

    names: Sequence[str]
    write: Callable[[Any, Data, Path], None]


class Host(Protocol):
    """The program around a command line: Blender, or none."""

    versions: dict[str, str] | None

    def study(self, args: argparse.Namespace) -> Study:
        """Return the study of a command line."""

    def artifacts(self, study: Study, *, searches: bool) -> Sequence[More]:
        """Return further files of a run; `InputError` where a result could not be kept."""

    def notes(self) -> tuple[Advice, ...]:
        """Return warnings about the study."""

    def share_evaluators(self, job: jobs.Job) -> None:
        """Give a job the evaluators that earlier ones made, if they are kept."""


def _page(*, is_front: bool) -> More:
    """Return the page beside the results of a search, or of a front."""
    if is_front:
        return More([jobs.FRONT_PAGE], partial(_write_page, "page.front"))
    return More([REVIEW_PAGE], partial(_write_page, "page.search"))


def _write_page(writer: str, found: Any, data: Data, folder: Path) -> None:
    shipped(writer)(found, data, folder)


def run_study(host: Host, args: argparse.Namespace) -> Answer:
    """Score or optimize a study, as `args.kind` says, and return what is printed. Results go to the
    folder of ``--output``; with ``--resume`` a search or a front goes on in that folder.
    `InputError`, before the work, where a search has nowhere to keep its result, or a folder cannot
    take the results, or holds the search of another study."""
    study = host.study(args)
    searches = args.kind == "optimize"
    folder = args.output
    if searches and not (folder or args.resume or args.json):
        expected = "-o DIR, a folder for what the search finds, or --json"
        raise InputError("command line", "output", expected, "neither")
    is_front = searches and jobs.has_front(study)
    more = tuple(host.artifacts(study, searches=searches))
    if searches and args.review:
        more = (*more, _page(is_front=is_front))
    job: Runs
    if not searches:
        job = jobs.ScoreJob(study, args.workers)
    else:
        job = (jobs.FrontJob if is_front else jobs.OptimizeJob)(study, args.workers)
        if args.resume is not None:
            folder = args.resume
            count = jobs.resume(job, Path(folder))
            tell(f"going on after {count:,} placements")
    job.notes = host.notes()
    host.share_evaluators(job)
    if folder is not None:
        own = jobs.FRONT_NAMES if is_front else jobs.result_names(study, args.kind)
        added = [name for each in more for name in each.names]
        for name in added if is_front else (STUDY, *added):
            refuse_input(Path(folder) / name)
        jobs.prepare_folder(folder, [*own, *added])
    output = None if folder is None else Path(folder)
    return _carried_out(job, output, args, host.versions, more=more)


def _carried_out(
    job: Runs,
    output: Path | None,
    args: argparse.Namespace,
    host: dict[str, str] | None,
    more: Sequence[More],
) -> Answer:
    """Run a job, keep its results, and return what is printed with the exit status. The first
    Ctrl-C, SIGTERM or SIGHUP stops a search: the best so far is scored, analysed and kept. The
    second one ends the analysis; the next ends at once, with the best as it was saved. Where
    results cannot be written, a line on stderr says so, and the status is 1."""
    if (report := job.study.prior.report(job.study.space)) is not None:  # of labelled boxes
        tell(str(report))
    print_vehicle(job.study)
    with _evaluated_by(job, args), stop_at_first(job.stop) as received:
        found = drive(job, output, host)
        if found is None:
            note = "no score was complete, so nothing was written"
            raise Interrupted(received.signum or signal.SIGINT, note)
        if output is None:
            status = DONE
            data = _data_of(found, host)
        else:
            status, data = keep(found, output, host, more, command=args.command_line)
        text = summary(found) if isinstance(found, jobs.Outcome) else front_summary(found)
        return dump_json(data) if args.json else text, status or received.status(DONE)


def _evaluated_by(job: Runs, args: argparse.Namespace) -> AbstractContextManager[None]:
    """Have the workers that are asked for evaluate a job's candidates meanwhile; a score has
    none."""
    if isinstance(job, jobs.ScoreJob):
        return nullcontext()
    from .executors import evaluated_by

    return evaluated_by(job, args.executor)


def _data_of(found: Found, host: dict[str, str] | None) -> Data:
    if isinstance(found, jobs.Outcome):
        return jobs.result_dict(found, host)
    return jobs.front_dict(found, host)


def print_vehicle(study: Study) -> None:
    """Print one line about the study's vehicle on stderr: its size and orientation."""
    if study.vehicle_line is not None:
        show(f"{one_line(study.vehicle_line)}\n", sys.stderr)


def drive(job: jobs.Job, output: Path | None = None, host: dict[str, str] | None = None) -> Any:
    """Run a job to its end, with progress on stderr; return its `result`: None if it was stopped
    before its first score. Checkpoints of a search or a front are saved in `output`: as they are
    due, and when an exception ends it."""
    reporter = Reporter(sys.stderr)
    told = False
    checkpoint = None if output is None else jobs.checkpoint_of(job, host)
    try:
        for progress in job:
            reporter.report(progress)
            if output is None or checkpoint is None or not checkpoint.due():
                continue
            try:
                checkpoint.save(output)
                if job.stopped and not isinstance(job, jobs.FrontJob):
                    tell(f"the best placement so far is in {output / STUDY}; it is being scored")
            except InputError as error:
                if not told:
                    tell(f"{error}; the search goes on")
                told = True
    except BaseException:
        if output and checkpoint and checkpoint.has_more and written(checkpoint.save, output):
            tell(f"the best placement so far is in {output / checkpoint.file}")
        raise
    finally:
        reporter.clear()
    return job.result


def keep(
    found: Found,
    output: Path,
    host: dict[str, str] | None,
    more: Sequence[More] = (),
    command: str = "",
) -> tuple[int, Data]:
    """Write the results to a folder; return the exit status and the content of the JSON file."""
    data = _data_of(found, host)
    names = [name for each in more for name in each.names]

    def write(folder: Path) -> None:
        nonlocal data
        jobs.prepare_folder(folder, names)  # the user may have added a file meanwhile
        if isinstance(found, jobs.Outcome):
            data = jobs.write_outcome(found, folder, host, names)
            if more:  # pages show the command that repeats the run
                data["run"] = {**data["run"], "command": command}
        else:
            data = jobs.write_front(found, folder, host)
        for each in more:
            each.write(found, data, folder)

    is_whole = written(write, output)
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

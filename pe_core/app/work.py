"""A job on a command line: driven to its end, and its results kept whatever happens."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from ..errors import InputError
from ..study import (
    Job,
    Outcome,
    Study,
    files_of_other_runs,
    prepare_folder,
    result_dict,
    set_aside_files_of_other_runs,
    write_outcome,
)
from ..text import dump_json
from .fallback_folder import folder_or_fallback, put_elsewhere
from .interrupts import Interrupted, stop_at_first
from .reporting import Reporter
from .saving import Saver
from .status import BAD_INPUT, DONE, Answer
from .summary import summary
from .terminal import one_line, printable, show, tell

Data = dict[str, Any]


class More(NamedTuple):
    """More files of a run (Blender's): their names; what writes them to its folder, and notes them
    in its data."""

    names: Sequence[str]
    write: Callable[[Outcome, Data, Path], None]


def carry_out(
    job: Job,
    output: Path | None,
    *,
    as_json: bool,
    host: dict[str, str] | None = None,
    more: More | None = None,
) -> Answer:
    """Run a job, keep its results, and return what is printed with the exit status.

    The first Ctrl-C, SIGTERM or SIGHUP asks the job to stop: the best so far is judged and kept.
    The second ends at once, with the best so far kept as it is. Results that cannot be written to
    `output` go to a folder that is told on stderr; the status is then 1.
    """
    tell_vehicle(job.study)
    with stop_at_first(job.stop) as received:
        outcome = drive(job, output)
        if outcome is None:
            note = "no score was complete, so nothing was written"
            raise Interrupted(received.signum or signal.SIGINT, note)
        status, data = DONE, result_dict(outcome, host)
        if output is not None:
            status, data = keep(outcome, output, host, more)
        text = dump_json(data) if as_json else summary(outcome)
        return text, status or received.status(DONE)


def tell_vehicle(study: Study) -> None:
    """Tell the study's vehicle in one line: how large it is, which way it faces."""
    if study.vehicle_line is not None:
        show(f"{one_line(study.vehicle_line)}\n", sys.stderr)


def drive(job: Job, output: Path | None = None, stream: TextIO | None = None) -> Outcome | None:
    """Run a job to its end, with progress on `stream` (stderr); None when it was stopped too early.

    During a search its state and the best so far are also kept in `output`: after every round, and
    whenever it ends by an exception.
    """
    reporter, saver = Reporter(stream or sys.stderr), Saver(job, output)
    try:
        for progress in job:
            reporter.report(progress)
            saver.save_when_due()
    except BaseException:
        saver.save_at_last()
        raise
    finally:
        reporter.clear()
    return job.outcome


def keep(
    outcome: Outcome, output: Path, host: dict[str, str] | None, more: More | None
) -> tuple[int, Data]:
    """Write the results to a folder; where that fails, to another one that is told.

    Returns
    -------
    status : int
    data : dict
        What result.json holds.
    """
    data, kept = result_dict(outcome, host), list[Path]()
    names = more.names if more else ()
    for place in (output, None):
        try:
            with folder_or_fallback(place) as folder:
                prepare_folder(folder, names)  # a file of the user's may have come meanwhile
                data = write_outcome(outcome, folder, host, names)
                kept.append(folder)
                if more is not None:
                    more.write(outcome, data, folder)
        except InputError as error:
            tell(str(error))
            if folder in kept:
                for name, aside in set_aside_files_of_other_runs(folder).items():
                    tell(f"{folder / name}: of an earlier run; it is {aside} now")
            continue
        _tell_of_other_runs(folder)
        if folder != output:
            tell(f"the results are in {folder}")
        return (DONE if folder == output else BAD_INPUT), data
    tell(f"all else is in {kept[0]}" if kept else "the results are not in any file")
    _tell_of_other_runs(output)
    return BAD_INPUT, data


def _tell_of_other_runs(folder: Path) -> None:
    for name in files_of_other_runs(folder):
        tell(f"{folder / name}: not of this run")


def print_answer(text: str, status: int, out: TextIO | None) -> int:
    """Print what a command has to say; return its exit status."""
    encoding = getattr(out, "encoding", None)
    shown = printable(text.removesuffix("\n"), encoding)
    error = show(f"{shown}\n", out) if text else None
    if error is None or isinstance(error, BrokenPipeError):  # the reader has gone, as `head` does
        return status
    tell(f"output: {getattr(error, 'strerror', None) or error}; {put_elsewhere(text)}")
    return status or BAD_INPUT

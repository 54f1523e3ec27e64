"""A job on a command line: driven to its end, and its results kept whatever happens."""

from __future__ import annotations

import signal
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from ..errors import InputError
from ..study import (
    STUDY,
    Job,
    OptimizeJob,
    Outcome,
    Progress,
    Study,
    export_study,
    files_of_other_runs,
    prepare_folder,
    result_dict,
    write_outcome,
)
from ..text import dump_json
from .interrupts import Interrupted, stop_at_first
from .status import BAD_INPUT, DONE, Answer
from .summary import summary
from .terminal import is_terminal, one_line, printable, show, tell

REPORT_EVERY_S = {True: 0.2, False: 5.0}
"""How often progress is shown: on a terminal, where it overwrites itself, and in a log."""
SAVE_EVERY_S = 10.0
ELSEWHERE = "perception-entropy-"
"""What a folder for results begins with that could not be written where they were wanted."""
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

    During a search the best so far is also kept in `output`, and whenever it ends by an exception.
    """
    reporter, saver = Reporter(stream or sys.stderr), Saver(job, output)
    try:
        for progress in job:
            reporter.report(progress)
            saver.save_now_and_then()
    except BaseException:
        saver.save_at_last()
        raise
    finally:
        reporter.clear()
    return job.outcome


class Reporter:
    """Tells how far a job is. It never fails: when nobody can be told, nobody is."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream, self._on_terminal = stream, is_terminal(stream)
        self._pause_s = REPORT_EVERY_S[self._on_terminal]
        self._reported, self._stage = 0.0, ""

    def report(self, progress: Progress) -> None:
        """Tell, if it is some time since that was done or there is a new stage."""
        now = time.monotonic()
        if now - self._reported < self._pause_s and progress.stage == self._stage:
            return
        self._reported, self._stage = now, progress.stage
        entropy = "" if progress.entropy is None else f"  entropy {progress.entropy:.4f}"
        line = f"{progress.stage} {progress.fraction:4.0%}{entropy}"
        self._show(f"\r\x1b[K{line}" if self._on_terminal else f"{line}\n")

    def clear(self) -> None:
        """Leave no half line behind."""
        if self._on_terminal:
            self._show("\r\x1b[K")

    def _show(self, text: str) -> None:
        if show(text, self._stream) is not None:
            self._stream = None


class Saver:
    """Keeps a search's best so far as a study in the output folder."""

    def __init__(self, job: Job, output: Path | None) -> None:
        self._job, self._output, self._saved = job, output, time.monotonic()
        self._saved_at_stop = self._warned = False

    def save_now_and_then(self) -> None:
        """Save every few seconds, and when the search is stopped: who stopped it may not wait."""
        if self._output is None or not self._has_better():
            return
        at_stop = self._job.stopped and not self._saved_at_stop
        if at_stop or time.monotonic() - self._saved >= SAVE_EVERY_S:
            self._saved_at_stop = self._job.stopped
            self._saved = time.monotonic()
            try:
                self._save(self._output)
            except InputError as error:
                if not self._warned:
                    tell(f"{error}; the search goes on")
                self._warned = True

    def save_at_last(self) -> None:
        """Save now, where that can be done, and say where."""
        if self._output is None or not self._has_better():
            return
        for place in (self._output, None):
            try:
                tell(f"the best placement so far is in {self._save(place or _another_folder())}")
                return
            except InputError as error:
                tell(str(error))

    def _has_better(self) -> bool:
        """Whether something better than the start was found."""
        return isinstance(self._job, OptimizeJob) and len(self._job.history) > 1

    def _save(self, folder: Path) -> Path:
        assert isinstance(self._job, OptimizeJob)
        path = prepare_folder(folder) / STUDY
        export_study(self._job.best, path)
        return path


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
    for place in (output, None):
        try:
            folder = place or _another_folder()
            data = write_outcome(outcome, folder, host, more.names if more else ())
            kept.append(folder)
            if more is not None:
                more.write(outcome, data, folder)
        except InputError as error:
            tell(str(error))
            continue
        _tell_of_other_runs(folder)
        if folder != output:
            tell(f"the results are in {folder}")
        return (DONE if folder == output else BAD_INPUT), data
    tell(f"all else is in {kept[0]}" if kept else "the results are not in any file")
    _tell_of_other_runs(output)
    return BAD_INPUT, data


def _another_folder() -> Path:
    try:
        return Path(tempfile.mkdtemp(prefix=ELSEWHERE))
    except OSError as error:
        where = "folder for temporary files"
        raise InputError("system", where, "one that can be written", error) from None


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
    tell(f"output: {getattr(error, 'strerror', None) or error}; {_put_elsewhere(text)}")
    return status or BAD_INPUT


def _put_elsewhere(text: str) -> str:
    """Keep a text that could not be printed; return where it is, in words."""
    try:
        path = _another_folder() / "output.txt"
        path.write_text(text, encoding="utf-8", errors="backslashreplace")
    except (InputError, OSError) as error:
        return f"it could not be kept either: {error}"
    return f"what it would have said is in {path}"

"""The verb ``sweep``: many studies, or one with many changes, in a table."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.input_files import refuse_input
from pe_core.study import SEARCH, STUDY

from .. import jobs
from ..advice import curve_note, hardware_note
from ..sweep import RunTask, SweepRun, read_tried, run_all, sweep_runs
from ..sweep import sweep_table as table
from ..sweep.sweep_table import BEGUN, DONE, UNWRITTEN, WAITING, SweepRow
from ..wording import percent
from . import terminal
from .answers import SweepAnswer
from .executors import workplace
from .interrupts import Interrupted, Received, stop_at_first
from .progress_line import Reporter
from .study_source import StudyFiles, named_by_file, with_options
from .terminal import is_terminal, one_line, show, tell


def sweep(_: StudyFiles, args: argparse.Namespace) -> terminal.Answer:
    """Run study files, with every combination of changes; write all results to a folder. Runs
    whose results are in the folder already are not repeated."""
    kind = "optimize" if args.optimize else "score"
    files = named_by_file(args.studies)
    runs = sweep_runs(files, read_tried(args.set), lambda study: with_options(study, args))
    if args.part is not None:
        runs = runs[args.part[0] - 1 :: args.part[1]]
    names = [table.SWEEP_CSV, table.SWEEP_JSON]
    folder = jobs.prepare_folder(args.output, names)
    for run in runs:  # before the work
        refuse_input(folder / run.name / STUDY)
        jobs.check_files(folder / run.name, jobs.result_names(run.study, kind))
    work = _SweepVerb(runs, kind, folder, args.part is None)
    received = work.run(args)
    if received.signum is not None:
        kept = f", {work.count(BEGUN)} begun and kept" if work.count(BEGUN) else ""
        note = f"{work.done} runs are done{kept}; the same command goes on"
        raise Interrupted(received.signum, note)
    studies = [run.study for run in runs]
    notes = hardware_note([s.model for s in each.rig] for each in studies), curve_note(studies)
    rows = list(work.rows.values())
    missing = [row for row in rows if row.status == UNWRITTEN]
    where = (f"{row.run.name}: {row.status}: {row.message}" for row in missing)
    lines = [*table.table_lines(rows, kind), *where, *filter(None, notes)]
    text = terminal.answered(args, SweepAnswer(**work.data), lines)
    whole = work.count(DONE) == len(rows) and not work.failed_to_write
    return text, terminal.DONE if whole else terminal.BAD_INPUT


class _SweepVerb:
    """A running sweep, or a part of one: its rows by name, and its folder. `data` is the content of
    sweep.json; `failed_to_write` says whether something could not be written to the folder of the
    sweep."""

    def __init__(
        self, runs: Sequence[SweepRun], kind: str, folder: Path, writes_table: bool
    ) -> None:
        self._writes_table = writes_table
        self._kind = kind
        self._folder = folder
        self.failed_to_write = False
        self.rows: dict[str, SweepRow] = {}
        for run in runs:
            known = table.row_of_result(run, folder / run.name, kind)
            self.rows[run.name] = known or SweepRow(run, self._unfinished(run))
        self._reporter = Reporter(sys.stderr)
        self._on_terminal = is_terminal(sys.stderr)
        self.data: dict[str, Any] = {}
        self._write_table()

    def count(self, status: str) -> int:
        """Return how many runs have a status."""
        return sum(row.status == status for row in self.rows.values())

    @property
    def done(self) -> str:
        """How many runs are done: "2 of 5"."""
        return f"{self.count(DONE)} of {len(self.rows)}"

    def _unfinished(self, run: SweepRun) -> str:
        """Status of a run that is not done: "begun" if its search has a checkpoint."""
        searches = self._kind == "optimize"
        return BEGUN if searches and (self._folder / run.name / SEARCH).exists() else WAITING

    def run(self, args: argparse.Namespace) -> Received:
        """Run all runs that are not done; return the signal that stopped them. Until the workers
        are there, the first signal ends the sweep."""
        left = [name for name, row in self.rows.items() if row.status != DONE]
        begun = self.count(BEGUN)
        if self.count(DONE) or begun:
            going_on = f"; searches that go on: {begun}" if begun else ""
            tell(f"{self.done} runs are done already{going_on}")
        if not left:
            return Received()
        searches = self._kind == "optimize"
        try:
            with (
                workplace(args.workers, args.executor) as place,
                stop_at_first(lambda: None) as received,
            ):

                def make_task(name: str) -> RunTask:
                    run = self.rows[name].run
                    self.rows[name] = replace(self.rows[name], status=BEGUN)
                    folder = self._folder / name if place.reaches_folders else None
                    return RunTask(run.study, searches, place.threads, folder)

                def goes_on() -> bool:
                    if self._on_terminal:
                        left = self.count(WAITING) + self.count(BEGUN)
                        share = 1.0 - left / len(self.rows)
                        self._reporter.report(jobs.Progress("sweeping", share))
                    return received.signum is None

                run_all(left, make_task, place, self._take, should_continue=goes_on)
            return received
        finally:
            self._reporter.clear()
            for name, row in self.rows.items():
                if row.status in (WAITING, BEGUN):
                    self.rows[name] = replace(row, status=self._unfinished(row.run))
            self._write_table()

    def _take(self, name: str, found: jobs.Outcome | InputError) -> None:
        """Store the result of a run, update the table, and report the run."""
        kept = self._keep(name, found) if isinstance(found, jobs.Outcome) else ()
        row = self.rows[name] = table.row_of(self.rows[name].run, found, *kept)
        self._write_table()
        if isinstance(found, InputError):
            self._print_failure("" if found.source == name else name, found)
        elif not self._on_terminal:
            figures = f"entropy {row.entropy:.3f}  coverage {percent(row.coverage or 0.0, 1)}"
            line = f"[{self.count(DONE)}/{len(self.rows)}] {name}  {figures}"
            show(f"{one_line(line)}\n", sys.stderr)

    def _keep(self, name: str, found: jobs.Outcome) -> tuple[str, str]:
        """Write a run's results; return status and message of the row of the run."""
        try:
            jobs.write_outcome(found, self._folder / name)
            return DONE, ""
        except InputError as error:
            self.failed_to_write = True
            self._print_failure(name, error)
            return UNWRITTEN, str(error)

    def _write_table(self) -> None:
        """Write the table; a failure is printed once."""
        rows = list(self.rows.values())
        if not self._writes_table:  # other parts write beside it
            self.data = table.table_data(rows, self._kind)
            return
        try:
            self.data = table.write_table(rows, self._kind, self._folder)
        except InputError as error:
            if not self.failed_to_write:
                self._print_failure("", error)
            self.failed_to_write = True
            self.data = table.table_data(rows, self._kind)

    def _print_failure(self, name: str, what: InputError | str) -> None:
        self._reporter.clear()
        tell(str(what) if not name else f"{name}: {what}")

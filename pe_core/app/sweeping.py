"""The verb ``sweep``: many studies, or one with many changes, in a table."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..study import (
    STUDY,
    Outcome,
    Progress,
    check_files,
    prepare_folder,
    result_names,
    write_outcome,
)
from ..sweep import (
    DONE,
    SWEEP_CSV,
    SWEEP_JSON,
    RunTask,
    SweepRow,
    SweepRun,
    read_settings,
    row_of,
    row_of_result,
    run_all,
    sweep_runs,
    table_lines,
    write_table,
)
from ..text import dump_json
from . import status
from .command import add_score_options, add_search_options, with_options
from .interrupts import Interrupted, Received, stop_at_first
from .reporting import Reporter
from .terminal import is_terminal, one_line, show, tell
from .workplaces import workplace


def add_sweep_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``sweep`` to a parser."""
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for all runs")
    about = "try these values of a key of the study; several: every combination"
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE,...", help=about)
    parser.add_argument("--optimize", action="store_true", help="search in every run; else score")
    about = "have the workers of a Dask scheduler do it, tcp://host:8786"
    parser.add_argument("--scheduler", metavar="ADDRESS", help=about)
    parser.add_argument("--json", action="store_true", help=f"print {SWEEP_JSON} on stdout")
    add_score_options(parser, workers="processes")
    add_search_options(parser)


def sweep(files: Mapping[str, str | Path], args: argparse.Namespace) -> status.Answer:
    """Run study files by name, with every combination of changes, and leave all in a folder.

    What a sweep has left there already is not done again.
    """
    kind = "optimize" if args.optimize else "score"
    settings = read_settings(args.set)
    runs = sweep_runs(files, settings, lambda study: with_options(study, args))
    folder = prepare_folder(args.output, [SWEEP_CSV, SWEEP_JSON])
    _refuse_folders(runs, files, folder, kind)
    work = _Sweep(runs, kind, folder)
    with stop_at_first(lambda: None) as received:
        work.run(args, received)
    if received.signum is not None:
        raise Interrupted(received.signum, f"{work.told}; the same command goes on")
    text = dump_json(work.data) if args.json else "\n".join(table_lines(work.rows, kind))
    whole = all(row.status == DONE for row in work.rows)
    return text, status.DONE if whole else status.BAD_INPUT


def _refuse_folders(
    runs: Sequence[SweepRun], files: Mapping[str, str | Path], folder: Path, kind: str
) -> None:
    """Raise `InputError` when results would take the place of something, before the work."""
    for run in runs:
        at = folder / run.name
        study = Path(files[run.study_name])
        if (at / STUDY).exists() and (at / STUDY).samefile(study):
            raise InputError(study, "output", "another folder than that of the study", "its own")
        check_files(at, result_names(run.study, kind))


class _Sweep:
    """A sweep under way: its rows, and its folder."""

    def __init__(self, runs: Sequence[SweepRun], kind: str, folder: Path) -> None:
        self._kind, self._folder = kind, folder
        found = [row_of_result(run, folder / run.name, kind) for run in runs]
        self.rows = [row or SweepRow(run) for row, run in zip(found, runs, strict=True)]
        self._numbers = {run.name: number for number, run in enumerate(runs)}
        self._reporter, self._on_terminal = Reporter(sys.stderr), is_terminal(sys.stderr)
        self.data: dict[str, Any] = write_table(self.rows, kind, folder)

    @property
    def told(self) -> str:
        """How many runs are done, in words."""
        return f"{self._done} of {len(self.rows)} runs are done"

    @property
    def _done(self) -> int:
        return sum(row.status == DONE for row in self.rows)

    def run(self, args: argparse.Namespace, received: Received) -> None:
        """Carry out what is not done yet."""
        left = [row.run for row in self.rows if row.status != DONE]
        if self._done:
            tell(f"{self.told} already")
        if not left:
            return
        try:
            with workplace(args.workers, args.scheduler) as place:
                searches = self._kind == "optimize"
                tasks = {run.name: RunTask(run.study, searches, place.threads) for run in left}
                run_all(tasks, place, self._take, lambda: self._goes_on(received))
        finally:
            self._reporter.clear()

    def _goes_on(self, received: Received) -> bool:
        if self._on_terminal:
            share = sum(row.status != "waiting" for row in self.rows) / len(self.rows)
            self._reporter.report(Progress("sweeping", share))
        return received.signum is None

    def _take(self, name: str, found: Outcome | InputError) -> None:
        """Keep what was found of a run, and tell it."""
        number = self._numbers[name]
        run = self.rows[number].run
        if isinstance(found, Outcome):
            try:
                write_outcome(found, self._folder / name)
            except InputError as error:
                found = error
        row = self.rows[number] = row_of(run, found)
        self.data = write_table(self.rows, self._kind, self._folder)
        self._tell(row, found)

    def _tell(self, row: SweepRow, found: Outcome | InputError) -> None:
        name = row.run.name
        if isinstance(found, InputError):
            self._reporter.clear()
            tell(str(found) if found.source == name else f"{name}: {found}")
        elif not self._on_terminal:
            figures = f"entropy {row.entropy:.4f}  coverage {row.coverage:.1%}"
            show(one_line(f"[{self._done}/{len(self.rows)}] {name}  {figures}") + "\n", sys.stderr)

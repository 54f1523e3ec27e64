"""Tasks in worker processes, each with its result written to a file as soon as it is there."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pe_core.search import Processes
from pe_tools.cli import noted_when_interrupted, show

from .results_file import ResultsFile

Values = Mapping[str, Any]
"""Values that were computed, by the name of their task."""


@dataclass(frozen=True)
class Task:
    """A function that worker processes can import, its arguments, and the name of its result."""

    name: str
    function: Callable[..., dict[str, Any]]
    arguments: dict[str, Any] = field(default_factory=dict)


def compute(
    folder: Path,
    effort: Any,
    ready_tasks: Callable[[Values], list[Task]],
    workers: int | None,
) -> ResultsFile:
    """Compute all results that a folder does not have yet, in worker processes.

    Parameters
    ----------
    folder : Path
    effort : dataclass
        How much is computed.
    ready_tasks : callable
        Takes the values by task name, and returns the tasks that can run now and have no value.
    workers : int or None
        Number of processes, limited to the number of processors; None or 0: one per processor.
    """
    results = ResultsFile(folder, effort)
    if results.loaded:
        print_progress(f"going on from {results.path}, which has {results.loaded} results")
    note = f"{results.path} keeps the finished tasks; the same command goes on from them"
    processors = os.cpu_count() or 1
    with noted_when_interrupted(note), Processes(min(workers or processors, processors)) as pool:
        try:
            while tasks := ready_tasks(results.values):
                total = results.loaded + len(tasks)
                futures = {pool.submit(_timed, task): task.name for task in tasks}
                for future in as_completed(futures):
                    name, (value, seconds) = futures[future], future.result()
                    results.add(name, value, seconds)
                    print_progress(f"[{len(results.entries)}/{total}] {name}  {seconds:.1f} s")
        except BaseException:  # Ctrl-C and SIGTERM end the workers in the middle of a task
            pool.shutdown(cancel_futures=True)
            raise
    return results


def print_progress(line: str) -> None:
    """Write a line to stderr; a closed stderr does not end the work."""
    show(f"{line}\n", sys.stderr)


def _timed(task: Task) -> tuple[dict[str, Any], float]:
    """Run a task, in a worker; return its value, and its duration [s]."""
    started = time.perf_counter()
    value = task.function(**task.arguments)
    return value, time.perf_counter() - started

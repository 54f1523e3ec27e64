"""Tasks in worker processes, each with its result written to a file as soon as it is there."""

from __future__ import annotations

import os
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.search import Call, Processes, WorkerDied, run_tasks
from pe_tools.cli import noted_when_interrupted, show

from .results_file import CheckValue, ResultsFile

Values = Mapping[str, Any]
"""Values that were computed, by the name of their task."""
TimedValue = tuple[dict[str, Any], float]
"""A task's value, and its duration [s]."""


@dataclass(frozen=True)
class Task:
    """A function that worker processes can import, its arguments, and the name of its result."""

    name: str
    function: Callable[..., dict[str, Any]]
    arguments: dict[str, Any] = field(default_factory=dict)


def compute(
    folder: Path,
    effort: Any,
    check_value: CheckValue,
    ready_tasks: Callable[[Values], list[Task]],
    workers: int | None,
) -> ResultsFile:
    """Compute all results that a folder does not have yet, in worker processes.

    Parameters
    ----------
    folder : Path
    effort : dataclass
        How much is computed.
    check_value : callable
        Checks the values that results.json has already.
    ready_tasks : callable
        Takes the values by task name, and returns the tasks that can run now and have no value.
    workers : int or None
        Number of processes, limited to the number of processors; None or 0: one per processor.

    Raises
    ------
    InputError
        When results.json is damaged, or two worker processes were killed with the same task.
    """
    results = ResultsFile(folder, effort, check_value)
    if results.loaded:
        print_progress(f"going on from {results.path}, which has {results.loaded} results")
    if results.old_results:
        print_progress(f"the results of another run are moved to {results.old_results}")
    note = f"{results.path} keeps the finished tasks; the same command goes on from them"
    processors = os.cpu_count() or 1
    count = min(workers or processors, processors)
    with noted_when_interrupted(note), _worker_processes(count) as pool:
        _run_all(pool, count, results, ready_tasks)
    return results


@contextmanager
def _worker_processes(count: int) -> Iterator[Processes]:
    """Provide worker processes as an executor; an exception ends them in the middle of a task.

    Ctrl-C, SIGTERM and SIGHUP are such exceptions, which the command line raises.
    """
    with Processes(count) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _run_all(
    pool: Processes,
    width: int,
    results: ResultsFile,
    ready_tasks: Callable[[Values], list[Task]],
) -> None:
    """Run tasks until none is left, and write each result to the file when it arrives."""
    tasks: dict[str, Task] = {}
    waiting: deque[str] = deque()

    def add_ready() -> None:
        new = {t.name: t for t in ready_tasks(results.values) if t.name not in tasks}
        tasks.update(new)
        waiting.extend(new)

    def call_of(name: str) -> Call:
        return Call(_timed, (tasks[name],))

    add_ready()
    loaded = len(results.entries)
    with closing(run_tasks(pool, waiting, call_of, lambda: width)) as batches:
        for name, result in chain.from_iterable(batches):
            if isinstance(result, WorkerDied):
                found = f"two that were killed with {name}; the finished tasks are kept"
                raise InputError("workers", "process", "a process that completes", found)
            results.add(name, *result)
            add_ready()
            done = len(results.entries)
            print_progress(f"[{done}/{loaded + len(tasks)}] {name}  {result[1]:.1f} s")


def print_progress(line: str) -> None:
    """Write a line to stderr; a closed stderr does not end the work."""
    show(f"{line}\n", sys.stderr)


def _timed(task: Task) -> TimedValue:
    """Run a task, in a worker."""
    started = time.perf_counter()
    value = task.function(**task.arguments)
    return value, time.perf_counter() - started

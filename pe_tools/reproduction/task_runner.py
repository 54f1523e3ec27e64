"""Tasks in worker processes, each with its result written to a file as soon as it is there."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.search import Processes

from ..cli import noted_when_interrupted, show
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
        When results.json is damaged, or a worker process was killed from outside.
    """
    results = ResultsFile(folder, effort, check_value)
    if results.loaded:
        print_progress(f"going on from {results.path}, which has {results.loaded} results")
    if results.old_results:
        print_progress(f"the results of another run are moved to {results.old_results}")
    note = f"{results.path} keeps the finished tasks; the same command goes on from them"
    with noted_when_interrupted(note), worker_processes(workers) as pool:
        run_tasks(pool, results, ready_tasks, print_progress)
    return results


@contextmanager
def worker_processes(count: int | None) -> Iterator[Processes]:
    """Provide worker processes as an executor; an exception ends them in the middle of a task.

    Ctrl-C, SIGTERM and SIGHUP are such exceptions, which the command line raises.
    """
    processors = os.cpu_count() or 1
    with Processes(min(count or processors, processors)) as pool:
        try:
            yield pool
        except BaseException as error:
            pool.shutdown(cancel_futures=True)
            if isinstance(error, BrokenExecutor):
                found = "one that was killed; the finished tasks are kept"
                raise InputError("workers", "process", "one that runs to its end", found) from None
            raise


def run_tasks(
    executor: Executor,
    results: ResultsFile,
    ready_tasks: Callable[[Values], list[Task]],
    report: Callable[[str], None],
) -> None:
    """Run tasks until none is left, and write each result to the file when it arrives.

    Parameters
    ----------
    executor : Executor
        Any executor of `concurrent.futures`.
    results : ResultsFile
    ready_tasks : callable
        Takes the values by task name, and returns the tasks that can run now and have no value. It
        is called again when results have arrived, as they may make further tasks possible.
    report : callable
        Takes a line for each result.
    """
    running: dict[Future[TimedValue], Task] = {}
    while True:
        names = {task.name for task in running.values()}
        for task in ready_tasks(results.values):
            if task.name not in names:
                running[executor.submit(_run, task)] = task
        if not running:
            return
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            value, seconds = future.result()
            name = running.pop(future).name
            results.add(name, value, seconds)
            done = len(results.entries)
            report(f"[{done}/{done + len(running)}] {name}  {seconds:.1f} s")


def print_progress(line: str) -> None:
    """Write a line to stderr; a closed stderr does not end the work."""
    show(f"{line}\n", sys.stderr)


def _run(task: Task) -> TimedValue:
    started = time.perf_counter()
    value = task.function(**task.arguments)
    return value, time.perf_counter() - started

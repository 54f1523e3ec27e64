"""Who works on the runs of a sweep: processes here, a Dask cluster, or any other executor."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import closing, contextmanager
from typing import Any

from pe_core.search import start_processes
from pe_tools.cli.executors import named_workers, tell_without_processes


class LocalWorkers:
    """Processes on this machine that run the tasks of a sweep; a thread where there are none.

    Other workers have the same methods. The executor accepts tasks even after a worker's death.
    """

    reaches_folders = True
    """Whether the workers save checkpoints in the folders of the results."""

    def __init__(self, count: int) -> None:
        processes = start_processes(count)
        self._count = 1 if processes is None else count
        self.executor: Executor = processes or ThreadPoolExecutor(1)
        self.threads = max(1, (os.cpu_count() or 1) // self._count)
        """How many threads a task may use."""

    def width(self) -> int:
        """How many tasks are submitted at a time: a dead process tells which one killed it."""
        return self._count

    def check(self) -> None:
        """Raise `InputError` when the workers are gone; called several times a second."""

    def close(self) -> None:
        """Kill processes in the middle of their tasks; a thread finishes its task."""
        self.executor.shutdown(wait=self._count > 1, cancel_futures=True)


@contextmanager
def workplace(workers: int | None, executor: str | None) -> Iterator[Any]:
    """Open the worker pool that the command line asks for; close it at the end.

    `executor` is that of ``--executor``; None: processes here. `InputError` where no scheduler
    answers, a package is not installed, or what is named makes no executor.
    """
    count = workers or os.cpu_count() or 1
    if executor is None:
        tell_without_processes(count)
    place: Any = LocalWorkers(count) if executor is None else named_workers(executor, count)
    with closing(place):
        yield place

"""Runs the tasks in processes, a task a process, and keeps each result as it comes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from typing import Any

from . import tasks
from .effort import Effort
from .ledger import Ledger
from .plan import Task, plan

Tell = Callable[[str], None]


def run_all(effort: Effort, ledger: Ledger, workers: int | None, tell: Tell) -> None:
    """Run every task that the ledger does not know yet.

    Raises
    ------
    KeyboardInterrupt
        At Ctrl-C, once the processes are gone; what had been found is in the ledger.
    """
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers or os.cpu_count(), context, initializer=_be_quiet)
    running: dict[Future[tuple[dict[str, Any], float]], Task] = {}
    try:
        while True:
            busy = {task.name for task in running.values()}
            for task in plan(effort, ledger.values):
                if task.name not in busy:
                    running[pool.submit(_run, task.function, task.arguments)] = task
            if not running:
                return
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                task = running.pop(future)
                value, seconds = future.result()
                ledger.note(task.name, value, seconds)
                done = len(ledger.results)
                tell(f"[{done}/{done + len(running)}] {task.name}  {seconds:.1f} s")
    finally:
        for process in list(getattr(pool, "_processes", {}).values()) if running else []:
            process.terminate()
        pool.shutdown(cancel_futures=True)


def _run(function: str, arguments: dict[str, Any]) -> tuple[dict[str, Any], float]:
    started = time.perf_counter()
    value = tasks.FUNCTIONS[function](**arguments)
    return value, time.perf_counter() - started


def _be_quiet() -> None:
    """Leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

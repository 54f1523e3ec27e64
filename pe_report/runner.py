"""Runs the tasks in processes, a task a process, and keeps each result as it comes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any

from pe_core import InputError
from pe_core.search import live_as_long_as_the_parent

from . import tasks
from .ledger import Ledger
from .plan import Function, Task, plan

Tell = Callable[[str], None]
Plan = Callable[[Any, Mapping[str, Any]], list[Task]]
ENDING = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that ask a process to end; Windows has no SIGHUP."""


class Ended(KeyboardInterrupt):
    """The run ends now, because of a signal; `note` says what became of it."""

    def __init__(self, signum: int) -> None:
        super().__init__()
        self.signum, self.note = signum, ""


def run_all(
    effort: Any, ledger: Ledger, workers: int | None, tell: Tell, tasks_now: Plan = plan
) -> None:
    """Run every task that the ledger does not know yet.

    Parameters
    ----------
    effort : dataclass
        How much is computed: what `tasks_now` takes.
    ledger : Ledger
    workers : int or None
        Processes, no more than there are processors; None or 0 for as many.
    tell : callable
        Takes a line for each result.
    tasks_now : callable, optional
        Returns the tasks that can run, from the effort and the values known.

    Raises
    ------
    Ended
        At Ctrl-C, SIGTERM and SIGHUP, once the processes are gone; what had been found is in the
        ledger.
    InputError
        When a process was killed.
    """
    context = multiprocessing.get_context("spawn")
    processors = os.cpu_count() or 1
    pool = ProcessPoolExecutor(
        min(workers or processors, processors), context, initializer=live_as_long_as_the_parent
    )
    running: dict[Future[tuple[dict[str, Any], float]], Task] = {}
    with _signals_end():
        try:
            while _next_results(pool, running, ledger, tell, tasks_now(effort, ledger.values)):
                pass
        except BaseException as error:
            for process in list((getattr(pool, "_processes", None) or {}).values()):
                process.kill()
            if isinstance(error, BrokenProcessPool):
                found = "one that was killed; what is done is kept"
                raise InputError("workers", "process", "to run to its end", found) from None
            raise
        finally:
            pool.shutdown(cancel_futures=True)


def _next_results(
    pool: ProcessPoolExecutor,
    running: dict[Future[tuple[dict[str, Any], float]], Task],
    ledger: Ledger,
    tell: Tell,
    can_run: list[Task],
) -> bool:
    """Start what can run, keep what is done next; False when there is nothing left."""
    busy = {task.name for task in running.values()}
    for task in can_run:
        if task.name not in busy:
            running[pool.submit(_run, task.function, task.arguments)] = task
    if not running:
        return False
    for future in wait(running, return_when=FIRST_COMPLETED).done:
        value, seconds = future.result()
        task = running.pop(future)
        ledger.note(task.name, value, seconds)
        done = len(ledger.results)
        tell(f"[{done}/{done + len(running)}] {task.name}  {seconds:.1f} s")
    return True


@contextmanager
def _signals_end() -> Iterator[None]:
    """Raise `Ended` at Ctrl-C and at what else asks the process to end."""
    before = {}
    try:
        for number in _numbers():
            if number == signal.SIGINT or signal.getsignal(number) is not signal.SIG_IGN:  # nohup
                before[number] = signal.signal(number, _end)
    except ValueError:  # not the main thread: signals are someone else's
        yield
        return
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _numbers() -> list[signal.Signals]:
    return [getattr(signal, name) for name in ENDING if hasattr(signal, name)]


def _end(signum: int, _frame: object) -> None:
    raise Ended(signum)


def _run(function: Function | str, arguments: dict[str, Any]) -> tuple[dict[str, Any], float]:
    started = time.perf_counter()
    value = tasks.function_of(function)(**arguments)
    return value, time.perf_counter() - started

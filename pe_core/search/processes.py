"""Worker processes as an executor that can be started anywhere, inside Blender too."""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import resource_tracker
from types import ModuleType
from typing import Any, TypeVar

T = TypeVar("T")

START_S = 60.0
"""Processes that are not up by then never will be."""
ENDING = ("SIGINT", "SIGHUP")
"""Signals that a terminal sends to all processes at once; Windows has no SIGHUP.

SIGTERM is not among them: by it a pool ends those that are left when one has died, and waits until
they are gone."""

BEGIN = """
import sys, types
for name, folder in {packages!r}:
    if name not in sys.modules:
        sys.modules[name] = types.ModuleType(name)
        sys.modules[name].__path__ = [folder]
from importlib import import_module
import_module({here!r}).live_as_long_as_the_parent()
"""
"""What a process does first. Packages that hold the engine, as the add-on does inside Blender, are
not run in it: they get empty ones to stand for them. It is text, as nothing can be imported yet."""


class Processes(Executor):
    """Processes that judge candidates; one that died is replaced.

    Functions and arguments must not come from the main script, which workers do not run.

    Parameters
    ----------
    count : int
    """

    def __init__(self, count: int) -> None:
        self._count, self._lock = count, threading.Lock()
        self._pool = self._new_pool()

    def _new_pool(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        begin = BEGIN.format(packages=_packages_around(), here=__name__)
        with _signals_blocked():
            return ProcessPoolExecutor(self._count, context, exec, (begin,))

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Have a function called in a process; in a new one, if they broke down."""
        with self._lock, _without_main(), _signals_blocked():
            try:
                return self._pool.submit(fn, *args, **kwargs)
            except BrokenExecutor:
                self._pool = self._new_pool()
                return self._pool.submit(fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes; with `cancel_futures` in the middle of what they do."""
        processes = list((getattr(self._pool, "_processes", None) or {}).values())
        if cancel_futures:
            for process in processes:
                process.kill()
        self._pool.shutdown(wait, cancel_futures=cancel_futures)


def started(count: int | None = None) -> Processes | None:
    """Return processes that are up; None for one, and where none can be started.

    Parameters
    ----------
    count : int, optional
        How many; by default as many as there are processors.
    """
    count = count or os.cpu_count() or 1
    if count < 2:
        return None
    processes = Processes(count)
    try:
        if all(f.result(START_S) for f in [processes.submit(os.getpid) for _ in range(count)]):
            return processes
    except Exception:  # whatever a system has against processes: one will do
        pass
    processes.shutdown(wait=False, cancel_futures=True)
    return None


def live_as_long_as_the_parent() -> None:
    """In a worker: leave signals to the parent, and end with it, however it ends."""
    for name in ENDING:
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None
    threading.Thread(target=_end_after, args=(parent.sentinel,), daemon=True).start()


def _end_after(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(1)


def _packages_around() -> list[tuple[str, str]]:
    """Names of the packages that hold the engine, outermost first, and the folder in each."""
    names = __name__.split(".")[:-3]  # the engine, its room, and this module come last
    found = []
    for number in range(1, len(names) + 1):
        inner = import_module(".".join(__name__.split(".")[: number + 1]))
        found.append((".".join(names[:number]), os.path.dirname(inner.__path__[0])))
    return found


@contextmanager
def _without_main() -> Iterator[None]:
    """Hide the main script from processes that start: they would run it, in no Blender."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextmanager
def _signals_blocked() -> Iterator[None]:
    """Have processes that start meanwhile begin with the signals of `ENDING` blocked.

    A terminal sends these to all processes at once, also to one that is not far enough to ignore
    them: a worker would end in the middle of an import, with a traceback. The process that keeps
    account of semaphores is started here, too: it ignores all of them but SIGHUP.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows has no such signals
        yield
        return
    numbers = {getattr(signal, name) for name in ENDING}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        resource_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, numbers)  # that has unblocked SIGINT
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)

"""Worker processes as an executor: they can be started anywhere, inside Blender too."""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from importlib import import_module
from multiprocessing import resource_tracker
from types import ModuleType
from typing import Any, TypeVar

from ..base.errors import InputError
from ..base.files import finish_writing
from .payload import Unreadable, keep_freed_memory, receive, send_payload

T = TypeVar("T")

START_S = 60.0
"""Processes that are not up after this time never will be."""
SHORT_S = 2.0
"""A search that ends within this time needs no processes: starting them takes as long."""
TERMINAL_SIGNALS = ("SIGINT", "SIGHUP")
"""Signals that a terminal sends to all processes at once; Windows has no SIGHUP.

SIGTERM is not among them: a pool in which one process died ends the others by it, and waits until
they are gone."""

INITIALIZER = """
import sys, types
for name, folder in {packages!r}:
    if name not in sys.modules:
        sys.modules[name] = types.ModuleType(name)
        sys.modules[name].__path__ = [folder]
from importlib import import_module
import_module({here!r}).begin_worker(*payload)
"""
"""The first code that a worker process runs. Packages that contain the engine, as the add-on does
inside Blender, are not run in it: empty packages stand for them. It is text, because nothing can be
imported yet."""


class Processes(Executor):
    """Worker processes as an executor; processes that died are replaced.

    Functions and arguments must not come from the main script, which workers do not run.
    `payload.send_payload` gives them what tasks have in common. `InputError` is raised where this
    system has nothing that processes wait for each other with (`no_processes`).
    """

    def __init__(self, count: int) -> None:
        self._count, self._lock = count, threading.Lock()
        self._payload: tuple[str, bytes] | None = None
        self._pool = self._new_pool()

    def _new_pool(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        initializer = INITIALIZER.format(packages=_packages_around(), here=__name__)
        with _signals_blocked():
            names = {"payload": self._payload or ()}
            try:
                return ProcessPoolExecutor(self._count, context, exec, (initializer, names))
            except (ImportError, NotImplementedError, OSError) as error:
                expected = "semaphores of the system, which Linux keeps in /dev/shm"
                raise InputError("workers", "process", expected, _why(error)) from None

    def start_with(self, key: str, data: bytes) -> None:
        """Have all processes start with a payload; those that run without it are replaced."""
        with self._lock:
            if self._payload is not None and self._payload[0] == key:
                return
            self._payload = key, data
            self._pool.shutdown(wait=False)  # tasks under way run to their end
            self._pool = self._new_pool()

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Call a function in a process; start new processes if the pool is broken."""
        with self._lock, _without_main(), _signals_blocked():
            try:
                return self._pool.submit(fn, *args, **kwargs)
            except BrokenExecutor:
                self._pool = self._new_pool()
                return self._pool.submit(fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes; with `cancel_futures` in the middle of their tasks."""
        processes = list((getattr(self._pool, "_processes", None) or {}).values())
        if cancel_futures:
            for process in processes:
                process.kill()
        self._pool.shutdown(wait, cancel_futures=cancel_futures)


def no_processes() -> str:
    """Return why no worker process can be started here; empty where nothing is known against it.

    Processes wait for each other with semaphores. Linux keeps them in /dev/shm, which may be
    missing in a container, or not writable.
    """
    if "fork" not in multiprocessing.get_all_start_methods():
        return ""  # no semaphore is to be had without the process that tracks them
    try:
        multiprocessing.get_context("fork").Semaphore()
    except (ImportError, OSError) as error:
        return f"semaphores in /dev/shm: {_why(error)}"
    return ""


def _why(error: Exception) -> str:
    return (getattr(error, "strerror", None) or str(error)).lower()


def start_processes(count: int | None = None, common: Iterable[object] = ()) -> Processes | None:
    """Start processes and wait until they are up; None for a count of 1, or if none can be started.

    `count` is by default that of the processors. `common` is what tasks have in common, such as
    objectives and models of sensors; other objects are sent when they are first needed, to
    processes that are started anew.
    """
    count = count or os.cpu_count() or 1
    if count < 2 or no_processes():
        return None
    processes = Processes(count)
    try:
        with suppress(Unreadable):  # tasks that need these objects are not sent to processes
            send_payload(processes, common)
        if all(f.result(START_S) for f in [processes.submit(os.getpid) for _ in range(count)]):
            return processes
    except Exception:  # whatever prevents processes on this system: this one suffices
        pass
    processes.shutdown(wait=False, cancel_futures=True)
    return None


class LazyProcesses:
    """Processes for a search that takes longer than `SHORT_S`; None until they are up.

    Parameters as those of `start_processes`; `common` is read when they start.
    """

    def __init__(self, count: int | None = None, common: Iterable[object] = ()) -> None:
        self._count, self._common, self._began = count, common, time.monotonic()
        self._thread: threading.Thread | None = None
        self._processes: Processes | None = None
        self._ended = False

    def __call__(self) -> Executor | None:
        """Return the processes; the first call after `SHORT_S` begins to start them."""
        late = time.monotonic() - self._began > SHORT_S
        if late and self._thread is None and not self._ended:
            self._thread = threading.Thread(target=self._start, daemon=True)
            self._thread.start()
        return self._processes

    def end(self) -> None:
        """Kill the processes, in the middle of their tasks."""
        self._ended = True
        if self._processes is not None:
            self._processes.shutdown(wait=False, cancel_futures=True)

    def _start(self) -> None:
        self._processes = start_processes(self._count, self._common)
        if self._ended:
            self.end()


def begin_worker(key: str = "", data: bytes = b"") -> None:
    """In a worker: keep the payload, leave signals to the parent process, and end with it."""
    receive(key, data)
    keep_freed_memory()
    if hasattr(signal, "pthread_sigmask"):  # blocked until now: see `_signals_blocked`
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGTERM])
    for name in TERMINAL_SIGNALS:
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)

    def end_with_parent() -> None:
        parent = multiprocessing.parent_process()
        assert parent is not None
        multiprocessing.connection.wait([parent.sentinel])
        finish_writing()
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()


def _packages_around() -> list[tuple[str, str]]:
    """Names of the packages that contain the engine, outermost first, and the folder of each."""
    names = __name__.split(".")[:-3]  # the engine, its room, and this module come last
    packages = []
    for number in range(1, len(names) + 1):
        inner = import_module(".".join(__name__.split(".")[: number + 1]))
        packages.append((".".join(names[:number]), os.path.dirname(inner.__path__[0])))
    return packages


@contextmanager
def _without_main() -> Iterator[None]:
    """Hide the main script from processes that start: they would run it, outside Blender."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextmanager
def _signals_blocked() -> Iterator[None]:
    """Hold SIGTERM and `TERMINAL_SIGNALS` back here, and block them in processes started meanwhile.

    A handler that raises in the middle of `submit` would leave a lock of the pool taken, for which
    its thread then waits for ever. A terminal sends its signals to all processes at once, also to
    one that does not ignore them yet: a worker would end in the middle of an import, with a
    traceback. The process that tracks semaphores is started here, too: it ignores all but SIGHUP.
    """
    names = ("SIGTERM", *TERMINAL_SIGNALS)
    numbers = {getattr(signal, name) for name in names if hasattr(signal, name)}
    with _handlers_held(numbers):
        if not hasattr(signal, "pthread_sigmask"):  # Windows blocks no signals
            yield
            return
        before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
        try:
            resource_tracker.ensure_running()
            signal.pthread_sigmask(signal.SIG_BLOCK, numbers)  # ensure_running has unblocked SIGINT
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _handlers_held(numbers: Iterable[int]) -> Iterator[None]:
    """Call Python's handlers of signals after the block.

    To block signals is not enough: another thread then gets them, and Python calls their handlers
    in the main thread all the same; in other threads never.
    """
    here = threading.current_thread() is threading.main_thread()
    before = {n: signal.getsignal(n) for n in numbers if here and callable(signal.getsignal(n))}
    came: list[int] = []
    try:
        for number in before:
            signal.signal(number, lambda number, _: came.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)

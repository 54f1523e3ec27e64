"""Worker processes as an executor: they can be started anywhere, inside Blender too."""

import multiprocessing
import os
import time
from collections.abc import Callable, Iterable
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import suppress
from typing import Any, TypeVar

from ..base.errors import InputError
from ..base.lazy_threads import threads
from ..base.spawning import (
    beginning,
    belong_to_parent,
    packages_around,
    starting_processes,
    without_main,
)
from .payload import Unreadable, receive, send_payload

T = TypeVar("T")

START_S = 60.0  # Processes that are not up after this time never will be
SHORT_S = 2.0
"""A search that ends within this time needs no processes: starting them takes as long."""


class Processes(Executor):
    """Worker processes as an executor; processes that died are replaced.

    Functions and arguments must not come from the main script, which workers do not run.
    `payload.send_payload` gives them what tasks have in common. `InputError` is raised where this
    system has nothing that processes wait for each other with (`no_processes`).
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._lock = threads().RLock()
        self._payload: tuple[str, bytes] | None = None
        self._pool = self._new_pool()

    def _new_pool(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        begun = beginning(__name__, "begin_worker", packages_around())
        with starting_processes():
            try:
                return ProcessPoolExecutor(
                    self._count, context, exec, (begun, {"arguments": self._payload or ()})
                )
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
        with self._lock, without_main(), starting_processes():
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
    missing in a container, or not writable."""
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
    """Processes for a search that takes longer than `SHORT_S`; None until they are up. Parameters
    as those of `start_processes`; `common` is read when they start."""

    def __init__(self, count: int | None = None, common: Iterable[object] = ()) -> None:
        self._count = count
        self._common = common
        self._began = time.monotonic()
        self._thread: Any = None
        self._processes: Processes | None = None
        self._ended = False

    def __call__(self) -> Executor | None:
        """Return the processes; the first call after `SHORT_S` begins to start them."""
        late = time.monotonic() - self._began > SHORT_S
        if late and self._thread is None and not self._ended:
            self._thread = threads().Thread(target=self._start, daemon=True)
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
    threads().keep_freed_memory()
    belong_to_parent()

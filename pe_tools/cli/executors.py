"""Executors of runs and of candidates: processes here, a Dask cluster, or any other executor."""

import importlib
import os
import re
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import closing, contextmanager, suppress
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.lazy_threads import threads
from pe_core.base.plugins import required_package
from pe_core.search import no_processes
from pe_core.search.payload import plugin_name

from ..jobs import Job
from ..sweep import LocalWorkers
from .terminal import tell

FUNCTION = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")
"""Name of a function in a module; no address has one, as its port is a number."""
ADDRESS = re.compile(r"((tcp|tls)://)?[^/@\s]+:[0-9]{1,5}")
"""Address with a protocol that Dask supports without further libraries."""
NO_SCHEDULER = "a peer that is no scheduler"
CONNECT_S = 5.0  # Time limit for the scheduler's answer [s]


@contextmanager
def workplace(workers: int | None, executor: str | None) -> Iterator[LocalWorkers]:
    """Open the worker pool that the command line asks for; close it at the end. `executor` is that
    of ``--executor``; None: processes here. `InputError` where no scheduler answers, a package is
    not installed, or what is named makes no executor."""
    count = workers or os.cpu_count() or 1
    if executor is None:
        _tell_without_processes(count)
    with closing(LocalWorkers(count) if executor is None else _named(executor, count)) as place:
        yield place


def _named(executor: str, count: int) -> LocalWorkers:
    """Return the workers of ``dask://HOST:PORT`` or of ``MODULE:FUNCTION``."""
    if FUNCTION.fullmatch(executor):
        return ExecutorWorkers(executor, count)
    return DaskWorkers(executor.removeprefix("dask://"))


@contextmanager
def evaluated_by(job: Job, executor: str | None) -> Iterator[None]:
    """Have the workers of an executor evaluate a job's candidates meanwhile; None: processes.
    `InputError` as in `workplace`."""
    if executor is None:
        _tell_without_processes(job.workers)
        yield
        return
    with closing(_named(executor, job.workers or os.cpu_count() or 1)) as workers:
        workers.check()
        job.executor = workers.executor
        yield


def _tell_without_processes(count: int | None) -> None:
    """Print one line where several workers are wanted and this system has no processes for them."""
    if count != 1 and (reason := no_processes()):
        tell(f"one processor does the work of all: no worker processes here ({reason})")


class ExecutorWorkers(LocalWorkers):
    """The workers of an executor that a function of the user's returns. They may be on other
    machines: they reach no folder of ours."""

    reaches_folders = False
    threads = 1

    def __init__(self, named: str, count: int) -> None:
        module, function = named.split(":")
        if os.getcwd() not in sys.path:
            sys.path.append(os.getcwd())  # last: a file beside the study replaces no other module
        try:
            made = getattr(importlib.import_module(module), function)()
        except Exception as error:  # whatever a module of the user's raises
            told = " ".join(f"{type(error).__name__}: {error}".split())
            raise InputError("command line", "executor", f"{named} to return one", told) from None
        if not isinstance(made, Executor):
            expected = "a function that returns a concurrent.futures.Executor"
            raise InputError("command line", "executor", expected, shown(type(made).__name__))
        self.executor = made
        self._count = count

    def width(self) -> int:
        """Two tasks for each worker that ``--workers`` names."""
        return 2 * self._count


class DaskWorkers(LocalWorkers):
    """The worker pool of a Dask scheduler; its workers reach no folder of ours."""

    reaches_folders = False
    threads = 1  # Threads of one score: a Dask worker runs one task in each of its threads

    def __init__(self, address: str) -> None:
        self._address = address
        self._client = _client_of(address)
        self._alone = False
        self.executor = self._client.get_executor(pure=False)

    def width(self) -> int:
        """Two tasks for each thread, so that no thread waits for its next task."""
        return 2 * max(1, self._thread_count())

    def check(self) -> None:
        """Print a message, once, if there are no workers. `InputError` where the scheduler is
        gone."""
        if self._client.status == "closed":
            expected = "a scheduler that runs until the end"
            found = "that it is gone; what is done is kept"
            raise InputError(self._address, "scheduler", expected, found)
        alone = self._client.status == "running" and not self._thread_count()
        if alone and not self._alone:
            need = "they need this version of perception-entropy"
            tell(f"{self._address}: no workers; waiting for some ({need})")
        self._alone = alone

    def _thread_count(self) -> int:
        """Return the number of threads of all workers."""
        try:
            return sum(self._client.nthreads().values())
        except Exception:  # any error of the connection; `check` reports a lost scheduler
            return 1

    def close(self) -> None:
        """Disconnect from the cluster, which continues to run and keeps no payload."""
        if self._client.status == "running":
            with suppress(Exception):  # none was sent, or the scheduler ends meanwhile
                self._client.unregister_worker_plugin(plugin_name(self._client))
        self._client.close(timeout=CONNECT_S)


def _client_of(address: str) -> Any:
    import asyncio
    import logging

    distributed = required_package("distributed")
    if not ADDRESS.fullmatch(address):
        expected = "dask://HOST:PORT, tcp://HOST:PORT, tls://HOST:PORT or MODULE:FUNCTION"
        raise InputError("command line", "executor", expected, shown(address))
    for name in list(logging.root.manager.loggerDict):  # lost connections are reported here
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        _within(CONNECT_S, lambda: asyncio.run(_asked_scheduler(distributed, address)))
        return distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
    except Exception as error:  # an unknown name, a closed port, tls without certificates
        told = str(error).splitlines() or [type(error).__name__]
        expected = f"a scheduler that answers within {CONNECT_S:g} s"
        raise InputError(address, "scheduler", expected, told[0]) from None


async def _asked_scheduler(distributed: Any, address: str) -> None:
    """Ask a peer what it is; raise where it is no scheduler. A client of Dask that finds none keeps
    the process from ending, and reports that itself."""
    options = distributed.Security().get_connection_args("client")
    comm = await distributed.core.connect(address, timeout=CONNECT_S, **options)
    try:
        peer = await distributed.core.send_recv(comm, op="identity", reply=True)
    finally:
        comm.abort()
    if not isinstance(peer, dict) or peer.get("type") != "Scheduler":
        raise TimeoutError(NO_SCHEDULER)


def _within(limit_s: float, call: Callable[[], Any]) -> Any:
    """Return what a function returns; `TimeoutError` where it takes longer. Dask's own limit does
    not hold where a peer takes the connection and says nothing that a scheduler says."""
    answer: Future[Any] = Future()

    def run() -> None:
        try:
            answer.set_result(call())
        except BaseException as error:
            answer.set_exception(error)

    threads().Thread(target=run, daemon=True).start()  # nobody waits for it at the end
    try:
        return answer.result(limit_s)
    except TimeoutError as error:
        raise TimeoutError(str(error) or NO_SCHEDULER) from None

"""Executors for the runs of a sweep: processes here, or a Dask cluster and its checkpoints."""

from __future__ import annotations

import asyncio
import logging
import os
import queue
import re
import secrets
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.plugins import EXTRAS, optional_package
from pe_core.scene import Pose
from pe_core.search import EvaluatedRig, Journal, no_processes
from pe_core.search.payload import plugin_name
from pe_core.study import Study

from ..jobs import Checkpoint, Job, OptimizeJob, ScoreJob, SearchState, read_search
from ..sweep import LocalWorkers, SweepRun
from .terminal import tell


@dataclass(frozen=True, slots=True)
class PostedCheckpoints:
    """Checkpoints that a worker posts to a topic of the scheduler.

    `known` is the journal of an earlier part of the search.
    """

    topic: str
    run: str
    known: tuple[EvaluatedRig, ...] = ()

    def begin(self, job: OptimizeJob) -> Callable[[], None]:
        """Resume the search from the known journal; return a function that posts new entries."""
        job.journal = Journal(self.known, self.run)
        distributed = optional_package("distributed")
        assert distributed is not None, "a worker of Dask runs this"
        checkpoint, worker, posted = Checkpoint(job), distributed.get_worker(), len(self.known)

        def post() -> None:
            nonlocal posted
            if checkpoint.due():
                entries = job.journal.entries
                evaluated = [list(entry) for entry in entries[posted:]]
                poses = [[list(s.pose.position), list(s.pose.rpy)] for s in job.best.rig]
                event = {"run": self.run, "start": posted, "evaluated": evaluated, "best": poses}
                worker.log_event(self.topic, event)
                posted = len(entries)

        return post


class _RunSearch:
    """The search of a run, with the journal entries received so far; at first those in its folder.

    A folder may have none, or those of another study.
    """

    def __init__(self, study: Study, folder: Path) -> None:
        self.study, self.folder, self.best = study, folder, study
        self.state, self.meshes_saved = SearchState(study), False
        self.entries: list[EvaluatedRig] = []
        with suppress(InputError):
            self.entries += read_search(folder).journal_of(study).entries

    def add(self, event: Mapping[str, Any]) -> None:
        """Add journal entries of an event; a restarted search sends the same entries again."""
        if event["start"] <= len(self.entries):
            new = [EvaluatedRig(float(e), bool(b), str(m)) for e, b, m in event["evaluated"]]
            self.entries[event["start"] : event["start"] + len(new)] = new
            poses = [Pose(tuple(at), tuple(rpy)) for at, rpy in event["best"]]
            self.best = self.study.with_rig(self.study.rig.with_poses(poses))

    def save(self) -> None:
        """Write the checkpoint into the run's folder."""
        with suppress(InputError):  # the search continues; its results are written elsewhere
            self.state.save(self.folder, self.best, self.entries, meshes=not self.meshes_saved)
            self.meshes_saved = True


ADDRESS = re.compile(r"((tcp|tls)://)?[^/@\s]+:[0-9]{1,5}")
"""Address with a protocol that Dask supports without further libraries."""
CONNECT_S = 5.0
"""Time limit for the scheduler's answer [s]."""


@contextmanager
def workplace(workers: int | None, scheduler: str | None) -> Iterator[LocalWorkers]:
    """Open the worker pool that the command line asks for; close it at the end.

    `InputError` where no scheduler answers, or the package for it is not installed.
    """
    count = workers or os.cpu_count() or 1
    if scheduler is None:
        _tell_without_processes(count)
    with closing(LocalWorkers(count) if scheduler is None else DaskWorkers(scheduler)) as place:
        yield place


@contextmanager
def evaluated_by(job: Job, scheduler: str | None) -> Iterator[None]:
    """Have the workers of a Dask scheduler evaluate a job's candidates meanwhile; None: processes.

    `InputError` as in `workplace`.
    """
    if scheduler is None:
        if not isinstance(job, ScoreJob):
            _tell_without_processes(job.workers)
        yield
        return
    with closing(DaskWorkers(scheduler)) as workers:
        workers.check()
        job.executor = workers.executor
        yield


def _tell_without_processes(count: int | None) -> None:
    """Print one line where several workers are wanted and this system has no processes for them."""
    if count != 1 and (reason := no_processes()):
        tell(f"one processor does the work of all: no worker processes here ({reason})")


class DaskWorkers(LocalWorkers):
    """The worker pool of a Dask scheduler; it receives and saves the checkpoints of all runs."""

    threads = 1
    """Threads of one score: a Dask worker runs one task in each of its threads."""

    def __init__(self, address: str) -> None:
        self._address, self._client, self._alone = address, _client_of(address), False
        self.executor = self._client.get_executor(pure=False)
        self._topic = f"perception-entropy-{secrets.token_hex(8)}"
        self._events: queue.SimpleQueue[Mapping[str, Any]] = queue.SimpleQueue()
        self._searches: dict[str, _RunSearch] = {}
        # The client calls this in its own thread.
        self._client.subscribe_topic(self._topic, lambda event: self._events.put(event[1]))

    def width(self) -> int:
        """Two tasks for each thread, so that no thread waits for its next task."""
        return 2 * max(1, self._thread_count())

    def check(self) -> None:
        """Save received checkpoints; print a message, once, if there are no workers.

        `InputError` where the scheduler is gone.
        """
        changed = {}
        with suppress(queue.Empty):
            while True:
                event = self._events.get_nowait()
                if search := self._searches.get(event["run"]):
                    changed[event["run"]] = search
                    search.add(event)
        for search in changed.values():
            search.save()
        if self._client.status == "closed":
            expected = "a scheduler that runs until the end"
            found = "that it is gone; what is done is kept"
            raise InputError(self._address, "scheduler", expected, found)
        alone = self._client.status == "running" and not self._thread_count()
        if alone and not self._alone:
            need = "they need this version of perception-entropy"
            tell(f"{self._address}: no workers; waiting for some ({need})")
        self._alone = alone

    def checkpoints(self, run: SweepRun, folder: Path) -> PostedCheckpoints:
        """Return checkpoints that the worker, maybe remote, sends here to be saved.

        They begin with those in the folder of the run.
        """
        if run.name not in self._searches:
            self._searches[run.name] = _RunSearch(run.study, folder)
        return PostedCheckpoints(self._topic, run.name, tuple(self._searches[run.name].entries))

    def finish(self, name: str) -> None:
        """Forget a run whose result is here: events that come later do not replace its state."""
        self._searches.pop(name, None)

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
    distributed = optional_package("distributed")
    if distributed is None:
        expected = f'distributed: pip install "perception-entropy[{EXTRAS["distributed"]}]"'
        raise InputError("command line", "scheduler", expected, "it is not installed")
    if not ADDRESS.fullmatch(address):
        expected = "HOST:PORT, tcp://HOST:PORT or tls://HOST:PORT"
        raise InputError("command line", "scheduler", expected, shown(address))
    for name in list(logging.root.manager.loggerDict):  # lost connections are reported here
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        _require_scheduler(distributed, address)
        return distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
    except Exception as error:  # an unknown name, a closed port, tls without certificates
        told = str(error).splitlines() or [type(error).__name__]
        expected = f"a scheduler that answers within {CONNECT_S:g} s"
        raise InputError(address, "scheduler", expected, told[0]) from None


def _require_scheduler(distributed: Any, address: str) -> None:
    """Raise an error unless a scheduler answers in time.

    A client waits ten minutes for a peer that is none, without an ear for signals, and one that
    failed to connect reports that once more when it is deleted. So it is made for a scheduler only.
    """

    async def kind_of_peer() -> str:
        security = distributed.Security().get_connection_args("client")
        comm = await distributed.comm.connect(address, timeout=CONNECT_S, **security)
        try:
            await comm.write({"op": "identity", "reply": True})
            answer = await comm.read()
        finally:
            comm.abort()
        return str(answer.get("type")) if isinstance(answer, Mapping) else ""

    # A thread of its own: a notebook, or whatever calls this, may have a loop that runs already.
    with ThreadPoolExecutor(1) as thread:
        try:
            kind = thread.submit(asyncio.run, asyncio.wait_for(kind_of_peer(), CONNECT_S)).result()
        except TimeoutError as error:
            raise TimeoutError(str(error) or "no answer") from None
    if kind != "Scheduler":
        raise ValueError(f"a {kind}" if kind.isidentifier() else "another program")

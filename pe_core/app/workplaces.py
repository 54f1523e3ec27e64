"""Where the runs of a sweep are carried out: processes here, or a Dask cluster."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import InputError, shown
from ..search import started
from ..sweep import FolderCheckpoints, RunCheckpoints, SweepRun, Workplace
from .cluster_checkpoints import ClusterCheckpoints
from .extras import EXTRAS, extra
from .terminal import tell

ADDRESS = re.compile(r"((tcp|tls)://)?[^/\s]+:[0-9]{1,5}")
"""Of the protocols that Dask has without further libraries."""
CONNECT_S = 5.0
"""A scheduler that has not answered by then is not there."""


@contextmanager
def workplace(workers: int | None, scheduler: str | None) -> Iterator[Workplace]:
    """Open the workplace that the command line asks for; at the end its work is given up.

    Raises
    ------
    InputError
        When no scheduler answers, or the package for it is not installed.
    """
    place = Here(workers or os.cpu_count() or 1) if scheduler is None else DaskWorkers(scheduler)
    try:
        yield place
    finally:
        place.close()


class Here:
    """Processes of this machine; where none can be started, a thread."""

    def __init__(self, count: int) -> None:
        processes = started(count)
        self._count = 1 if processes is None else count
        self.executor: Executor = processes or ThreadPoolExecutor(1)
        self.threads = max(1, (os.cpu_count() or 1) // self._count)

    def width(self) -> int:
        """One each: which of more was the death of a process could not be told."""
        return self._count

    def check(self) -> None:
        """It is always there."""

    def checkpoints(self, run: SweepRun, folder: Path) -> RunCheckpoints:
        """Have the process save them in the folder itself."""
        return FolderCheckpoints(folder)

    def close(self) -> None:
        """End the processes, in the middle of what they do."""
        processes = self._count > 1  # they are killed; a thread goes on to the end of what it does
        self.executor.shutdown(wait=processes, cancel_futures=True)


class DaskWorkers:
    """The workers of a Dask scheduler."""

    threads = 1
    """Of a score: workers have as many tasks at a time as they have threads."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._client = _client_of(address)
        self.executor: Executor = self._client.get_executor(pure=False)
        self._alone = False
        self._saved = ClusterCheckpoints(self._client)

    def width(self) -> int:
        """Two for each thread, so that none waits for the next."""
        return 2 * max(1, self._count())

    def check(self) -> None:
        """Save the checkpoints that have come; tell, once, that there are no workers.

        Raises
        ------
        InputError
            The scheduler is gone.
        """
        self._saved.save()
        if self._client.status == "closed":
            found = "that it is gone; what is done is kept"
            raise InputError(self._address, "scheduler", "one that stays until the end", found)
        alone = self._client.status == "running" and not self._count()
        if alone and not self._alone:
            need = "they need this version of perception-entropy"
            tell(f"{self._address}: no workers; waiting for some ({need})")
        self._alone = alone

    def checkpoints(self, run: SweepRun, folder: Path) -> RunCheckpoints:
        """Have the worker, which may be another machine, send them here to be saved."""
        return self._saved.for_run(run, folder)

    def _count(self) -> int:
        """How many threads its workers have."""
        try:
            return sum(self._client.nthreads().values())
        except (
            Exception
        ):  # whatever a connection breaks with; a scheduler that is gone, `check` tells
            return 1

    def close(self) -> None:
        """Leave the cluster; it goes on without us."""
        self._client.close(timeout=CONNECT_S)


def _client_of(address: str) -> Any:
    distributed = extra("distributed")
    if distributed is None:
        expected = f'distributed: pip install "perception-entropy[{EXTRAS["distributed"]}]"'
        raise InputError("command line", "scheduler", expected, "that it is not installed")
    if not ADDRESS.fullmatch(address):
        raise InputError(
            "command line",
            "scheduler",
            "HOST:PORT, tcp://HOST:PORT or tls://HOST:PORT",
            shown(address),
        )
    _hush()
    try:
        return distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
    except Exception as error:  # of an address that is none, a name or a port that nobody has
        told = str(error).splitlines() or [type(error).__name__]
        expected = f"a scheduler that answers within {CONNECT_S:g} s"
        raise InputError(address, "scheduler", expected, told[0]) from None


def _hush() -> None:
    """Keep its log from the terminal: what is lost, we tell ourselves."""
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)

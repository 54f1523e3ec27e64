"""Processes that help a search on, once it turns out to be a long one."""

from __future__ import annotations

import threading
import time
from concurrent.futures import Executor

from ..search import Processes, started

SHORT_S = 2.0
"""A search that is over by then is done by one process: to start others takes as long."""


class Helpers:
    """An executor for a search that goes on for longer than a moment; None until it is there.

    Parameters
    ----------
    count : int, optional
        How many processes; by default as many as there are processors, 1: none.
    """

    def __init__(self, count: int | None = None) -> None:
        self._count, self._began = count, time.monotonic()
        self._thread: threading.Thread | None = None
        self._processes: Processes | None = None
        self._ended = False

    def __call__(self) -> Executor | None:
        """Return the processes; begin to start them when it is time."""
        late = time.monotonic() - self._began > SHORT_S
        if late and self._thread is None and not self._ended:
            self._thread = threading.Thread(target=self._start, daemon=True)
            self._thread.start()
        return self._processes

    def end(self) -> None:
        """End the processes, whatever they are at."""
        self._ended = True
        if self._processes is not None:
            self._processes.shutdown(wait=False, cancel_futures=True)

    def _start(self) -> None:
        self._processes = started(self._count)
        if self._ended:
            self.end()

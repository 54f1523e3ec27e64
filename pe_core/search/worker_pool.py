"""The worker pool: tasks on the workers of any `concurrent.futures.Executor`.

Workers may be processes, threads or a cluster. A task whose worker died is run once more; if that
worker dies too, the task is named.
"""

from __future__ import annotations

import sys
import traceback
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

TaskKey = TypeVar("TaskKey", bound=Hashable)


@dataclass(frozen=True, slots=True)
class _Reply:
    """The reply of a worker: a result or an error.

    An error is returned, not raised: an exception of a future means that its worker died.
    """

    result: Any = None
    error: Exception | None = None


class Call(NamedTuple):
    """What a worker runs: a function that it can import, and arguments that can be pickled."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class WorkerDied:
    """In place of a result: both workers that ran the task died; `reason` is the last error."""

    reason: str


def run_tasks(
    executor: Executor,
    waiting: deque[TaskKey],
    call_of: Callable[[TaskKey], Call],
    width: Callable[[], int] = lambda: sys.maxsize,
    wait_s: float | None = None,
) -> Generator[list[tuple[TaskKey, Any | WorkerDied]], None, None]:
    """Run tasks on the workers of an executor; yield lists of items with their results.

    A task whose worker died is run once more, alone, after all others: which of several tasks
    killed a worker cannot be known before.

    Parameters
    ----------
    executor : concurrent.futures.Executor
        After a worker's death it still accepts tasks, as `Processes` does.
    waiting : deque
        Items that stand for the tasks. Items that are appended meanwhile are run as well.
    call_of : callable
        From an item to the call. It is called when a worker is free, and again for a second
        attempt.
    width : callable, optional
        How many tasks are submitted at a time; all, by default.
    wait_s : float, optional
        When no task completes for so long, an empty list is yielded, so that the caller can check
        whether to continue [s].

    Raises
    ------
    Exception
        What a call raises in its worker.
    """
    run = _TaskRun(executor, call_of)
    try:
        while waiting:
            yield from run.completed(waiting, width, wait_s)
            for item in run.take_died():
                yield from run.completed(deque([item]), lambda: 1, wait_s)
                if run.died:
                    yield [(item, WorkerDied(run.died.pop(item)))]
    finally:
        for future in run.running:
            future.cancel()


class _TaskRun(Generic[TaskKey]):
    """Tasks under way."""

    def __init__(self, executor: Executor, call_of: Callable[[TaskKey], Call]) -> None:
        self._executor, self._call_of = executor, call_of
        self._order: dict[TaskKey, int] = {}
        self.running: dict[Future[_Reply], TaskKey] = {}
        self.died: dict[TaskKey, str] = {}

    def take_died(self) -> list[TaskKey]:
        """Return the items whose worker died, in the order of submission, and forget them."""
        items, self.died = sorted(self.died, key=self._order.__getitem__), {}
        return items

    def completed(
        self, waiting: deque[TaskKey], width: Callable[[], int], wait_s: float | None
    ) -> Iterator[list[tuple[TaskKey, Any]]]:
        """Submit the waiting tasks; yield lists of results as they arrive, which may be empty."""
        while waiting or self.running:
            while waiting and len(self.running) < width():
                self._submit(waiting.popleft())
            done = wait(self.running, wait_s, FIRST_COMPLETED).done
            yield [completed for future in done for completed in self._take(future)]

    def _submit(self, item: TaskKey) -> None:
        self._order.setdefault(item, len(self._order))
        function, arguments = self._call_of(item)
        try:
            future = self._executor.submit(_replied, function, *arguments)
        except (RuntimeError, OSError) as error:  # the executor is broken, or was shut down
            self.died[item] = type(error).__name__
            return
        self.running[future] = item

    def _take(self, future: Future[_Reply]) -> Iterator[tuple[TaskKey, Any]]:
        item = self.running.pop(future)
        try:
            reply = future.result()
        except Exception as error:  # each executor reports a dead worker in its own way
            self.died[item] = type(error).__name__
            return
        if reply.error is not None:
            raise reply.error
        yield item, reply.result


def _replied(function: Callable[..., Any], *arguments: Any) -> _Reply:
    """Call a function in a worker; an error keeps its traceback as a note."""
    try:
        return _Reply(function(*arguments))
    except Exception as error:
        error.add_note("".join(traceback.format_exception(error)))
        return _Reply(error=error)

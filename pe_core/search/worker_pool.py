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
from typing import Any, NamedTuple, TypeVar

TaskKey = TypeVar("TaskKey", bound=Hashable)


class _Reply(NamedTuple):
    """What a worker answers: an error is returned, as an exception means that its worker died."""

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

    `waiting` has items that stand for the tasks; those that are appended meanwhile are run as well.
    `call_of` makes an item's call when a worker is free, at most `width` at a time. When no task
    completes for `wait_s`, an empty list is yielded, so that the caller can check whether to go on.

    A task whose worker died is run once more, alone, after all others: which of several tasks
    killed a worker cannot be known before. After a worker's death the executor still accepts tasks,
    as `Processes` does. What a call raises in its worker is raised here.
    """
    order: dict[TaskKey, int] = {}
    running: dict[Future[_Reply], TaskKey] = {}
    died: dict[TaskKey, str] = {}

    def submit(item: TaskKey) -> None:
        order.setdefault(item, len(order))
        function, arguments = call_of(item)
        try:
            running[executor.submit(_replied, function, *arguments)] = item
        except (RuntimeError, OSError) as error:  # the executor is broken, or was shut down
            died[item] = type(error).__name__

    def taken(future: Future[_Reply]) -> Iterator[tuple[TaskKey, Any]]:
        item = running.pop(future)
        try:
            reply = future.result()
        except Exception as error:  # each executor reports a dead worker in its own way
            died[item] = type(error).__name__
            return
        if reply.error is not None:
            raise reply.error
        yield item, reply.result

    def completed(
        items: deque[TaskKey], width: Callable[[], int]
    ) -> Iterator[list[tuple[TaskKey, Any]]]:
        while items or running:
            while items and len(running) < width():
                submit(items.popleft())
            done = wait(running, wait_s, FIRST_COMPLETED).done
            yield [each for future in done for each in taken(future)]

    try:
        while waiting:
            yield from completed(waiting, width)
            again = sorted(died, key=order.__getitem__)
            died.clear()
            for item in again:
                yield from completed(deque([item]), lambda: 1)
                if died:
                    yield [(item, WorkerDied(died.pop(item)))]
    finally:
        for future in running:
            future.cancel()


def _replied(function: Callable[..., Any], *arguments: Any) -> _Reply:
    """Call a function in a worker; an error keeps its traceback as a note."""
    try:
        return _Reply(function(*arguments))
    except Exception as error:
        error.add_note("".join(traceback.format_exception(error)))
        return _Reply(error=error)

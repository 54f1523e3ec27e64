"""Dispatch of candidates: evaluated here or by an executor's workers, with the same result.

The worker pool takes any `concurrent.futures.Executor`: processes, threads, a cluster. A task whose
worker died is run once more; if that worker dies too, the task is named.
"""

import sys
import traceback
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import closing, suppress
from dataclasses import dataclass
from itertools import chain
from typing import Any, NamedTuple, TypeVar

from ..base.errors import InputError, shown
from ..scene.rig import Rig
from .objective import NO_VALUE, Leader, Objective, Value
from .payload import PackedPayload, Unreadable, send_payload, unpickled

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
            future = executor.submit(_replied, function, *arguments)
        except (RuntimeError, OSError) as error:  # the executor is broken, or was shut down
            died[item] = type(error).__name__
            return
        if not isinstance(future, Future):
            expected = "an executor whose submit returns a concurrent.futures.Future"
            raise InputError("executor", "submit", expected, shown(type(future).__name__))
        running[future] = item

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


def evaluate_all(
    objective: Objective,
    rigs: Sequence[Rig],
    cutoff: Value = NO_VALUE,
    executor: Executor | None = None,
    leader: Leader | None = None,
) -> list[Value]:
    """Evaluate several rigs; the result depends neither on the workers nor on earlier calls.

    `objective`: Its `shared_parts` are sent to each worker once, so they must not change. Where it
        cannot be pickled, or a worker cannot unpickle it, the rigs are evaluated here.
    `cutoff`: Values are needed only below this one; all of them, by default.
    `leader`: A placement that candidates race against: one that is surely not below the cutoff is
        not evaluated in full.
    `executor`: Its workers evaluate; by default this thread does. `Processes` replaces dead
        workers.

    Returns
    -------
    list of Value
        For each rig its value where that is below `cutoff`; otherwise `NO_VALUE`, even where the
        value is known: that depends on caches. `InputError` when two workers died with the same
        rig.
    """
    if executor is not None and rigs:
        with suppress(Unreadable):
            return _evaluate_by_workers(objective, rigs, cutoff, executor, leader=leader)
    return [objective.below(rig, cutoff, leader) for rig in rigs]


def _evaluate_by_workers(
    objective: Objective,
    rigs: Sequence[Rig],
    cutoff: Value,
    executor: Executor,
    leader: Leader | None,
) -> list[Value]:
    models = (sensor.model for rig in rigs for sensor in rig)
    sent = send_payload(executor, (*objective.shared_parts(), *models))
    candidates = [sent.payload.pickled((objective, rig, leader)) for rig in rigs]
    tried: set[int] = set()

    def call_of(number: int) -> Call:
        """A second attempt brings the payload: perhaps it was lost with the first one's worker."""
        payload = sent.payload.packed if number in tried else sent.argument
        tried.add(number)
        return Call(_evaluate_in_worker, (payload, candidates[number], cutoff))

    evaluations: dict[int, Value] = {}
    with closing(run_tasks(executor, deque(range(len(rigs))), call_of)) as batches:
        for number, result in chain.from_iterable(batches):
            if isinstance(result, WorkerDied):
                places = [(s.name, [round(w, 3) for w in s.pose.position]) for s in rigs[number]]
                found = f"two that died with {', '.join(f'{n} at {at}' for n, at in places)}"
                raise InputError("workers", "process", "a worker that survives its task", found)
            evaluations[number] = result
    return [evaluations[number] for number in range(len(rigs))]


def _evaluate_in_worker(payload: PackedPayload, candidate: bytes, cutoff: Value) -> Value:
    objective, rig, leader = unpickled(payload, candidate)
    found: Value = objective.below(rig, cutoff, leader)
    return found

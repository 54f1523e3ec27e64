"""Tasks handed to the workers of any executor; one whose worker died is tried once more."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Protocol

from ..errors import InputError
from ..study import Outcome
from .run import RunTask, carried_out

WAIT_S = 0.2
"""How long to wait for results before looking whether to go on."""
Found = Outcome | InputError
Take = Callable[[str, Found], None]


class Workplace(Protocol):
    """Where tasks are carried out."""

    @property
    def executor(self) -> Executor:
        """Whose workers do it. After a worker's death it still takes tasks."""

    @property
    def threads(self) -> int:
        """How many threads a task may take."""

    def width(self) -> int:
        """How many tasks are handed out at a time."""

    def check(self) -> None:
        """Raise `InputError` when the workplace is gone."""


def run_all(
    tasks: Mapping[str, RunTask],
    workplace: Workplace,
    take: Take,
    goes_on: Callable[[], bool] = lambda: True,
) -> None:
    """Carry out tasks by name; `take` is given each result as it comes, in this thread.

    A task whose worker died is tried once more, alone, after all others: which of several tasks
    was the death of their worker cannot be told before.

    Parameters
    ----------
    tasks : mapping of str to RunTask
    workplace : Workplace
    take : callable
        Of a name, and an outcome or what was wrong.
    goes_on : callable, optional
        Asked now and then; when it says no, nothing more is waited for.

    Raises
    ------
    InputError
        When the workplace is gone.
    """
    lost = _carry_out(tasks, workplace, workplace.width, take, goes_on)
    for name in sorted(lost, key=list(tasks).index):
        again = _carry_out({name: tasks[name]}, workplace, lambda: 1, take, goes_on)
        if again:
            expected = "a worker that lives to its end"
            take(name, InputError(name, "worker", expected, f"two that died ({again[name]})"))


def _carry_out(
    tasks: Mapping[str, RunTask],
    workplace: Workplace,
    width: Callable[[], int],
    take: Take,
    goes_on: Callable[[], bool],
) -> dict[str, str]:
    """Carry out tasks; return the names of those whose worker died, with what was said of it."""
    waiting, running, lost = deque(tasks), dict[Future[Found], str](), dict[str, str]()
    while (waiting or running) and goes_on():
        workplace.check()
        while waiting and len(running) < width():
            name = waiting.popleft()
            try:
                running[workplace.executor.submit(carried_out, tasks[name])] = name
            except RuntimeError as error:  # broken, or shut down
                lost[name] = _told(error)
        for future in wait(running, WAIT_S, FIRST_COMPLETED).done:
            name = running.pop(future)
            try:
                found = future.result()
            except Exception as error:  # each executor has its own way to tell of a worker's death
                lost[name] = _told(error)
            else:
                take(name, found)
    for future in running:
        future.cancel()
    return lost


def _told(error: Exception) -> str:
    return type(error).__name__

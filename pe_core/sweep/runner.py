"""Tasks handed to the workers of any executor; one whose worker died is tried once more."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from pathlib import Path
from typing import Protocol

from ..errors import InputError
from ..study import Outcome
from .run import RunCheckpoints, RunTask, SweepRun, carried_out

WAIT_S = 0.2
"""How long to wait for results before looking whether to go on."""
Found = Outcome | InputError
Take = Callable[[str, Found], None]
MakeTask = Callable[[str], RunTask]


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
        """Raise `InputError` when the workplace is gone; called several times a second."""

    def checkpoints(self, run: SweepRun, folder: Path) -> RunCheckpoints:
        """Return the checkpoints of a run's search; `folder` is that of the run's results."""


def run_all(
    names: Sequence[str],
    make_task: MakeTask,
    workplace: Workplace,
    take: Take,
    goes_on: Callable[[], bool] = lambda: True,
) -> None:
    """Carry out runs by name; `take` is given each result as it comes, in this thread.

    A task whose worker died is tried once more, alone, after all others: which of several tasks
    was the death of their worker cannot be told before.

    Parameters
    ----------
    names : sequence of str
    make_task : callable
        Of a name: the task, made when a worker is free for it, and again for a second try.
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
    lost = _carry_out(names, make_task, workplace, workplace.width, take, goes_on)
    for name in sorted(lost, key=list(names).index):
        again = _carry_out([name], make_task, workplace, lambda: 1, take, goes_on)
        if again:
            expected = "a worker that lives to its end"
            take(name, InputError(name, "worker", expected, f"two that died ({again[name]})"))


def _carry_out(
    names: Sequence[str],
    make_task: MakeTask,
    workplace: Workplace,
    width: Callable[[], int],
    take: Take,
    goes_on: Callable[[], bool],
) -> dict[str, str]:
    """Carry out tasks; return the names of those whose worker died, with what was said of it."""
    waiting, running, lost = deque(names), dict[Future[Found], str](), dict[str, str]()
    while (waiting or running) and goes_on():
        workplace.check()
        while waiting and len(running) < width():
            name = waiting.popleft()
            try:
                running[workplace.executor.submit(carried_out, make_task(name))] = name
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

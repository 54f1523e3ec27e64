"""Work handed out to the workers of an executor, with what they lack; again where one died."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from ..errors import InputError
from .parcels import Parcel

T = TypeVar("T")


class Unreadable(TypeError):
    """What was to be sent cannot be pickled, or a worker cannot read it."""


@dataclass(frozen=True, slots=True)
class Reply(Generic[T]):
    """What a worker says: what it found, keys of parcels that it is missing, or what went wrong.

    An error is said, not raised: what a future raises is the end of its worker.
    """

    found: T | None = None
    missing: tuple[str, ...] = ()
    error: Exception | None = None


@dataclass(frozen=True, slots=True)
class Assignment(Generic[T]):
    """Something for a worker to do.

    Attributes
    ----------
    name : str
        What messages call it.
    function : callable
        Takes parcels' data by key, then `arguments`; returns a `Reply`.
    arguments : tuple
    parcels : mapping of str to Parcel
        By key, all that may be missing; what one names comes before it.
    """

    name: str
    function: Callable[..., Reply[T]]
    arguments: tuple[Any, ...]
    parcels: Mapping[str, Parcel]

    def given_to(self, executor: Executor, missing: Sequence[str] = ()) -> Future[Reply[T]]:
        """Hand it to a worker, with those parcels."""
        data = {key: parcel.data for key, parcel in self.parcels.items() if key in missing}
        return executor.submit(self.function, data, *self.arguments)


def handed_out(assignments: Sequence[Assignment[T]], executor: Executor) -> list[T]:
    """Return what workers find, in the order of the assignments.

    Raises
    ------
    InputError
        When an assignment's worker died, and the one after it died as well.
    Exception
        That an assignment came back with; `Unreadable` where a worker could not read it.
    """
    run = _Handing(assignments, executor)
    try:
        return run.results()
    finally:
        for future in run.open:
            future.cancel()


class _Handing(Generic[T]):
    """Assignments under way.

    Parcels may be large, so one assignment carries some at a time. Meanwhile others that miss any
    wait: by then their worker may know them.
    """

    def __init__(self, assignments: Sequence[Assignment[T]], executor: Executor) -> None:
        self._assignments, self._executor = assignments, executor
        self._found: dict[int, Any] = {}
        self._missing: deque[tuple[int, tuple[str, ...]]] = deque()
        self._lost: list[int] = []
        self._carrier: Future[Reply[T]] | None = None
        self.open: dict[Future[Reply[T]], int] = {}

    def results(self) -> list[T]:
        """Hand out all assignments; those whose worker died once more, one after the other."""
        self._give(range(len(self._assignments)))
        self._finish()
        again, self._lost = sorted(self._lost), []
        for number in again:
            self._give([number])
            self._finish()
            if self._lost:
                expected = "one that lives through its work"
                found = f"two that died with {self._assignments[number].name}"
                raise InputError("workers", "process", expected, found)
        return [self._found[number] for number in range(len(self._assignments))]

    def _give(self, numbers: Sequence[int], missing: Sequence[str] = ()) -> None:
        for number in numbers:
            try:
                future = self._assignments[number].given_to(self._executor, missing)
            except RuntimeError:  # a broken executor, or one that was shut down
                self._lost.append(number)
                continue
            self.open[future] = number
            if missing:
                self._carrier = future

    def _finish(self) -> None:
        while self.open or self._missing:
            if self._missing and self._carrier is None:
                number, missing = self._missing.popleft()
                self._give([number], missing)
            for future in wait(self.open, return_when=FIRST_COMPLETED).done:
                self._take(future)

    def _take(self, future: Future[Reply[T]]) -> None:
        number = self.open.pop(future)
        if future is self._carrier:
            self._carrier = None
            waiting = [each for each, _ in self._missing]
            self._missing.clear()
            self._give(waiting)
        try:
            reply = future.result()
        except Exception:  # of the executor: each has its own way to say that a worker is gone
            self._lost.append(number)
            return
        if reply.error is not None:
            raise reply.error
        if reply.missing:
            self._missing.append((number, reply.missing))
        else:
            self._found[number] = reply.found

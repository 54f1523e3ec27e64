"""Long work as one job with any driver: a blocking loop, or a timer that steps it.

A job is iterated; it yields `Progress` at least every few hundredths of a second and leaves its
result in `outcome`. `stop()` asks it to wind down: a search's best so far is then judged and kept.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NotYet
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

from ..advice import Advice, warnings
from ..scene.sensors import Rig
from ..scoring import RigJudge
from ..scoring.score import Score, ScoreStopped
from .outcome import Outcome
from .study import Study

T = TypeVar("T")

WAIT_S = 0.03
"""How long a job waits for its thread before it yields: a frame of a responsive window."""


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a job is: what it does, 0 to 1, and the best entropy so far (None before the first)."""

    stage: str
    fraction: float
    entropy: float | None = None
    evaluations: int = 0


class Job:
    """Base of the jobs: a stopwatch, the outcome, and a way to ask for an early end."""

    def __init__(self, study: Study, workers: int | None = None) -> None:
        self.study, self.workers = study, workers
        self.outcome: Outcome | None = None
        self.stopped = self.dropped = False
        self.notes: tuple[Advice, ...] = ()
        """What whoever made the study has to tell of it: it comes before the warnings."""
        self._started = time.monotonic()

    def __iter__(self) -> Iterator[Progress]:
        raise NotImplementedError

    def stop(self) -> None:
        """Search no further; judge and keep the best so far.

        Before a first score is complete there is nothing to keep: the job then ends without one,
        and `outcome` stays None.
        """
        self.stopped = True

    def drop(self) -> None:
        """End at once and keep nothing: `outcome` stays None."""
        self.stopped = self.dropped = True

    @property
    def seconds(self) -> float:
        """Time since the job was made [s]."""
        return time.monotonic() - self._started

    @cached_property
    def _evaluator(self) -> RigJudge:
        """What judges the study's rig, and the search's: the two differ in nothing else."""
        return self.study.evaluator(workers=self.workers)

    def _score(
        self, rig: Rig, waiting: Progress, *, to_the_end: bool = False
    ) -> Generator[Progress, None, Score | None]:
        """Score in a thread, yielding `waiting` until it is done.

        None when the job is stopped meanwhile, unless it is `to_the_end`, or dropped: the thread
        then ends by itself, soon, and nobody waits for it.
        """
        done = waiting.fraction

        def watch(share: float) -> bool:
            nonlocal done
            done = max(waiting.fraction, share)
            return self._goes_on(to_the_end)

        def work() -> Score | None:
            try:
                return self._evaluator.score(rig, watch=watch)
            except ScoreStopped:
                return None

        return (yield from self._beside(work, lambda: replace(waiting, fraction=done), to_the_end))

    def _beside(
        self, work: Callable[[], T], waiting: Callable[[], Progress], to_the_end: bool = False
    ) -> Generator[Progress, None, T | None]:
        """Work in a thread, yielding how far it is; None when nobody waits for it any more."""
        yield waiting()
        return (yield from self._awaited(begun(work), waiting, to_the_end))

    def _awaited(
        self, future: Future[T], waiting: Callable[[], Progress], to_the_end: bool = False
    ) -> Generator[Progress, None, T | None]:
        while self._goes_on(to_the_end):
            try:
                return future.result(timeout=WAIT_S)
            except NotYet:
                if future.done():
                    raise
            yield waiting()
        return None

    def _goes_on(self, to_the_end: bool) -> bool:
        return not self.dropped and (to_the_end or not self.stopped)

    def _warnings(
        self, study: Study, score: Score, waiting: Progress
    ) -> Generator[Progress, None, tuple[Advice, ...] | None]:
        """Look a study over in a thread, yielding `waiting` until it is done."""

        def work() -> tuple[Advice, ...]:
            told = warnings(study.rig, study.vehicle, study.space, study.prior, score)
            return (*self.notes, *told)

        return (yield from self._beside(work, lambda: waiting, to_the_end=True))


def begun(work: Callable[[], T]) -> Future[T]:
    """Begin work in a thread of its own."""
    future = Future[T]()
    threading.Thread(target=_fill, args=(future, work), daemon=True).start()
    return future


def _fill(future: Future[T], work: Callable[[], T]) -> None:
    try:
        future.set_result(work())
    except BaseException as error:  # whatever it is, the one who waits has to know
        future.set_exception(error)

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
from ..scoring.evaluator import Evaluator
from ..scoring.score import Score, ScoreStopped
from ..search import Step, first_allowed, optimize
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


@dataclass(frozen=True, slots=True)
class HistoryRow:
    """A placement that became the best: when, how good, in which round, and where."""

    evaluation: int
    round: int
    entropy: float
    rig: Rig


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a job found.

    Attributes
    ----------
    kind : {"score", "optimize"}
    start, study : Study
        As it was given, and with the best placement.
    before, after : Score
        Scores of the two; the same one when only a score was asked for, or nothing better was
        found.
    history : tuple of HistoryRow
        Every placement that became the best, the start first.
    evaluations : int
        Rigs judged by the search.
    stopped : bool
        Whether the search was cut short.
    seconds : float
    warnings : tuple of Advice
        What is odd about `study`.
    """

    kind: str
    start: Study
    study: Study
    before: Score
    after: Score
    history: tuple[HistoryRow, ...] = ()
    evaluations: int = 0
    stopped: bool = False
    seconds: float = 0.0
    warnings: tuple[Advice, ...] = ()


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
    def _evaluator(self) -> Evaluator:
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
        future = Future[T]()
        yield waiting()
        threading.Thread(target=_fill, args=(future, work), daemon=True).start()
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


def _fill(future: Future[T], work: Callable[[], T]) -> None:
    try:
        future.set_result(work())
    except BaseException as error:  # whatever it is, the one who waits has to know
        future.set_exception(error)


class ScoreJob(Job):
    """Scores a study's rig as it stands."""

    def __iter__(self) -> Iterator[Progress]:
        score = yield from self._score(self.study.rig, Progress("scoring", 0.0))
        if score is None:
            return
        told = yield from self._warnings(self.study, score, Progress("scoring", 1.0, score.entropy))
        if told is None:
            return
        both = (self.study, self.study, score, score)
        self.outcome = Outcome("score", *both, seconds=self.seconds, warnings=told)
        yield Progress("done", 1.0, score.entropy)


class OptimizeJob(Job):
    """Scores a study's rig, searches for a better placement, and scores that.

    `before` is the score of the study's rig where that is known already; it is not made again.
    """

    def __init__(
        self, study: Study, workers: int | None = None, before: Score | None = None
    ) -> None:
        super().__init__(study, workers)
        self.before = before
        self.history: list[HistoryRow] = []
        self.evaluations = 0

    @property
    def best(self) -> Study:
        """The study with the best placement so far."""
        return self.study.with_rig(self.history[-1].rig) if self.history else self.study

    @cached_property
    def _search_evaluator(self) -> Evaluator:
        """What judges candidates: the study's own evaluator where that is the same."""
        samples = self.study.search.samples
        if samples == self.study.samples:
            return self._evaluator
        return self.study.evaluator(samples, self.workers)

    def __iter__(self) -> Iterator[Progress]:
        preparing = Progress("preparing", 0.0)
        if (yield from self._beside(self._checked, lambda: preparing)) is None:
            return
        before = self.before
        if before is None:
            before = yield from self._score(self.study.rig, Progress("scoring the start", 0.0))
        if before is None:
            return
        yield from self._search()
        stopped = self.stopped
        after, best = yield from self._better_of(before)
        looking = Progress("scoring the result", 1.0, after.entropy, self.evaluations)
        told = yield from self._warnings(best, after, looking)
        if told is None:
            return
        self.outcome = Outcome(
            "optimize",
            self.study,
            best,
            before,
            after,
            tuple(self.history),
            self.evaluations,
            stopped,
            self.seconds,
            told,
        )
        yield Progress("done", 1.0, after.entropy, self.evaluations)

    def _checked(self) -> Evaluator:
        """What judges candidates; `InputError` for a search that cannot be made, before it begins.

        It is made here, beside whoever waits: that takes long for a large vehicle.
        """
        first_allowed(self.study.coding(), self.study.search.seed)
        return self._search_evaluator

    def _better_of(self, before: Score) -> Generator[Progress, None, tuple[Score, Study]]:
        """Score what was found; the start's score and study where it is allowed and no worse."""
        if self.best.rig is self.study.rig:
            return before, self.study
        waiting = Progress("scoring the result", 1.0, self.history[-1].entropy, self.evaluations)
        found = yield from self._score(self.best.rig, waiting, to_the_end=True)
        kept = self.history[0].rig is self.study.rig  # else the start broke a rule of the search
        if found is not None and (found.entropy < before.entropy or not kept):
            return found, self.best
        return before, self.study  # the search's sample flattered a placement

    def _search(self) -> Iterator[Progress]:
        search, evaluator = self.study.search, self._search_evaluator
        space = self.study.search_space()
        for step in optimize(evaluator, self.study.rig, space, search.seed, search.schedule):
            self._note(step)
            yield Progress("optimizing", step.fraction, step.entropy, step.evaluations)
            if self.stopped:
                return

    def _note(self, step: Step) -> None:
        self.evaluations = step.evaluations
        if step.improved or not self.history:
            row = HistoryRow(step.evaluations, step.round, step.entropy, step.best)
            self.history.append(row)

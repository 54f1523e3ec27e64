"""Long work as one job with any driver: a blocking loop, or a timer that steps it.

A job is iterated; it yields `Progress` at least every few hundredths of a second and leaves its
result in `outcome`. `stop()` asks it to wind down: the best so far is then judged and kept.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as NotYet
from dataclasses import dataclass
from functools import cached_property

from ..scene.sensors import Rig
from ..scoring.evaluator import Evaluator
from ..scoring.score import Score
from ..search.optimize import Step, optimize
from .study import Study

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


class Job:
    """Base of the jobs: a stopwatch, the outcome, and a way to ask for an early end."""

    def __init__(self, study: Study, workers: int | None = None) -> None:
        self.study, self.workers = study, workers
        self.outcome: Outcome | None = None
        self.stopped = False
        self._started = time.monotonic()

    def __iter__(self) -> Iterator[Progress]:
        raise NotImplementedError

    def stop(self) -> None:
        """Search no further; judge and keep the best so far."""
        self.stopped = True

    @property
    def seconds(self) -> float:
        """Time since the job was made [s]."""
        return time.monotonic() - self._started

    @cached_property
    def _evaluator(self) -> Evaluator:
        """What judges the study's rig, and the search's: the two differ in nothing else."""
        return self.study.evaluator(workers=self.workers)

    def _score(self, rig: Rig, waiting: Progress) -> Generator[Progress, None, Score]:
        """Score in a thread, yielding `waiting` until it is done."""
        yield waiting
        with ThreadPoolExecutor(1) as pool:
            future = pool.submit(lambda: self._evaluator.score(rig))
            while True:
                try:
                    return future.result(timeout=WAIT_S)
                except NotYet:
                    if future.done():
                        raise
                    yield waiting


class ScoreJob(Job):
    """Scores a study's rig as it stands."""

    def __iter__(self) -> Iterator[Progress]:
        score = yield from self._score(self.study.rig, Progress("scoring", 0.0))
        self.outcome = Outcome("score", self.study, self.study, score, score, seconds=self.seconds)
        yield Progress("done", 1.0, score.entropy)


class OptimizeJob(Job):
    """Scores a study's rig, searches for a better placement, and scores that."""

    def __init__(self, study: Study, workers: int | None = None) -> None:
        super().__init__(study, workers)
        self.history: list[HistoryRow] = []
        self.evaluations = 0

    @property
    def best(self) -> Study:
        """The study with the best placement so far."""
        return self.study.with_rig(self.history[-1].rig) if self.history else self.study

    def __iter__(self) -> Iterator[Progress]:
        before = yield from self._score(self.study.rig, Progress("scoring the start", 0.0))
        yield from self._search()
        after, best = before, self.study
        if self.best.rig is not self.study.rig:
            waiting = Progress("scoring the result", 1.0, self.history[-1].entropy)
            found = yield from self._score(self.best.rig, waiting)
            if found.entropy < before.entropy:  # the search's sample may flatter a placement
                after, best = found, self.best
        self.outcome = Outcome(
            "optimize",
            self.study,
            best,
            before,
            after,
            tuple(self.history),
            self.evaluations,
            self.stopped,
            self.seconds,
        )
        yield Progress("done", 1.0, after.entropy, self.evaluations)

    def _search(self) -> Iterator[Progress]:
        search = self.study.search
        evaluator = self.study.evaluator(search.samples, self.workers)
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

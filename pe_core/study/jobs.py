"""The two jobs: score a study's rig, and search for a better one."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from functools import cached_property
from typing import Any

from ..advice import Advice, fragile
from ..scoring import RigJudge
from ..scoring.score import Score
from ..search import (
    Journal,
    Objective,
    Robustness,
    Step,
    first_allowed,
    objective_of,
    optimize,
    robustness,
)
from .helpers import Helpers
from .job import Job, Progress, begun
from .outcome import HistoryRow, Outcome
from .study import DEFAULT_SEARCH_SAMPLES, Study


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
    `journal` is that of a search to go on with.
    """

    def __init__(
        self,
        study: Study,
        workers: int | None = None,
        before: Score | None = None,
        journal: Journal | None = None,
    ) -> None:
        super().__init__(study, workers)
        self.before, self.journal = before, journal or Journal()
        self.inputs: dict[str, Any] | None = None
        self.round = 0
        self.history: list[HistoryRow] = []
        self.evaluations = 0
        self._told = Progress("preparing", 0.0)

    @property
    def best(self) -> Study:
        """The study with the best placement so far."""
        return self.study.with_rig(self.history[-1].rig) if self.history else self.study

    @cached_property
    def _objectives(self) -> list[Objective]:
        """What judges candidates on each of the method's levels; the study's own where it can."""
        search = self.study.search
        return [objective_of(each, search.tolerance, search.seed) for each in self._evaluators]

    @cached_property
    def _evaluators(self) -> list[RigJudge]:
        """Those of the method's levels."""
        return [self._evaluator_of(samples) for samples in self.study.search.level_samples]

    def _evaluator_of(self, samples: int) -> RigJudge:
        if self.study.looks_at(samples) == self.study.looks_at(self.study.samples):
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
        shaken = yield from self._shaken(best, looking)
        told = yield from self._warnings(best, after, looking)
        if told is None or shaken is None:
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
            (*told, *_fragile(best, shaken)),
            self.inputs,
            self.journal.entries,
            shaken,
        )
        yield Progress("done", 1.0, after.entropy, self.evaluations)

    def _checked(self) -> list[Objective]:
        """What judges candidates; `InputError` for a search that cannot be made, before it begins.

        It is made here, beside whoever waits: that takes long for a large vehicle.
        """
        first_allowed(self.study.coding(), self.study.search.seed)
        return self._objectives

    def _better_of(self, before: Score) -> Generator[Progress, None, tuple[Score, Study]]:
        """Score what was found; the start's score and study where it is allowed and no worse."""
        if self.best.rig is self.study.rig:
            return before, self.study
        waiting = Progress("scoring the result", 1.0, self.history[-1].entropy, self.evaluations)
        found = yield from self._score(self.best.rig, waiting, to_the_end=True)
        if found is not None and (found.entropy < before.entropy or not self._start_may_stay):
            return found, self.best
        return before, self.study  # the search's sample flattered a placement

    def _shaken(
        self, best: Study, waiting: Progress
    ) -> Generator[Progress, None, Robustness | None]:
        """Tell in a thread how far entropies move under mounting errors and failures."""
        search = self.study.search

        def work() -> Robustness:
            last = self._evaluators[-1]
            sampled = last if last.samples else self._evaluator_of(DEFAULT_SEARCH_SAMPLES)
            return robustness(sampled, self.study.rig, best.rig, search.tolerance, search.seed)

        return (yield from self._beside(work, lambda: waiting, to_the_end=True))

    @property
    def _start_may_stay(self) -> bool:
        """Whether the start is kept where what was found scores no better.

        Not where it breaks a rule of the search, nor where both are scored as they stand, but were
        searched by what they are worth mounted off or without a sensor.
        """
        return self.history[0].rig is self.study.rig and not self.study.search.tolerance.is_on

    def _search(self) -> Iterator[Progress]:
        """Search in a thread, step by step: a candidate may take longer than a window waits."""
        search, helpers = self.study.search, Helpers(self.workers)
        steps = optimize(
            self.journal.over(self._objectives),
            self.study.rig,
            self.study.search_space(),
            search.seed,
            search.schedule,
            method=search.method,
            evaluations=search.evaluations,
            executor=helpers,
        )
        try:
            while step := (yield from self._awaited(begun(lambda: next(steps, None)), self._now)):
                self._note(step)
                yield self._now()
        finally:
            helpers.end()

    def _now(self) -> Progress:
        return self._told

    def _note(self, step: Step) -> None:
        self.evaluations, self.round = step.evaluations, step.round
        self._told = Progress("optimizing", step.fraction, step.entropy, step.evaluations)
        if step.improved or not self.history:
            row = HistoryRow(step.evaluations, step.round, step.entropy, step.best)
            self.history.append(row)


def _fragile(study: Study, found: Robustness) -> tuple[Advice, ...]:
    after, errors = found.after, found.errors
    tolerant = study.search.tolerance.mounts_off
    return fragile(after.rise, after.stderr, errors.position, errors.angle, tolerant)

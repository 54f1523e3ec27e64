"""The job that searches for better poses."""

import time
from collections.abc import Callable, Generator, Iterator
from contextlib import AbstractContextManager
from dataclasses import replace
from functools import cached_property
from math import sqrt
from statistics import fmean, pstdev
from typing import NamedTuple

from pe_core.base.values import rounded
from pe_core.scene.rig import Rig
from pe_core.scoring import RigEvaluator
from pe_core.scoring.sampling import CENTERED, HELD_OUT, MIN_SAMPLES
from pe_core.scoring.score import ObjectScore, Score
from pe_core.search import (
    GridWalk,
    Journal,
    Objective,
    Robustness,
    Step,
    Value,
    evaluate_all,
    feasible_start,
    optimize,
    robustness,
)
from pe_core.study.condition_table import is_by_ap, searched_study, study_objective
from pe_core.study.requirement_search import constraints_of
from pe_core.study.study import DEFAULT_SEARCH_SAMPLES, Study
from pe_core.study.suggestion import suggestions

from ..advice import (
    Advice,
    Rounding,
    condition_warnings,
    consensus_of,
    flatness_of,
    fragile,
    not_kept,
    unmet,
)
from .candidate_workers import ExecutorSource, candidate_workers
from .job import (
    HistoryRow,
    Job,
    Outcome,
    Progress,
    ProgressSteps,
    StartEnd,
    Watch,
    begun,
    best_so_far,
)
from .own_objective import OwnValues, own_figure, own_objective
from .searched_figure import IN_AP, level_sizes, searched_figure, searched_on, searched_samples
from .stopping import TARGET, StopWatch, seed_scatter


class _Scored(NamedTuple):
    """A score, and that on objects in traffic where the search goes by expected AP."""

    score: Score
    in_traffic: ObjectScore | None = None
    own: float | None = None

    @property
    def value(self) -> Value:
        """What the search minimises, of a placement as scored."""
        if self.own is not None:
            return Value(0.0, self.own)
        if self.in_traffic is not None:
            return IN_AP.to_value(self.in_traffic.ap)
        return Value(0.0, self.score.entropy)


def _nothing() -> None:
    """Nothing evaluates candidates before the search; a name, as a job may be pickled."""


class OptimizeJob(Job):
    """Scores a study's rig, searches for a better placement, and scores that.

    Parameters
    ----------
    study, workers
        As of `Job`.
    before : Score, optional
        Score of the study's rig, if the caller has it already: it is not computed again.
    journal : Journal, optional
        Journal of an earlier search of the same study, which is resumed.
    objective : callable or Objective, optional
        What the search minimises in place of entropy: takes a `Rig`, returns a number. Processes
        evaluate it if it can be pickled. Limits of the study are kept; robustness and flatness,
        which are of entropy, are left out.
    target : float, optional
        The search ends at this figure; by default the study's limit on what the search improves.

    Attributes
    ----------
    history : list of HistoryRow
        Every placement that became the best so far.
    evaluations, round : int
        Evaluations and rounds of the search so far.
    ends : list of StartEnd
        Where the starts ended so far, if the study has further ones.
    stop_reason : str
        Why the search ended before its budget did, by a rule of the study; empty otherwise.
    descents : tuple of Value
        Where the independent descents of the search ended (`Step.ends`).
    """

    parts = 2
    shown = ("history", "_ended", "evaluations", "stopped", "parts_left")
    kept = ("journal",)
    analyses = True  # Whether the result is analysed after the search

    def __init__(
        self,
        study: Study,
        workers: int | None = None,
        before: Score | None = None,
        journal: Journal | None = None,
        objective: Callable[[Rig], float] | Objective | None = None,
        target: float | None = None,
    ) -> None:
        super().__init__(study, workers)
        self._own = None if objective is None else own_objective(study, objective)
        self.figure = searched_figure(study) if objective is None else own_figure(objective)
        self.journal_name = "" if self._own is None else self.figure.key
        self.target = self.figure.target(study) if target is None else target
        self.before = before
        self.journal = journal or Journal()
        self.round = 0
        self.history: list[HistoryRow] = []
        self.evaluations = 0
        self.ends: list[StartEnd] = []
        self._ended: list[HistoryRow] = []
        self._settled: Rig | None = None
        self.stop_reason = ""
        self.descents: tuple[Value, ...] = ()
        self._helpers: ExecutorSource = _nothing
        self._first: HistoryRow | None = None
        self._progress = Progress("preparing", 0.0)

    @property
    def best(self) -> Study:
        """The study with the best placement so far."""
        if self._settled is not None:
            return self.study.with_rig(self._settled)
        rows = self._ended or self.history
        return self.study.with_rig(rows[-1].rig) if rows else self.study

    @property
    def curve(self) -> tuple[tuple[int, Value], ...]:
        """The best so far, from all starts: `best_so_far`."""
        earlier = () if self._ended is self.history else self._ended
        return best_so_far(earlier, self.history)

    @cached_property
    def _free(self) -> list[Objective]:
        """Objectives without requirements, one for each level of the search method; levels that
        look at the same scenes of objects are one."""
        if self._own is not None:
            return [self._own]
        levels = {self._evaluator_of(n): n for n in self.study.level_samples}
        return [study_objective(self.study, each, n, self.workers) for each, n in levels.items()]

    @cached_property
    def _samples(self) -> list[str]:
        """What each level of the search evaluates on: "65,536 voxels"."""
        if self._own is not None:
            return [""]
        _, unit = searched_on(self.study)
        return [f"{size} {unit}" for size in level_sizes(self.study)]

    @cached_property
    def _held_out(self) -> list[Objective]:
        """What the search minimises, on samples that it does not use: two, each of half the voxels,
        so that their difference tells the error; or all voxels."""
        if self._own is not None:
            return [self._own]
        samples = searched_samples(self.study, self.study.search.samples)
        if not samples and not searched_study(self.study).targets.are_objects:
            return [self._free[-1]]
        half = max(samples // len(HELD_OUT), MIN_SAMPLES)
        return [
            study_objective(
                self.study, self.evaluators.searching(half, shift), half, self.workers, shift=shift
            )
            for shift in HELD_OUT
        ]

    def reported_value(self, rig: Rig) -> Value:
        """Return the value of a placement as it is reported: on samples that no search uses; of one
        that breaks a constraint, its violation."""
        value = self._objectives[-1].value(rig)
        if not value.is_feasible:
            return value
        return Value(0.0, rounded(fmean(each.figure(rig) for each in self._held_out)))

    @cached_property
    def _objectives(self) -> list[Objective]:
        """Objectives that evaluate candidates, by level."""
        constraints = constraints_of(self.study)
        return [each.under(constraints) for each in self._free]

    def _evaluator_of(self, samples: int) -> RigEvaluator:
        """Return what evaluates candidates on a number of voxels, or in its share of scenes."""
        return self.evaluators.searching(searched_samples(self.study, samples))

    def __iter__(self) -> Iterator[Progress]:
        preparing = Progress("preparing", 0.0)
        if (yield from self._beside(lambda _: self._checked(), preparing)) is None:
            return
        with self._candidate_workers() as self._helpers:
            yield from self._scored_and_searched()

    def _scored_and_searched(self) -> Iterator[Progress]:
        first = yield from self._scored(
            self.study.rig, Progress("scoring the start", 0.0), self.before
        )
        if first is None:
            return
        yield from self._search()
        if not self.stopped and self.study.search.goals.stop.seconds is None:
            self.journal.require_used()
        rounding = yield from self._to_grid()
        yield self._progress  # a driver keeps the best so far before it is scored
        stopped = self.stopped
        self.parts_left = min(self.parts_left, 1)
        self.stopped = self.parts_left < 1
        last, best = yield from self._better_of(first)
        looking = self._about("scoring the result", last.value)
        warnings = yield from self._warnings(best, last.score, looking)
        rigs = [self.study.rig, *([best.rig] if best is not self.study else [])]
        figures = yield from self._figures(rigs, looking)
        # A further stop ends what follows: the result does not wait for it.
        analysing = replace(looking, stage="analysing")
        found = None
        if self._own is None:
            found = yield from self._beside(lambda _: self._robustness(best), analysing)
        verdicts = (yield from self._shown_verdicts(best, analysing, to_the_end=False)) or ()
        against: tuple[Advice, ...] | None = ()
        if best.limits.keeps_requirements and not all(verdict.met for verdict in verdicts):
            against = yield from self._beside(lambda _: unmet(suggestions(best)), analysing)
        flat = None
        if self.analyses and self._own is None and not self.stopped:
            flat = yield from self._beside(
                lambda _: flatness_of(
                    best.rig,
                    objectives=self._held_out,
                    evaluations=self.evaluations,
                    by_ap=is_by_ap(best),
                    helpers=self._helpers,
                    goes_on=lambda: not self.stopped,
                ),
                analysing,
            )
        table = yield from self._conditions(best, analysing, to_the_end=False)
        if self.dropped or warnings is None or figures is None:
            return
        sure: tuple[Advice, ...] = ()
        if found is not None:
            off = found.after
            errors = found.errors
            tolerant = best.search.tolerance.mounts_off
            sure = fragile(off.rise, off.stderr, errors.position, errors.angle, tolerant=tolerant)
        outcome = Outcome(
            kind="optimize",
            start=self.study,
            study=best,
            before=first.score,
            after=last.score,
            history=tuple(self.history),
            evaluations=self.evaluations,
            stopped=stopped,
            seconds=self.seconds,
            warnings=(*warnings, *sure, *(against or ()), *condition_warnings(table)),
            inputs=self.inputs,
            evaluated=self.journal.entries,
            robustness=found,
            verdicts=verdicts,
            conditions=table,
            flatness=flat,
            rounding=rounding,
            consensus=consensus_of(self.journal.known, self._moving, self.study.search.mounting),
            starts=tuple(self.ends),
            stop_reason=self.stop_reason,
            seed_scatter=seed_scatter(self.descents) if self._own is None else None,
            in_traffic=(first.in_traffic, last.in_traffic)
            if first.in_traffic and last.in_traffic
            else None,
            figures=(figures[0], figures[-1]) if figures else None,
            own=self._own_values(best),
        )
        warned = (*outcome.warnings, *not_kept(outcome.dashboard))
        self.outcome = replace(outcome, warnings=warned)
        yield self._about("done", last.value)

    def _own_values(self, best: Study) -> OwnValues | None:
        """Return an objective of one's own, for the start and the result."""
        if (own := self._own) is None:
            return None
        return OwnValues(self.figure, own.figure(self.study.rig), own.figure(best.rig))

    def _checked(self) -> list[Objective]:
        """Return the objectives; raise `InputError` before the search if it is infeasible. This
        runs in a thread, because the objectives of a large vehicle take long to build."""
        feasible_start(self.study.coding(), self.study.search.seed)
        return self._objectives

    def _scored(
        self, rig: Rig, waiting: Progress, known: Score | None = None, to_the_end: bool = False
    ) -> ProgressSteps[_Scored]:
        """Score a placement; of a search by expected AP, on objects in traffic, too."""
        by_ap = is_by_ap(self.study)
        apart = by_ap and searched_study(self.study).targets != self.study.targets
        all_scenes = self.study.search.samples
        own = None if self._own is None else self._own.value(rig).objective
        scoring = None
        if apart:
            scoring = begun(lambda: self.evaluators.searching(all_scenes, CENTERED).score(rig))
        score = known or (yield from self._score(rig, waiting, to_the_end=to_the_end))
        if score is None or scoring is None:
            return None if score is None else _Scored(score, score.objects if by_ap else None, own)
        found = yield from self._awaited(scoring, lambda: waiting, to_the_end)
        return None if found is None else _Scored(score, found.objects)

    def _better_of(self, before: _Scored) -> Generator[Progress, None, tuple[_Scored, Study]]:
        """Score the best placement; return the start instead if it is feasible and no worse."""
        if self.best.rig is self.study.rig:
            return before, self.study
        waiting = self._about("scoring the result", self.history[-1].value)
        found = yield from self._scored(self.best.rig, waiting, to_the_end=True)
        if found is not None and (found.value < before.value or not self._start_may_stay):
            return found, self.best
        return before, self.study  # the search's sample overrated the placement

    @property
    def _moving(self) -> list[str]:
        """Names of the sensors that the search moves by themselves."""
        return list(dict.fromkeys(name for name, _ in self.study.coding().positions))

    def _to_grid(self) -> ProgressSteps[Rounding]:
        """Bring the best placement onto the study's grid, and look at its neighbours there. Return
        what that costs; None without a grid, or where the job is dropped."""
        grid = self.study.search.grid
        if not grid.is_on or self.dropped:
            return None
        free = self.best.rig

        def work(_: Watch) -> Rounding:
            walk = GridWalk(self.study.with_rig(free).coding(), grid)
            found = walk.best(
                lambda rigs: evaluate_all(self._objectives[-1], rigs, executor=self._helpers())
            )
            if found.rig is None:
                return Rounding(None, 0.0, found.evaluations, found.off)
            rises = [each.figure(found.rig) - each.figure(free) for each in self._held_out]
            error = pstdev(rises) / sqrt(max(len(rises) - 1, 1))
            return Rounding(
                rounded(fmean(rises)), rounded(error), found.evaluations, found.off, rig=found.rig
            )

        found = yield from self._beside(work, self._progress, to_the_end=True)
        if found is not None and found.rig is not None:
            self._settled = found.rig
        return found

    def _about(self, stage: str, value: Value) -> Progress:
        return Progress(
            stage, fraction=1.0, value=value, evaluations=self.evaluations, figure=self.figure
        )

    def _robustness(self, best: Study) -> Robustness:
        """Return how entropies change under mounting errors and sensor failures."""
        search = self.study.search
        last = self.evaluators.on(search.samples)
        sampled = last if last.samples else self.evaluators.on(DEFAULT_SEARCH_SAMPLES)
        return robustness(sampled, self.study.rig, best.rig, search.tolerance, seed=search.seed)

    @property
    def _start_may_stay(self) -> bool:
        """Whether the start may be the result if the search finds nothing with a better score. It
        may not if it violates a constraint of the search or breaks a requirement to be kept. It may
        not either if the search had a tolerance: the scores ignore mounting errors and failures,
        which the search minimized, nor if it had conditions."""
        start = self._first or self.history[0]
        kept = start.rig is self.study.rig and start.value.is_feasible
        search = self.study.search
        if search.grid.is_on:
            kept = kept and GridWalk(self.study.coding(), search.grid).holds(self.study.rig)
        return kept and not (search.tolerance.is_on or search.conditions)

    def _search(self) -> Iterator[Progress]:
        """Search from every start in turn; the best of what they end at is the result."""
        starts = self.study.search.goals.starts
        rigs = {"": self.study.rig, **{s.name: s.placed(self.study.rig) for s in starts}}
        ended: list[tuple[Value, list[HistoryRow]]] = []
        began = time.monotonic()
        for number, (name, rig) in enumerate(rigs.items()):
            if self.stopped or self.stop_reason == TARGET:
                break
            if number:  # the best so far stays the job's until a start ends better
                self.history = []
            watch = StopWatch(
                self.study.search.goals.stop,
                self._objectives,
                began,
                figure=self.figure,
                target=self.target,
            )
            share = number / len(rigs), 1.0 / len(rigs)
            yield from self._search_from(rig, watch, share)
            if len(rigs) > 1 and self.history:
                end = self.history[-1].rig
                ended.append((self._end_value(end), self.history))
                self.ends.append(StartEnd(name, self.reported_value(end), self.evaluations))
                self.history = self._ended = min(ended, key=lambda each: each[0])[1]

    def _end_value(self, rig: Rig) -> Value:
        """Return the value of the placement that a start ended at, on the last level. A search that
        resumes knows it already; one that was stopped asks for other placements here."""
        last = self._objectives[-1]
        if self.stopped:
            return last.value(rig)
        return self.journal.value(last, rig, len(self._objectives) - 1)

    def _candidate_workers(self) -> AbstractContextManager[ExecutorSource]:
        """Return what evaluates candidates of the search and of its analysis."""
        return candidate_workers(self, self._evaluated())

    def _evaluated(self) -> Iterator[Objective]:
        """Yield what workers will evaluate, that of the analysis, too."""
        yield from self._objectives
        yield from self._held_out

    def _search_from(
        self, rig: Rig, watch: StopWatch, share: tuple[float, float]
    ) -> Iterator[Progress]:
        """Search step by step in a thread: one candidate may take longer than a window can wait."""
        search = self.study.search
        before = self.evaluations
        steps = optimize(
            self._objectives,
            rig,
            self.study.with_rig(rig).search_space(),
            search.seed,
            schedule=search.schedule,
            method=search.method,
            evaluations=search.from_each_start,
            executor=self._helpers,
            journal=self.journal,
        )
        while step := (
            yield from self._awaited(begun(lambda: next(steps, None)), lambda: self._progress)
        ):
            fraction = share[0] + share[1] * step.fraction
            self._note(replace(step, evaluations=before + step.evaluations, fraction=fraction))
            yield self._progress
            if reason := watch.reason(step):
                self.stop_reason = reason
                break

    def _note(self, step: Step) -> None:
        self.evaluations = step.evaluations
        self.round = step.round
        self.descents = step.ends
        self._progress = Progress(
            "optimizing",
            step.fraction,
            step.value,
            step.evaluations,
            figure=self.figure,
            sample=self._samples[step.level],
        )
        if step.improved or not self.history:
            row = HistoryRow(step.evaluations, step.round, step.value, step.best)
            self.history.append(row)
            self._first = self._first or row

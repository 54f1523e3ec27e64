"""The job that computes a Pareto front: of the designs and the placements of a study."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import replace
from functools import cached_property

from pe_core.base.errors import InputError, shown
from pe_core.scene.rig import Rig
from pe_core.scoring import RigEvaluator
from pe_core.scoring.sampling import CENTERED, SEARCHED, Shift
from pe_core.search import (
    SCHEDULED_METHOD,
    DesignSearch,
    EvaluatedRig,
    Journal,
    KeyFigures,
    Limits,
    Objective,
    Picks,
    Stop,
    above_front,
    pareto_front,
)
from pe_core.search.build_figures import SUMS
from pe_core.search.figures import AP, ENTROPY, PRICE
from pe_core.study.condition_table import is_by_ap
from pe_core.study.file_names import SEARCH
from pe_core.study.requirement_search import constraints_of
from pe_core.study.study import Study

from .candidate_workers import ExecutorSource, candidate_workers
from .front_objectives import (
    FrontFigures,
    FrontValues,
    ScalarValue,
    objectives_of,
    spread,
    weights_of,
)
from .job import Job, Progress, ProgressSteps
from .optimize_job import OptimizeJob
from .trade_off import Design, TradeOff, design_names, design_study

ALL_SEARCHED_UP_TO = 16
"""Up to this number of designs, each is searched in full; more are screened first."""
FIRST_LOOK = 16
"""Screening is a search by Algorithm 1 with the number of candidates divided by this."""
MARGIN = 0.3
MARGIN_AP = 0.05
"""A design worse than the front by more than this after screening is not searched [nats; expected
AP]: usually the rest of a search gains less. The rest gained 0 to 0.016 of AP for four designs of
`blend_assets/choices` with 160 candidates."""
EVALUATIONS_A_VARIABLE = 25
LEAST_EVALUATIONS = 60
"""Evaluations of one point of the front where the study has no budget."""


class FrontJournals:
    """The journals of several searches, by the name of each; `known` are of an interrupted run."""

    def __init__(self, known: Mapping[str, Iterable[EvaluatedRig]] | None = None) -> None:
        self._known = {name: tuple(entries) for name, entries in (known or {}).items()}
        self._journals: dict[str, Journal] = {}

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the entries: searches that begin anew continue them."""
        return FrontJournals, (self.entries(),)

    def begin(self, name: str) -> Journal:
        """Return the journal of a search that begins; it continues a known one."""
        self._journals[name] = Journal(self._known.get(name, ()), SEARCH)
        return self._journals[name]

    def require_used(self) -> None:
        """Raise `InputError` where a search has entries left, or was not begun: call it at the end
        of the front."""
        for name in self._known:
            if name not in self._journals:
                expected = "journals of the searches of this front"
                raise InputError(SEARCH, "journals", expected, shown(name))
            self._journals[name].require_used()

    @property
    def count(self) -> int:
        """Number of entries so far, those of searches that have not begun again included."""
        return sum(map(len, self.entries().values()))

    def entries(self) -> dict[str, tuple[EvaluatedRig, ...]]:
        """Return all entries by search; may be read while another thread searches."""
        return self._known | {name: each.entries for name, each in self._journals.items()}


class FrontJob(Job):
    """Computes the Pareto front of the designs and placements of a study.

    Up to `ALL_SEARCHED_UP_TO` designs are searched one by one. More designs are screened first with
    fewer candidates, and those within `MARGIN` of the front of price and the study's objective are
    searched. Of more than `design_space.ALL_UP_TO` designs, only those that a local search visits
    are screened. The search of a design does not depend on the other designs.

    A study without objectives of its own has a front of price and entropy (or AP): each design is
    searched with `OptimizeJob`. For several objectives, the first searches of a design look for the
    best value of each objective alone, the others for the best of an even spread of weights
    (`ScalarValue`). Each begins at the best placement found so far for its weights. Of the
    placements that were the best of a search, and that no other one beats in all objectives,
    `points` that are far from each other are scored.

    Candidates are evaluated by the job's executor, or by processes.

    Parameters
    ----------
    study : Study
    workers : int, optional
        As of `Job`.
    objectives : sequence of str or callable, optional
        Two or more, in place of the study's: names of `FIGURES`, and functions that take a `Rig`
        and return a number; lower is better. Processes evaluate a function that can be pickled.

    Attributes
    ----------
    trade_off : TradeOff or None
        The result so far; None before the first design.
    journals : FrontJournals
        Of all searches; those of an interrupted job may be set before this one begins.
    """

    shown = ("evaluations",)
    kept = ("journals",)

    def __init__(
        self,
        study: Study,
        workers: int | None = None,
        objectives: Sequence[str | Callable[[Rig], float]] = (),
    ) -> None:
        super().__init__(study, workers)
        front = study.search.goals.front
        value = AP if is_by_ap(study) else ENTROPY
        given = tuple(objectives) or tuple(front.objectives)
        self.names, self._own = objectives_of(given or (PRICE, value))
        self._several = bool(given)
        self.points = front.points
        self.journals = FrontJournals()
        self.is_done = False
        self.evaluations = 0
        self._designs = study.designs()
        self._designs.require(self.names)
        self._errors: dict[Picks, InputError] = {}
        self._possible: int | None = None
        self._found: dict[Picks, list[Design]] = {}
        self._inner: _DesignJob | None = None
        self._helpers: ExecutorSource | None = None
        self._open = ExitStack()

    @property
    def trade_off(self) -> TradeOff | None:
        """The result so far; None before the first design, and after `drop`."""
        if self.dropped or not self._found:
            return None
        ordered = self._named()
        compared = [d for d in ordered if d.score is not None] or ordered
        if self.study.limits.keeps_requirements:  # those that break the fewest
            broken = [len(design.broken) + design.is_infeasible for design in compared]
            fewest = min(broken)
            compared = [d for d, n in zip(compared, broken, strict=True) if n == fewest]
        front = sorted(pareto_front([tuple(d.costs(self.names)) for d in compared]))
        refused = design_names([self._designs.models(picks) for picks in self._errors])
        return TradeOff(
            study=self.study,
            designs=tuple(ordered),
            front=tuple(compared[k] for k in front),
            refused=dict(zip(refused, map(str, self._errors.values()), strict=True)),
            is_complete=len(self._found) + len(self._errors) == self._possible,
            stopped=self.stopped,
            seconds=self.seconds,
            objectives=self.names,
        )

    result = trade_off

    def _named(self) -> list[Design]:
        """Return all designs by their costs. Where a design has several points of the front, names
        have what they are best at, or their number."""
        names = design_names([self._designs.models(picks) for picks in self._found])
        named = [
            replace(design, name=name if self.study.selection.choices else "")
            for name, designs in zip(names, self._found.values(), strict=True)
            for design in designs
        ]
        named.sort(key=lambda design: design.costs(self.names))
        costs = [design.costs(self.names) for design in named]
        lowest = [min(column) for column in zip(*costs, strict=True)]
        for number, own in enumerate(costs if self._several else ()):
            pairs = zip(self.names, own, lowest, strict=True)
            best = [name for name, cost, low in pairs if name not in SUMS and cost == low]
            point = f"point {number + 1}"
            point += f", best {best[0].replace('_', ' ')}" if best else ""
            parts = [part for part in (named[number].name, point) if part]
            named[number] = replace(named[number], name=", ".join(parts))
        return named

    def stop(self) -> bool:
        """Stop the search; keep the design under search and the front so far."""
        if self._inner is not None:
            self._inner.stop()
        return super().stop()

    def drop(self) -> None:
        """Cancel the job; discard its results."""
        super().drop()
        if self._inner is not None:
            self._inner.drop()

    def __iter__(self) -> Iterator[Progress]:
        with self._open:
            wanted = self._designs.first(ALL_SEARCHED_UP_TO + 1)
            self._possible = len(wanted)
            if len(wanted) > ALL_SEARCHED_UP_TO:
                wanted = yield from self._screened()
            search = self._search_points if self._several else self._search_once
            for number, picks in enumerate(wanted):
                if self.stopped:
                    break
                yield from self._kept(picks, search(picks, number / len(wanted), 1.0 / len(wanted)))
        if not self._found and self._errors:
            raise next(iter(self._errors.values()))
        if not self.stopped and self.study.search.goals.stop.seconds is None:
            self.journals.require_used()
        self.is_done = True
        yield Progress("done", 1.0, evaluations=self.evaluations)

    def _screened(self) -> Generator[Progress, None, list[Picks]]:
        """Search designs with few candidates; return those near the front, the nearest first."""
        screening = DesignSearch(self._designs)
        self._possible = screening.max_designs if screening.is_complete else None
        while (batch := screening.ask()) and not self.stopped:
            for picks in batch:
                if self.stopped:
                    break
                done = (len(self._found) + len(self._errors)) / screening.max_designs
                yield from self._kept(picks, self._screen(picks, done))
            screening.tell({picks: design.value for picks, [design] in self._found.items()})
        evaluated = list(self._found)
        margin = MARGIN_AP if is_by_ap(self.study) else MARGIN
        figures = [(design.price, design.value) for [design] in self._found.values()]
        above = dict(zip(evaluated, above_front(figures), strict=True))
        near = [picks for picks in evaluated if above[picks] <= margin]
        return sorted(near, key=lambda p: (above[p], self._found[p][0].price, p))

    def _kept(
        self, picks: Picks, search: Generator[Progress, None, list[Design]]
    ) -> Generator[Progress, None, None]:
        """Keep what a search of a design finds, or why the design has no placement."""
        try:
            found = yield from search
        except InputError as error:
            self._errors[picks] = error
            self._found.pop(picks, None)
            return
        finally:
            self._inner = None
        if found:
            self._found[picks] = found

    def _screen(self, picks: Picks, done: float) -> Generator[Progress, None, list[Design]]:
        study = self._study_of(picks)
        schedule = study.search.schedule
        fewer = replace(schedule, candidates=max(1, schedule.candidates // FIRST_LOOK))
        search = replace(study.search, method=SCHEDULED_METHOD, schedule=fewer, evaluations=0)
        job = self._begin("first look " + _digits(picks), replace(study, search=search))
        yield from self._steps(job.look(), "looking at designs", done, 0.0)
        if not job.history:
            return []
        value = job.reported_value(job.best.rig)
        key = AP if is_by_ap(study) else ENTROPY
        figures = {key: job.figure.to_figure(value)}
        design = self._design(picks, study.with_rig(job.best.rig), figures)
        return [replace(design, violation=value.violation)]

    def _search_once(
        self, picks: Picks, done: float, share: float
    ) -> Generator[Progress, None, list[Design]]:
        job = self._begin("search " + _digits(picks), self._study_of(picks))
        yield from self._steps(job, "searching designs", done, share)
        if (found := job.outcome) is None:
            return []
        figures = {ENTROPY: found.after.entropy}
        if found.in_traffic is not None:
            figures = {AP: found.in_traffic[1].ap, **figures}
        design = self._design(picks, found.study, figures)
        score = replace(found.after, ground_map=None)
        return [replace(design, score=score, warnings=found.warnings, verdicts=found.verdicts)]

    def _search_points(
        self, picks: Picks, done: float, share: float
    ) -> Generator[Progress, None, list[Design]]:
        """Search the points of one design; the best of all searches are the front's candidates."""
        study = self._study_of(picks)
        moving = self._measured.names
        search = study.search
        points = weights_of(max(self.points, len(moving)), len(moving))
        least = max(LEAST_EVALUATIONS, EVALUATIONS_A_VARIABLE * len(study.coding().variables))
        budget = max(1, search.evaluations // self.points) if search.evaluations else least
        goals = replace(search.goals, starts=[], stop=Stop())
        study = replace(study, search=replace(search, evaluations=budget, goals=goals))
        archive: list[Rig] = []
        for k, weights in enumerate(points):
            if self.stopped:
                break
            rigs = archive or [study.rig]
            columns = list(zip(*map(self._measured.costs, rigs), strict=True))
            ideal = [min(column) for column in columns]
            span = [max(c) - min(c) or max(abs(min(c)), 1.0) for c in columns]
            scalar = ScalarValue(self._measured, weights, ideal, span)
            value = Objective(scalar, constraints_of(study))
            begin = study.with_rig(min(rigs, key=value.value))
            job = self._begin(f"point {_digits(picks)} {k}", begin, [value])
            yield from self._steps(
                job.look(),
                f"searching {self.points} points",
                done + share * k / len(points),
                share / len(points),
            )
            archive += [row.rig for row in job.history if row.value.is_feasible]
        front = sorted(pareto_front(costs := [self._measured.costs(rig) for rig in archive]))
        designs = []
        for k in spread([costs[k] for k in front], self.points):
            rig = archive[front[k]]
            waiting = Progress("scoring the front", done + share)
            score = yield from self._score(rig, waiting, to_the_end=True)
            if score is None:
                return []
            placed = self._study_of(picks).with_rig(rig)
            verdicts = (yield from self._verdicts(placed, waiting)) or ()
            design = self._design(picks, placed, self._reported.scored(rig, score))
            score = replace(score, ground_map=None)
            designs.append(replace(design, score=score, verdicts=verdicts))
        return designs

    @cached_property
    def _measured(self) -> FrontFigures:
        """Computes the objectives of candidates, of all designs; it is sent once."""
        return self._figures_on(SEARCHED)

    @cached_property
    def _reported(self) -> FrontFigures:
        """Computes the objectives of the front's designs, on samples that no search uses."""
        return self._figures_on(CENTERED)

    def _figures_on(self, shift: Shift) -> FrontFigures:
        samples = self.study.search.samples
        moving = [name for name in self.names if name not in SUMS]
        evaluator = self.evaluators.on(samples, shift)
        in_traffic = None
        if is_by_ap(self.study):
            in_traffic = self.evaluators.searching(samples, shift)
        return FrontFigures(self.study, moving, evaluator, in_traffic, own=self._own)

    def _design(self, picks: Picks, study: Study, figures: FrontValues) -> Design:
        if self.study.selection.choices:
            figures = {PRICE: self._designs.price(picks), **figures}
        sums = {key: self._designs.sum(key, picks) for key in SUMS if key in self.names}
        figures = {**sums, **figures}
        return Design("", self._designs.models(picks), study, figures)

    def _study_of(self, picks: Picks) -> Study:
        models = self._designs.models(picks)
        sheets = self._designs.sheets(picks)
        return design_study(self.study, models, sheets) if models else self.study

    def _begin(
        self, name: str, study: Study, objectives: list[Objective] | None = None
    ) -> _DesignJob:
        """Return the job of a search, with its journal."""
        self._inner = job = _DesignJob(study, self)
        if objectives is not None:
            job._objectives = objectives
            job.target = None  # of another value
        job.journal = self.journals.begin(name)
        return job

    def _steps(
        self, steps: Iterable[Progress], stage: str, done: float, share: float
    ) -> Iterator[Progress]:
        """Yield the progress of a search as this job's."""
        before = self.evaluations
        fraction = 0.0
        for progress in steps:
            if progress.stage == _DesignJob.SEARCHING:
                fraction = progress.fraction
            self.evaluations = before + progress.evaluations
            yield Progress(stage, done + share * fraction, evaluations=self.evaluations)

    def helpers(self, objectives: Sequence[Objective]) -> ExecutorSource:
        """Return what evaluates the candidates of all designs; it is made for the first one. All
        models that may be chosen go to the workers at once, with the evaluators of all levels."""
        if self._helpers is None:
            offered = [o.model for c in self.study.selection.choices for o in c.options]
            levels = map(self.evaluators.searching, self.study.level_samples)
            helpers = candidate_workers(self, objectives, [*levels, *offered])
            self._helpers = self._open.enter_context(helpers)
        return self._helpers


def _digits(picks: Picks) -> str:
    return "-".join(map(str, picks))


def has_front(study: Study) -> bool:
    """Whether a search of a study computes a front."""
    return bool(study.selection.choices or study.search.goals.front.objectives)


class _DesignJob(OptimizeJob):
    """The search of one design, with the evaluators and the workers that all designs share."""

    SEARCHING = "optimizing"
    analyses = False
    parts = 1

    def __init__(self, study: Study, parent: FrontJob) -> None:
        super().__init__(study, parent.workers)
        self._parent = parent
        self.evaluators = parent.evaluators

    def _evaluator_of(self, samples: int) -> RigEvaluator:
        return self.evaluators.searching(samples)

    def _figures(
        self, rigs: Sequence[Rig], waiting: Progress
    ) -> ProgressSteps[tuple[KeyFigures, ...]]:
        """Return the key figures only where some are wanted: a design shows its objectives."""
        if self.study.limits != Limits():
            return (yield from super()._figures(rigs, waiting))
        return ()

    def _candidate_workers(self) -> AbstractContextManager[ExecutorSource]:
        return nullcontext(self._parent.helpers(self._objectives))

    def look(self) -> Iterator[Progress]:
        """Search without scoring the start and the result."""
        yield from self._beside(lambda _: self._checked(), Progress("preparing", 0.0))
        with self._candidate_workers() as self._helpers:
            yield from self._search()

"""The job that computes a Pareto front: of price and one value, or of several objectives."""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import NamedTuple

from pe_core.base.errors import InputError
from pe_core.scene.rig import Rig
from pe_core.scoring import RigEvaluator
from pe_core.search import (
    SCHEDULED_METHOD,
    DesignSearch,
    Objective,
    Picks,
    above_front,
    feasible_start,
    optimize,
    pareto_front,
)
from pe_core.search.goals import AP, ENTROPY, PRICE
from pe_core.study.condition_table import is_by_ap
from pe_core.study.requirement_search import (
    FeasibilityRule,
    FeasibleFirst,
    constraints_of,
    feasible_first,
    is_infeasible,
)
from pe_core.study.study import Study

from .candidate_workers import ExecutorSource, candidate_workers
from .checkpoint import FrontJournals
from .front_objectives import (
    FrontFigures,
    ScalarValue,
    check_objectives,
    costs_of,
    spread,
    weights_of,
)
from .job import Job, Progress, begun
from .score_and_optimize import OptimizeJob
from .trade_off import Design, Models, TradeOff, design_names, design_study

ALL_SEARCHED_UP_TO = 16
"""Up to this number of designs, each is searched in full; more are screened first."""
FIRST_LOOK = 16
"""Screening is a search by Algorithm 1 with the number of candidates divided by this."""
MARGIN, MARGIN_AP = 0.3, 0.05
"""A design worse than the front by more than this after screening is not searched [nats; expected
AP]: usually the rest of a search gains less. The rest gained 0 to 0.016 of AP for four designs of
`blend_assets/choices` with 160 candidates."""
EVALUATIONS_A_VARIABLE, LEAST_EVALUATIONS = 25, 60
"""Evaluations of one point of the front where the study has no budget."""


class _Searched(NamedTuple):
    """A design that is searched for several objectives."""

    models: Models
    price: float
    study: Study
    figures: FrontFigures
    constraints: tuple[FeasibilityRule, ...]
    variables: int
    starts: list[Rig]
    """The start, unless it breaks a rule."""


class FrontJob(Job):
    """Computes the Pareto front of the designs and placements of a study.

    Without objectives of its own, a study with choices has a front of price and entropy (or AP).
    Up to `ALL_SEARCHED_UP_TO` designs are searched one by one with `OptimizeJob`. More designs are
    screened first with fewer candidates, and those within `MARGIN` of the front are searched. Of
    more than `design_space.ALL_UP_TO` designs, only those that a local search visits are screened.
    The search of a design does not depend on the other designs.

    For several objectives, the first searches of a design look for the best value of each objective
    alone, the others for the best of an even spread of weights (`ScalarValue`). Each begins at the
    best placement found so far for its weights. Of all placements that were the best of a search,
    those that no other one beats in all objectives are on the front; of many, `points` that are far
    from each other are scored. With choices, each of up to `ALL_SEARCHED_UP_TO` designs is searched
    like this.

    Candidates are evaluated by the job's executor, or by processes.

    Attributes
    ----------
    trade_off : TradeOff or None
        The result. While the job runs it is the result so far; of several objectives, None until
        the front is scored.
    journals : FrontJournals
        Of all searches; those of an interrupted job may be set before this one begins.
    """

    shown, kept = ("evaluations",), ("journals",)

    def __init__(self, study: Study, workers: int | None = None) -> None:
        super().__init__(study, workers)
        front = study.search.goals.front
        self.names, self.points = tuple(front.objectives), front.points
        if self.names:
            check_objectives(study, self.names)
        self.journals = FrontJournals()
        self.evaluations = 0
        self._designs = study.designs()
        self._errors: dict[Picks, InputError] = {}
        self._complete = False
        self._found: dict[Picks, Design] = {}
        self._inner: _DesignJob | None = None
        self._helpers: ExecutorSource | None = None
        self._open = ExitStack()
        self._searched: list[_Searched] = []
        self._scored: list[Design] = []

    @property
    def trade_off(self) -> TradeOff | None:
        """The result so far; None before the first design, and after `drop`."""
        if self.dropped:
            return None
        if self.names:
            return self._of_objectives() if self._scored else None
        return self._of_prices() if self._found else None

    def stop(self) -> None:
        """Stop the search; keep the design under search and the front so far."""
        super().stop()
        if self._inner is not None:
            self._inner.stop()

    def drop(self) -> None:
        """Cancel the job; discard its results."""
        super().drop()
        if self._inner is not None:
            self._inner.drop()

    def __iter__(self) -> Iterator[Progress]:
        with self._open:
            yield from self._search_points() if self.names else self._search_designs()
        if not (self._found or self._searched) and self._errors:
            raise next(iter(self._errors.values()))
        yield Progress("done", 1.0, evaluations=self.evaluations)

    def _trade_off(self, designs: Sequence[Design], front: Sequence[Design]) -> TradeOff:
        models = [self._designs.models(picks) for picks in self._errors]
        errors = zip(design_names(models), self._errors.values(), strict=True)
        return TradeOff(
            self.study,
            tuple(designs),
            tuple(front),
            {name: str(error) for name, error in errors},
            self._complete,
            self.stopped,
            self.seconds,
            self.names or ((PRICE, AP) if is_by_ap(self.study) else ()),
        )

    # Of price and one value: a full search of each design.

    def _of_prices(self) -> TradeOff:
        names = design_names([design.models for design in self._found.values()])
        both = zip(self._found.values(), names, strict=True)
        named = [replace(design, name=name) for design, name in both]
        ordered = sorted(named, key=lambda design: (design.price, design.value))
        compared = [d for d in ordered if d.score is not None] or ordered
        if self.study.search.requirements:  # those that break the fewest
            broken = [len(design.broken) + design.is_led_in for design in compared]
            fewest = min(broken)
            compared = [d for d, n in zip(compared, broken, strict=True) if n == fewest]
        front = pareto_front([(design.price, design.value) for design in compared])
        return self._trade_off(ordered, [compared[k] for k in front])

    def _search_designs(self) -> Iterator[Progress]:
        wanted = self._designs.first(ALL_SEARCHED_UP_TO + 1)
        possible: int | None = len(wanted)
        if len(wanted) > ALL_SEARCHED_UP_TO:
            screening = DesignSearch(self._designs)
            possible = screening.max_designs if screening.is_complete else None
            yield from self._screen_all(screening, possible)
            # Those within a margin of the front are searched, the nearest first.
            evaluated, margin = list(self._found), MARGIN_AP if is_by_ap(self.study) else MARGIN
            figures = [(self._found[p].price, self._found[p].value) for p in evaluated]
            above = dict(zip(evaluated, above_front(figures), strict=True))
            near = [picks for picks in evaluated if above[picks] <= margin]
            wanted = sorted(near, key=lambda p: (above[p], self._found[p].price, p))
        for number, picks in enumerate(wanted):
            if self.stopped:
                break
            yield from self._search_design(picks, number, len(wanted))
            self._complete = len(self._found) + len(self._errors) == possible

    def _screen_all(self, screening: DesignSearch, possible: int | None) -> Iterator[Progress]:
        """Screen designs with few candidates each."""
        while (batch := screening.ask()) and not self.stopped:
            for picks in batch:
                if self.stopped:
                    return
                done = (len(self._found) + len(self._errors)) / screening.max_designs
                yield from self._screen(picks, Progress("looking at designs", done))
                self._complete = len(self._found) + len(self._errors) == possible
            screening.tell({picks: design.value for picks, design in self._found.items()})

    def _screen(self, picks: Picks, progress: Progress) -> Iterator[Progress]:
        """Search a design with few candidates, and store the result."""
        try:
            job = self._job_of(picks, "first look")
            full_search = job.study.search
            schedule = full_search.schedule
            fewer = replace(schedule, candidates=max(1, schedule.candidates // FIRST_LOOK))
            few = replace(full_search, method=SCHEDULED_METHOD, schedule=fewer, evaluations=0)
            job.study = replace(job.study, search=few)
            for _ in job.look():
                yield progress
        except InputError as error:
            self._errors[picks] = error
            return
        if job.history:
            study, value = replace(job.best, search=full_search), job.history[-1].entropy
            by_ap = is_by_ap(self.study) and not is_infeasible(value)
            entropy, figures = (math.nan, {AP: -value}) if by_ap else (value, {})
            self._keep(picks, Design("", 0.0, {}, study, entropy, figures=figures))

    def _search_design(self, picks: Picks, number: int, count: int) -> Iterator[Progress]:
        """Search a design in full, and store the result."""
        stage, fraction = f"searching {count} designs", 0.0
        try:
            self._inner = job = self._job_of(picks, "search")
            for progress in job:
                if progress.stage == job.SEARCHING:
                    fraction = progress.fraction
                done = (number + fraction) / count
                yield Progress(stage, done, evaluations=progress.evaluations)
        except InputError as error:
            self._errors[picks] = error
            self._found.pop(picks, None)
            return
        finally:
            self._inner = None
        if (outcome := job.outcome) is not None:
            score = replace(outcome.after, ground_map=None)
            found = (outcome.study, score.entropy, score, outcome.warnings, outcome.verdicts)
            after = outcome.in_traffic
            figures = {} if after is None else {AP: after[1].ap, ENTROPY: score.entropy}
            self._keep(picks, Design("", 0.0, {}, *found, figures))

    def _keep(self, picks: Picks, design: Design) -> None:
        models, price = self._designs.models(picks), self._designs.price(picks)
        figures = {PRICE: price, **design.figures} if design.figures else {}
        self._found[picks] = replace(design, models=models, price=price, figures=figures)

    def _job_of(self, picks: Picks, stage: str) -> _DesignJob:
        job = _DesignJob(design_study(self.study, self._designs.models(picks)), self)
        job.journal = self.journals.begin(f"{stage} {'-'.join(map(str, picks))}")
        return job

    def helpers(self, objectives: Sequence[Objective]) -> ExecutorSource:
        """Return what evaluates the candidates of all designs; it is made for the first one.

        All models that may be chosen go to the workers at once, with the evaluators of all levels.
        """
        if self._helpers is None:
            offered = [o.model for c in self.study.selection.choices for o in c.options]
            levels = map(self.evaluators.searching, self.study.search.level_samples)
            common = [*levels, *offered, *(sensor.model for sensor in self.study.rig)]
            self._helpers = self._open.enter_context(candidate_workers(self, objectives, common))
        return self._helpers

    # Of several objectives: a search of each design for each point.

    def _of_objectives(self) -> TradeOff:
        costs = [costs_of(d.figures, self.names) for d in self._scored]
        order = sorted(range(len(costs)), key=lambda k: costs[k])
        named = self._named([self._scored[k] for k in order])
        best = sorted(pareto_front([costs[k] for k in order]))
        return self._trade_off(named, [named[k] for k in best])

    def _named(self, designs: list[Design]) -> list[Design]:
        """Return the designs with names: what they are best at, or their number on the front."""
        models = design_names([each.models for each in self._searched])
        by_models = dict(zip((str(s.models) for s in self._searched), models, strict=True))
        costs = [costs_of(d.figures, self.names) for d in designs]
        lowest = dict(zip(self.names, map(min, zip(*costs, strict=True)), strict=True))
        named = []
        for number, (design, own) in enumerate(zip(designs, costs, strict=True), 1):
            pairs = zip(self.names, own, strict=True)
            best = [name for name, cost in pairs if name != PRICE and cost == lowest[name]]
            name = f"point {number}"
            name += f", best {best[0].replace('_', ' ')}" if best else ""
            if self.study.selection.choices:
                name = f"{by_models[str(design.models)]}, {name}"
            named.append(replace(design, name=name))
        return named

    def _search_points(self) -> Iterator[Progress]:
        waiting = Progress("preparing", 0.0)
        if (yield from self._beside(lambda _: self._prepare(), waiting)) is None:
            return
        models = (sensor.model for each in self._searched for sensor in each.study.rig)
        found: list[tuple[_Searched, Rig]] = []
        none, one = [0.0] * len(self.names), [1.0] * len(self.names)
        values = (  # of each design: what its searches share goes to the workers beforehand
            feasible_first(ScalarValue(each.figures, none, none, one), each.constraints)
            for each in self._searched
        )
        self._helpers = self._open.enter_context(candidate_workers(self, values, models))
        for number, searched in enumerate(self._searched):
            if self.stopped:
                break
            archive = yield from self._search_weights(number, searched)
            found += [(searched, rig) for rig in archive]
        self._open.close()
        if not self.dropped and found:
            yield from self._score_front(found)

    def _prepare(self) -> bool:
        """Make the designs and their objectives; a design without a placement is refused."""
        picks = self._designs.first(ALL_SEARCHED_UP_TO + 1)
        self._complete = len(picks) <= ALL_SEARCHED_UP_TO
        samples = self.study.search.samples
        shared = self.evaluators.on(samples)
        in_traffic = self.evaluators.searching(samples) if is_by_ap(self.study) else None
        for each in picks[:ALL_SEARCHED_UP_TO]:
            models, price = self._designs.models(each), self._designs.price(each)
            try:
                study = design_study(self.study, models) if models else self.study
                coding = study.coding()
                start = feasible_start(coding, study.search.seed)
            except InputError as error:
                self._errors[each] = error
                continue
            figures = FrontFigures(study, self.names, shared, price, in_traffic)
            free, starts = len(coding.variables), [study.rig] if start is coding.start else []
            searched = models, price, study, figures, constraints_of(study), free, starts
            self._searched.append(_Searched(*searched))
        return True

    def _search_weights(
        self, number: int, searched: _Searched
    ) -> Generator[Progress, None, list[Rig]]:
        """Search the points of one design; return all placements that were the best of a search."""
        moving = [n for n in self.names if n != PRICE]
        weights = weights_of(max(self.points, len(moving)), len(moving))
        archive: list[Rig] = []
        for k, alone in enumerate(weights):
            if self.stopped:
                break
            by_name = dict(zip(moving, alone, strict=True))
            wanted = [by_name.get(name, 0.0) for name in self.names]
            done = (number + k / len(weights)) / len(self._searched)
            part = done, 1.0 / (len(self._searched) * len(weights))
            yield from self._search_point(f"point {number}-{k}", searched, wanted, archive, part)
        return archive

    def _search_point(
        self,
        name: str,
        searched: _Searched,
        weights: list[float],
        archive: list[Rig],
        part: tuple[float, float],
    ) -> Iterator[Progress]:
        """Search from the best placement so far; add each that becomes the best to the archive."""
        study, rigs = searched.study, [*archive, *searched.starts]
        costs = [searched.figures.costs(rig) for rig in rigs] or [[0.0] * len(self.names)]
        columns = list(zip(*costs, strict=True))
        ideal = [min(column) for column in columns]
        span = [max(c) - min(c) or max(abs(min(c)), 1.0) for c in columns]
        scalar = ScalarValue(searched.figures, weights, ideal, span)
        value = feasible_first(scalar, searched.constraints)
        begin = min(rigs, key=value.entropy, default=study.rig)
        least = max(LEAST_EVALUATIONS, EVALUATIONS_A_VARIABLE * searched.variables)
        search = study.search
        steps = optimize(
            self.journals.begin(name).wrap([value]),
            begin,
            study.with_rig(begin).search_space(),
            search.seed,
            method=search.method,
            evaluations=search.evaluations // self.points if search.evaluations else least,
            executor=self._helpers,
        )
        stage, before = f"searching {self.points} points", self.evaluations

        def now() -> Progress:
            return Progress(stage, part[0], evaluations=self.evaluations)

        while step := (yield from self._awaited(begun(lambda: next(steps, None)), now)):
            self.evaluations = before + step.evaluations
            is_new = step.improved or step.evaluations == 1
            if is_new and not (isinstance(value, FeasibleFirst) and value.violation(step.best)):
                archive.append(step.best)
            done = part[0] + part[1] * step.fraction
            yield Progress(stage, done, evaluations=self.evaluations)

    def _score_front(self, found: list[tuple[_Searched, Rig]]) -> Generator[Progress, None, None]:
        """Score placements of the front in full; what is beaten then is told, too."""
        costs = [searched.figures.costs(rig) for searched, rig in found]
        front = sorted(pareto_front(costs))
        chosen = spread([costs[k] for k in front], self.points * len(self._searched))
        designs = []
        for number, k in enumerate(front[j] for j in chosen):
            searched, rig = found[k]
            study = searched.study.with_rig(rig)
            waiting = Progress("scoring the front", number / len(chosen))
            score = yield from self._score(rig, waiting, to_the_end=True)
            if score is None:
                return
            verdicts = yield from self._verdicts(study, waiting)
            figures = searched.figures.scored(rig, score)
            score = replace(score, ground_map=None)
            design = Design("", searched.price, searched.models, study, score.entropy, score)
            designs.append(replace(design, verdicts=verdicts or (), figures=figures))
        self._scored = designs


def has_front(study: Study) -> bool:
    """Whether a search of a study computes a front."""
    return bool(study.selection.choices or study.search.goals.front.objectives)


class _DesignJob(OptimizeJob):
    """The search of one design, with the evaluators and the workers that all designs share."""

    SEARCHING = "optimizing"
    analyses = False

    def __init__(self, study: Study, parent: FrontJob) -> None:
        super().__init__(study, parent.workers)
        self._parent, self.evaluators = parent, parent.evaluators

    def _evaluator_of(self, samples: int) -> RigEvaluator:
        return self.evaluators.searching(samples)

    @contextmanager
    def _candidate_workers(self) -> Iterator[ExecutorSource]:
        yield self._parent.helpers(self._objectives)

    def look(self) -> Iterator[Progress]:
        """Search without scoring the start and the result."""
        yield from self._beside(lambda _: self._checked(), Progress("preparing", 0.0))
        with self._candidate_workers() as self._helpers:
            yield from self._search()

"""The job that chooses sensors: screen designs, search the promising ones, compute the front."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace

from pe_core.base.errors import InputError
from pe_core.scoring import RigEvaluator
from pe_core.scoring.requirements import Verdict
from pe_core.scoring.score import Score
from pe_core.search import (
    SCHEDULED_METHOD,
    DesignSearch,
    Objective,
    Picks,
    above_front,
    pareto_front,
)
from pe_core.search.goals import AP, ENTROPY, PRICE
from pe_core.study.objective_search import is_by_ap, search_evaluator
from pe_core.study.requirement_search import is_infeasible
from pe_core.study.study import Search, Study

from ..advice import Advice, curve_note, hardware_note
from .candidate_workers import ExecutorSource, candidate_workers
from .designed import Models, design_names, design_study
from .front_checkpoint import FrontJournals
from .job import Job, Progress
from .score_and_optimize import OptimizeJob

ALL_SEARCHED_UP_TO = 16
"""Up to this number of designs, each is searched in full; more are screened first."""
FIRST_LOOK = 16
"""Screening is a search by Algorithm 1 with the number of candidates divided by this."""
MARGIN, MARGIN_AP = 0.3, 0.05
"""A design worse than the front by more than this after screening is not searched [nats; expected
AP]: usually the rest of a search gains less. The rest gained 0 to 0.016 of AP for four designs of
`blend_assets/choices` with 160 candidates."""


@dataclass(frozen=True, slots=True)
class Design:
    """A design that was evaluated.

    Attributes
    ----------
    name : str
    price : float
    models : mapping of sensor name to SensorModel or None
        Models of the sensors that the study lets choose; None for a sensor that is left out.
    study : Study
        The design as a study, with the best placement found and without choices.
    entropy : float
        Entropy of that placement [nats]: that of the score, or, for a design that was only
        screened, that of the search; NaN after a screening by expected AP.
    score : Score, optional
        Score without a ground map; None for a design that was only screened.
    warnings : tuple of Advice
    verdicts : tuple of Verdict
        On the study's requirements; none for a design that was only screened.
    figures : mapping of str to float
        Its objectives by name, on a front of several. By expected AP: price, AP, and the entropy.
    """

    name: str
    price: float
    models: Models
    study: Study
    entropy: float
    score: Score | None = None
    warnings: tuple[Advice, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    figures: Mapping[str, float] = field(default_factory=dict)

    @property
    def broken(self) -> tuple[str, ...]:
        """Names of the requirements that are not met."""
        return tuple(verdict.requirement.name for verdict in self.verdicts if not verdict.met)

    @property
    def met_text(self) -> str:
        """How many requirements are met: "2 of 3 met"; empty where none was asked for."""
        count = len(self.verdicts)
        return f"{count - len(self.broken)} of {count} met" if count else ""

    @property
    def value(self) -> float:
        """What its search minimised, as scored: entropy [nats], or minus the expected AP."""
        return -self.figures[AP] if AP in self.figures else self.entropy

    @property
    def is_led_in(self) -> bool:
        """Whether `entropy` is no entropy: the screening found no placement to keep."""
        return self.score is None and is_infeasible(self.entropy)


@dataclass(frozen=True, slots=True)
class TradeOff:
    """The result of a choice of sensors.

    Attributes
    ----------
    study : Study
        The study with its choices.
    designs : tuple of Design
        All evaluated designs with a feasible placement, cheapest first.
    front : tuple of Design
        Designs that no other design beats in both price and entropy (or AP), cheapest first. Only
        designs that were searched are compared, if there are any; if the search keeps
        requirements, only those of them that break the fewest.
    refused : mapping of name to str
        Names of designs without a feasible placement, and the reason.
    is_complete : bool
        Whether all designs within the limits were evaluated.
    stopped : bool
        Whether the job was stopped early.
    seconds : float
    objectives : tuple of str
        Of a front of several objectives; none: it is that of price and entropy.
    """

    study: Study
    designs: tuple[Design, ...]
    front: tuple[Design, ...]
    refused: dict[str, str] = field(default_factory=dict)
    is_complete: bool = True
    stopped: bool = False
    seconds: float = 0.0
    objectives: tuple[str, ...] = ()

    @property
    def searched(self) -> int:
        """How many designs were searched in full."""
        return sum(design.score is not None for design in self.designs)

    @property
    def requirements_note(self) -> str:
        """What the designs of the front make of the study's requirements; empty without any."""
        count = len(self.study.requirements)
        if not count or not self.front or not self.searched:
            return ""
        fewest = min(len(design.broken) for design in self.front)
        if self.study.search.requirements and fewest:
            some = f"the fewest broken are {fewest}, by the designs of the front"
            return f"no design meets all {count} requirements: {some}"
        good = sum(not design.broken for design in self.front)
        return f"{good} of {len(self.front)} on the front meet all {count} requirements"

    @property
    def notes(self) -> list[str]:
        """What limits a front: entropies of designs with other sensors, provisional AP curves."""
        return [note for note in (self.hardware_note, curve_note([self.study.model])) if note]

    @property
    def hardware_note(self) -> str:
        """What limits a front by entropy of designs with other sensors; empty for others."""
        if self.objectives and ENTROPY not in self.objectives:
            return ""
        return hardware_note([s.model for s in design.study.rig] for design in self.front)


class ChoiceJob(Job):
    """Computes the Pareto front of price and entropy (or AP) among the designs of a study.

    Up to `ALL_SEARCHED_UP_TO` designs are searched one by one with `OptimizeJob`. More designs are
    screened first with fewer candidates, and those within `MARGIN` of the front are searched. Of
    more than `design_space.ALL_UP_TO` designs, only those that a local search visits are screened.
    The search of a design does not depend on the other designs.

    Attributes
    ----------
    trade_off : TradeOff or None
        The result; while the job runs, the result so far.
    journals : FrontJournals
        Of all searches; those of an interrupted job may be set before this one begins.
    """

    def __init__(self, study: Study, workers: int | None = None) -> None:
        super().__init__(study, workers)
        self._designs = study.designs()
        self._found: dict[Picks, Design] = {}
        self._errors: dict[Picks, InputError] = {}
        self._inner: _DesignJob | None = None
        self._possible: int | None = None
        self._evaluators: dict[int, RigEvaluator] = {}
        self._in_traffic: dict[int, RigEvaluator] = {}
        self._helpers: ExecutorSource | None = None
        self._open = ExitStack()
        self.journals = FrontJournals()

    @property
    def trade_off(self) -> TradeOff | None:
        """The result so far; None before the first design, and after `drop`."""
        if self.dropped or not self._found:
            return None
        ordered = sorted(self._named(), key=lambda design: (design.price, design.value))
        compared = [d for d in ordered if d.score is not None] or ordered
        if self.study.search.requirements:
            compared = _fewest_broken(compared)
        front = pareto_front([(design.price, design.value) for design in compared])
        names = design_names([self._designs.models(picks) for picks in self._errors])
        refused = {n: str(e) for n, e in zip(names, self._errors.values(), strict=True)}
        return TradeOff(
            self.study,
            tuple(ordered),
            tuple(compared[k] for k in front),
            refused,
            self._possible is not None and len(self._found) + len(self._errors) == self._possible,
            self.stopped,
            self.seconds,
            (PRICE, AP) if is_by_ap(self.study) else (),
        )

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
            yield from self._all()

    def _all(self) -> Iterator[Progress]:
        wanted = self._designs.first(ALL_SEARCHED_UP_TO + 1)
        if len(wanted) <= ALL_SEARCHED_UP_TO:
            self._possible = len(wanted)
        else:
            yield from self._look()
            wanted = self._promising()
        for number, picks in enumerate(wanted):
            if self.stopped:
                break
            yield from self._search(picks, number, len(wanted))
        if not self._found and self._errors:
            raise next(iter(self._errors.values()))
        yield Progress("done", 1.0)

    def _look(self) -> Iterator[Progress]:
        """Screen designs with few candidates each."""
        search = DesignSearch(self._designs)
        self._possible = search.max_designs if search.is_complete else None
        while (batch := search.ask()) and not self.stopped:
            for picks in batch:
                if self.stopped:
                    return
                done = (len(self._found) + len(self._errors)) / search.max_designs
                yield from self._screen(picks, Progress("looking at designs", done))
            search.tell({picks: design.value for picks, design in self._found.items()})

    def _promising(self) -> list[Picks]:
        """Return the designs within a margin of the front, those nearest to it first."""
        evaluated, margin = list(self._found), MARGIN_AP if is_by_ap(self.study) else MARGIN
        figures = [(self._found[picks].price, self._found[picks].value) for picks in evaluated]
        above = dict(zip(evaluated, above_front(figures), strict=True))
        near = [picks for picks in evaluated if above[picks] <= margin]
        return sorted(near, key=lambda picks: (above[picks], self._found[picks].price, picks))

    def _screen(self, picks: Picks, progress: Progress) -> Iterator[Progress]:
        """Search a design with few candidates, and store the result."""
        try:
            job = self._job_of(picks, "first look")
            full_search, search = job.study.search, _few_candidates(job.study.search)
            job.study = replace(job.study, search=search)
            for _ in job.look():
                yield progress
        except InputError as error:
            self._errors[picks] = error
            return
        if job.history:
            study, value = replace(job.best, search=full_search), job.history[-1].entropy
            if is_by_ap(self.study) and not is_infeasible(value):
                self._keep(picks, Design("", 0.0, {}, study, math.nan, figures={AP: -value}))
            else:
                self._keep(picks, Design("", 0.0, {}, study, value))

    def _search(self, picks: Picks, number: int, count: int) -> Iterator[Progress]:
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

    def _named(self) -> list[Design]:
        names = design_names([design.models for design in self._found.values()])
        both = zip(self._found.values(), names, strict=True)
        return [replace(design, name=name) for design, name in both]

    def _job_of(self, picks: Picks, stage: str) -> _DesignJob:
        job = _DesignJob(design_study(self.study, self._designs.models(picks)), self)
        job.journal = self.journals.begin(f"{stage} {'-'.join(map(str, picks))}")
        return job

    def evaluator_of(self, samples: int) -> RigEvaluator:
        """Return the evaluator with this number of samples; all designs share it.

        Designs differ only in their rigs, which the evaluator does not depend on.
        """
        sample_count = self.study.looks_at(samples)
        if sample_count == self.study.looks_at(self.study.samples):
            return self._evaluator
        if sample_count not in self._evaluators:
            self._evaluators[sample_count] = self.study.evaluator(samples, self.workers)
        return self._evaluators[sample_count]

    def search_evaluator_of(self, samples: int) -> RigEvaluator:
        """Return what evaluates candidates with this number of samples; all designs share it."""
        if not is_by_ap(self.study):
            return self.evaluator_of(samples)
        if samples not in self._in_traffic:
            self._in_traffic[samples] = search_evaluator(self.study, samples, self.workers)
        return self._in_traffic[samples]

    def helpers(self, objectives: Sequence[Objective]) -> ExecutorSource:
        """Return what evaluates the candidates of all designs; it is made for the first one.

        All models that may be chosen go to the workers at once, with the evaluators of all levels.
        """
        if self._helpers is None:
            offered = [o.model for c in self.study.selection.choices for o in c.options]
            levels = map(self.search_evaluator_of, self.study.search.level_samples)
            common = [*levels, *offered, *(sensor.model for sensor in self.study.rig)]
            self._helpers = self._open.enter_context(candidate_workers(self, objectives, common))
        return self._helpers


class _DesignJob(OptimizeJob):
    """The search of one design, with the evaluators that all designs share."""

    SEARCHING = "optimizing"
    analyses = False

    def __init__(self, study: Study, parent: ChoiceJob) -> None:
        super().__init__(study, parent.workers)
        self._parent = parent

    @property
    def _evaluator(self) -> RigEvaluator:  # type: ignore[override]
        return self._parent.evaluator_of(self.study.samples)

    def _evaluator_of(self, samples: int) -> RigEvaluator:
        return self._parent.search_evaluator_of(samples)

    def _own_evaluator_of(self, samples: int) -> RigEvaluator:
        return self._parent.evaluator_of(samples)

    @contextmanager
    def _candidate_workers(self) -> Iterator[ExecutorSource]:
        yield self._parent.helpers(self._objectives)

    def look(self) -> Iterator[Progress]:
        """Search without scoring the start and the result."""
        waiting = Progress("preparing", 0.0)
        yield from self._beside(self._checked, lambda: waiting)
        with self._candidate_workers() as self._helpers:
            yield from self._search()


def _fewest_broken(designs: Sequence[Design]) -> list[Design]:
    """Return the designs that break the fewest requirements: the feasible ones, if any is."""
    broken = [len(design.broken) + design.is_led_in for design in designs]
    return [d for d, count in zip(designs, broken, strict=True) if count == min(broken)]


def _few_candidates(search: Search) -> Search:
    schedule = search.schedule
    fewer = replace(schedule, candidates=max(1, schedule.candidates // FIRST_LOOK))
    return replace(search, method=SCHEDULED_METHOD, schedule=fewer, evaluations=0)

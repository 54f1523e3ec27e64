"""Which sensors, as one job: designs looked at, the promising ones searched, the Pareto front."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from ..advice import Advice
from ..errors import InputError
from ..scoring import RigJudge
from ..scoring.score import Score
from ..search import DesignSearch, Picks, above_front, pareto_front
from .designed import Models, design_names, design_study
from .job import Job, Progress
from .jobs import OptimizeJob
from .study import Search, Study

ALL_SEARCHED_UP_TO = 16
"""Of so many designs each is searched in full; more are looked at first."""
PAPER_METHOD = "random"
FIRST_LOOK = 16
"""A first look is a search by Algorithm 1 with so many times fewer candidates."""
MARGIN = 0.3
"""A design that is higher above the front than this after the first look is not searched [nats]:
more than what the rest of a search gains as a rule."""


@dataclass(frozen=True, slots=True)
class Design:
    """A design that was looked at.

    Attributes
    ----------
    name : str
    price : float
    models : mapping of sensor name to SensorModel or None
        Of the sensors that are chosen; None: left out.
    study : Study
        With the best placement found, and nothing to choose.
    entropy : float
        Of that placement [nats]: as the study scores, or, after a first look alone, as the search
        judges.
    score : Score, optional
        None after a first look alone. It has no ground map.
    warnings : tuple of Advice
    """

    name: str
    price: float
    models: Models
    study: Study
    entropy: float
    score: Score | None = None
    warnings: tuple[Advice, ...] = ()


@dataclass(frozen=True, slots=True)
class TradeOff:
    """What came of a choice.

    Attributes
    ----------
    study : Study
        As it was given.
    designs : tuple of Design
        All that were looked at and have a placement, cheapest first.
    front : tuple of Design
        Those that no other beats in price and entropy, cheapest first: of the ones that were
        searched, where there are some.
    refused : mapping of name to str
        DesignSpace without a placement that keeps to the constraints, and why.
    is_complete : bool
        Whether all designs that the limits allow were looked at.
    stopped : bool
    seconds : float
    """

    study: Study
    designs: tuple[Design, ...]
    front: tuple[Design, ...]
    refused: dict[str, str] = field(default_factory=dict)
    is_complete: bool = True
    stopped: bool = False
    seconds: float = 0.0

    @property
    def searched(self) -> int:
        """How many designs were searched in full."""
        return sum(design.score is not None for design in self.designs)


class ChoiceJob(Job):
    """Looks for the Pareto front of price against entropy among a study's designs.

    Up to ALL_SEARCHED_UP_TO designs are searched one by one, as `OptimizeJob` does it. Of more,
    each is looked at with fewer candidates first (of more than `pareto.ALL_UP_TO`, those that the
    local search comes across), and those within MARGIN of the front are searched. A search of a
    design is the same whatever the others are.

    Attributes
    ----------
    trade_off : TradeOff or None
        After the work; while it goes on, what there is so far.
    """

    def __init__(self, study: Study, workers: int | None = None) -> None:
        super().__init__(study, workers)
        self._designs = study.designs()
        self._found: dict[Picks, Design] = {}
        self._errors: dict[Picks, InputError] = {}
        self._inner: _DesignJob | None = None
        self._possible: int | None = None
        self._evaluators: dict[int, RigJudge] = {}

    @property
    def trade_off(self) -> TradeOff | None:
        """What was found so far; None before the first design, and where all was dropped."""
        if self.dropped or not self._found:
            return None
        ordered = sorted(self._named(), key=lambda design: (design.price, design.entropy))
        able = [d for d in ordered if d.score is not None] or ordered
        front = pareto_front([(design.price, design.entropy) for design in able])
        names = design_names([self._designs.models(picks) for picks in self._errors])
        refused = {n: str(e) for n, e in zip(names, self._errors.values(), strict=True)}
        return TradeOff(
            self.study,
            tuple(ordered),
            tuple(able[k] for k in front),
            refused,
            self._possible is not None and len(self._found) + len(self._errors) == self._possible,
            self.stopped,
            self.seconds,
        )

    def stop(self) -> None:
        """Search no further; keep the design that is searched now, and the front so far."""
        super().stop()
        if self._inner is not None:
            self._inner.stop()

    def drop(self) -> None:
        """End at once and keep nothing."""
        super().drop()
        if self._inner is not None:
            self._inner.drop()

    def __iter__(self) -> Iterator[Progress]:
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
        """Look at designs with few candidates each."""
        search = DesignSearch(self._designs)
        self._possible = search.most if search.is_complete else None
        while (asked := search.ask()) and not self.stopped:
            for picks in asked:
                if self.stopped:
                    return
                done = (len(self._found) + len(self._errors)) / search.most
                yield from self._glance(picks, Progress("looking at designs", done))
            search.tell({picks: design.entropy for picks, design in self._found.items()})

    def _promising(self) -> list[Picks]:
        """Return the designs that may be on the front, those nearest to it first."""
        found = list(self._found)
        worths = [(self._found[picks].price, self._found[picks].entropy) for picks in found]
        above = dict(zip(found, above_front(worths), strict=True))
        near = [picks for picks in found if above[picks] <= MARGIN]
        return sorted(near, key=lambda picks: (above[picks], self._found[picks].price, picks))

    def _glance(self, picks: Picks, told: Progress) -> Iterator[Progress]:
        """Search a design with few candidates, and keep what was found."""
        try:
            job = self._job_of(picks)
            own, search = job.study.search, _few_candidates(job.study.search)
            job.study = replace(job.study, search=search)
            for _ in job.look():
                yield told
        except InputError as error:
            self._errors[picks] = error
            return
        if job.history:
            study, entropy = replace(job.best, search=own), job.history[-1].entropy
            self._keep(picks, Design("", 0.0, {}, study, entropy))

    def _search(self, picks: Picks, number: int, count: int) -> Iterator[Progress]:
        """Search a design in full, and keep what was found."""
        stage, fraction = f"searching {count} designs", 0.0
        try:
            self._inner = job = self._job_of(picks)
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
            found = Design("", 0.0, {}, outcome.study, score.entropy, score, outcome.warnings)
            self._keep(picks, found)

    def _keep(self, picks: Picks, design: Design) -> None:
        models, price = self._designs.models(picks), self._designs.price(picks)
        self._found[picks] = replace(design, models=models, price=price)

    def _named(self) -> list[Design]:
        names = design_names([design.models for design in self._found.values()])
        both = zip(self._found.values(), names, strict=True)
        return [replace(design, name=name) for design, name in both]

    def _job_of(self, picks: Picks) -> _DesignJob:
        return _DesignJob(design_study(self.study, self._designs.models(picks)), self)

    def evaluator_of(self, samples: int) -> RigJudge:
        """What judges on so many voxels: designs differ in their rigs alone, so they share it."""
        looked_at = self.study.looks_at(samples)
        if looked_at == self.study.looks_at(self.study.samples):
            return self._evaluator
        if looked_at not in self._evaluators:
            self._evaluators[looked_at] = self.study.evaluator(samples, self.workers)
        return self._evaluators[looked_at]


class _DesignJob(OptimizeJob):
    """The search of one design, with the evaluators that all designs share."""

    SEARCHING = "optimizing"

    def __init__(self, study: Study, parent: ChoiceJob) -> None:
        super().__init__(study, parent.workers)
        self._parent = parent

    @property
    def _evaluator(self) -> RigJudge:  # type: ignore[override]
        return self._parent.evaluator_of(self.study.samples)

    def _evaluator_of(self, samples: int) -> RigJudge:
        return self._parent.evaluator_of(samples)

    def look(self) -> Iterator[Progress]:
        """Search, and score nothing."""
        waiting = Progress("preparing", 0.0)
        yield from self._beside(self._checked, lambda: waiting)
        yield from self._search()


def _few_candidates(search: Search) -> Search:
    schedule = search.schedule
    fewer = replace(schedule, candidates=max(1, schedule.candidates // FIRST_LOOK))
    return replace(search, method=PAPER_METHOD, schedule=fewer, evaluations=0)

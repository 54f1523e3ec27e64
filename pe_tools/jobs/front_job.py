"""The job that computes a Pareto front of several objectives: one short search for each point."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

from pe_core.base.errors import InputError
from pe_core.scene.rig import Rig
from pe_core.scoring import RigEvaluator
from pe_core.search import Journal, Objective, Picks, feasible_start, optimize
from pe_core.study.objective_search import is_by_ap, search_evaluator
from pe_core.study.requirement_search import (
    FeasibilityRule,
    FeasibleFirst,
    constraints_of,
    feasible_first,
)
from pe_core.study.study import Study

from .candidate_workers import ExecutorSource, candidate_workers
from .choice_job import ALL_SEARCHED_UP_TO, Design, TradeOff
from .designed import Models, design_names, design_study
from .front_checkpoint import FrontJournals
from .front_objectives import (
    FrontFigures,
    ScalarValue,
    check_objectives,
    costs_of,
    non_dominated,
    spread,
    weights_of,
)
from .job import Job, Progress, begun

EVALUATIONS_A_VARIABLE, LEAST_EVALUATIONS = 25, 60
"""Evaluations of one point of the front where the study has no budget."""


@dataclass(frozen=True, slots=True)
class _Found:
    """A placement that was the best of a search, and the design it belongs to."""

    design: int
    rig: Rig


class FrontJob(Job):
    """Computes the Pareto front of the objectives of a study's search.

    The first searches look for the best value of each objective alone, the others for the best of
    an even spread of weights (`ScalarValue`). Each begins at the best placement found so far for
    its weights. Of all placements that were the best of a search, those that no other one beats
    in all objectives are on the front; of many, `points` that are far from each other are scored.
    With choices, each of up to `ALL_SEARCHED_UP_TO` designs is searched like this.

    The searches run one after the other: each begins where an earlier one ended. Their candidates
    are evaluated by the job's executor, or by processes.

    Attributes
    ----------
    trade_off : TradeOff or None
        The result; None until the front is scored.
    journals : FrontJournals
        Of all searches; those of an interrupted job may be set before this one begins.
    """

    def __init__(self, study: Study, workers: int | None = None) -> None:
        super().__init__(study, workers)
        front = study.search.goals.front
        self.names, self.points = tuple(front.objectives), front.points
        check_objectives(study, self.names)
        self._choice = study.designs()
        self._designs: list[tuple[Models, float, Study]] = []
        self._figures: list[FrontFigures] = []
        self._constraints: list[tuple[FeasibilityRule, ...]] = []
        self._helpers: ExecutorSource | None = None
        self._found: list[_Found] = []
        self._errors: dict[Picks, InputError] = {}
        self._complete = True
        self.evaluations = 0
        self.journals = FrontJournals()
        self.trade_off: TradeOff | None = None

    def __iter__(self) -> Iterator[Progress]:
        waiting = Progress("preparing", 0.0)
        if (yield from self._beside(self._prepare, lambda: waiting)) is None:
            return
        count = len(self._designs)
        models = (sensor.model for _, _, study in self._designs for sensor in study.rig)
        with candidate_workers(self, self._values(), models) as self._helpers:
            for number in range(count):
                if self.stopped:
                    break
                yield from self._search_design(number, count)
        if not self.dropped and self._found:
            yield from self._score_front()
        elif not self._designs and self._errors:
            raise next(iter(self._errors.values()))
        yield Progress("done", 1.0, evaluations=self.evaluations)

    def _prepare(self) -> bool:
        """Make the designs and their objectives; a design without a placement is refused."""
        picks = self._choice.first(ALL_SEARCHED_UP_TO + 1)
        self._complete = len(picks) <= ALL_SEARCHED_UP_TO
        samples = self.study.search.samples
        shared: RigEvaluator = self.study.evaluator(samples, self.workers)
        by_ap = is_by_ap(self.study)
        in_traffic = search_evaluator(self.study, samples, self.workers) if by_ap else None
        for each in picks[:ALL_SEARCHED_UP_TO]:
            models, price = self._choice.models(each), self._choice.price(each)
            try:
                study = design_study(self.study, models) if models else self.study
                feasible_start(study.coding(), study.search.seed)
            except InputError as error:
                self._errors[each] = error
                continue
            self._designs.append((models, price, study))
            self._constraints.append(constraints_of(study))
            self._figures.append(FrontFigures(study, self.names, shared, price, in_traffic))
        return True

    def _values(self) -> Iterator[Objective]:
        """Yield a value of each design: what its searches share goes to the workers beforehand."""
        count = len(self.names)
        for figures, constraints in zip(self._figures, self._constraints, strict=True):
            value = ScalarValue(figures, [0.0] * count, [0.0] * count, [1.0] * count)
            yield feasible_first(value, constraints)

    def _search_design(self, number: int, count: int) -> Iterator[Progress]:
        """Search the points of one design, each from the best placement so far."""
        moving = [n for n in self.names if n != "price"]
        weights = weights_of(max(self.points, len(moving)), len(moving))
        archive: list[Rig] = []
        for k, alone in enumerate(weights):
            if self.stopped:
                return
            full = iter(alone)
            given = [0.0 if name == "price" else next(full) for name in self.names]
            done = (number + k / len(weights)) / count
            share = 1.0 / (count * len(weights))
            journal = self.journals.begin(f"point {number}-{k}")
            yield from self._search_point(number, given, archive, (done, share), journal)
        self._found += [_Found(number, rig) for rig in archive]

    def _search_point(
        self,
        number: int,
        weights: list[float],
        archive: list[Rig],
        part: tuple[float, float],
        journal: Journal,
    ) -> Iterator[Progress]:
        study, figures = self._designs[number][2], self._figures[number]
        start = study.rig if study.coding().allowed(study.rig) else None
        rigs = [*archive, *([start] if start is not None else [])]
        costs = [figures.costs(rig) for rig in rigs] or [[0.0] * len(self.names)]
        columns = list(zip(*costs, strict=True))
        ideal = [min(column) for column in columns]
        span = [max(c) - min(c) or max(abs(min(c)), 1.0) for c in columns]
        value = feasible_first(
            ScalarValue(figures, weights, ideal, span), self._constraints[number]
        )
        begin = min(rigs, key=value.entropy) if rigs else study.rig
        search, variables = study.search, len(study.coding().variables)
        least = max(LEAST_EVALUATIONS, EVALUATIONS_A_VARIABLE * variables)
        steps = optimize(
            journal.wrap([value]),
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
            if (step.improved or step.evaluations == 1) and _is_kept(value, step.best):
                archive.append(step.best)
            done = part[0] + part[1] * step.fraction
            yield Progress(stage, done, evaluations=self.evaluations)

    def _score_front(self) -> Generator[Progress, None, None]:
        """Score placements of the front in full; what is beaten then is told, too."""
        costs = [self._figures[f.design].costs(f.rig) for f in self._found]
        front = non_dominated(costs)
        chosen = spread([costs[k] for k in front], self.points * len(self._designs))
        designs = []
        for number, k in enumerate(front[j] for j in chosen):
            found = self._found[k]
            models, price, study = self._designs[found.design]
            study = study.with_rig(found.rig)
            waiting = Progress("scoring the front", number / len(chosen))
            score = yield from self._score(found.rig, waiting, to_the_end=True)
            if score is None:
                return
            verdicts = yield from self._verdicts(study, waiting)
            figures = self._figures[found.design].scored(found.rig, score)
            score = replace(score, ground_map=None)
            design = Design("", price, models, study, score.entropy, score)
            designs.append(replace(design, verdicts=verdicts or (), figures=figures))
        self.trade_off = self._trade_off(designs)

    def _trade_off(self, designs: list[Design]) -> TradeOff:
        costs = [costs_of(d.figures, self.names) for d in designs]
        order = sorted(range(len(designs)), key=lambda k: costs[k])
        named = self._named([designs[k] for k in order])
        best = non_dominated([costs[k] for k in order])
        models = [self._choice.models(picks) for picks in self._errors]
        errors = zip(design_names(models), self._errors.values(), strict=True)
        return TradeOff(
            self.study,
            tuple(named),
            tuple(named[k] for k in best),
            {name: str(error) for name, error in errors},
            self._complete,
            self.stopped,
            self.seconds,
            self.names,
        )

    def _named(self, designs: list[Design]) -> list[Design]:
        """Return the designs with names: what they are best at, or their number on the front."""
        models = design_names([m for m, _, _ in self._designs])
        by_models = dict(zip((str(m) for m, _, _ in self._designs), models, strict=True))
        costs = [costs_of(d.figures, self.names) for d in designs]
        named = []
        for number, design in enumerate(designs, 1):
            name = f"point {number}"
            for k, objective in enumerate(self.names):
                if objective != "price" and costs[number - 1][k] == min(c[k] for c in costs):
                    name = f"point {number}, best {objective.replace('_', ' ')}"
                    break
            if self.study.selection.choices:
                name = f"{by_models[str(design.models)]}, {name}"
            named.append(replace(design, name=name))
        return named


def _is_kept(value: Objective, rig: Rig) -> bool:
    """Whether a placement keeps the constraints of the search."""
    return not isinstance(value, FeasibleFirst) or not value.violation(rig)

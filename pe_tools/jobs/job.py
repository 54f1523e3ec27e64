"""Jobs that any driver can run: base class, progress while a job runs, and outcome."""

import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, Future, wait
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

from pe_core.base.errors import InputError, require_kind
from pe_core.base.lazy_threads import threads
from pe_core.base.notebook import Tabular
from pe_core.base.plugins import optional_package
from pe_core.base.values import error_text, rounded
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig
from pe_core.scoring import RigEvaluator
from pe_core.scoring.requirements import CheckStep, RequirementChecker, Verdict
from pe_core.scoring.sampling import CENTERED, SEARCHED, Shift
from pe_core.scoring.score import NO_DIFFERENCE, ObjectScore, Score, ScoreStopped, is_noise
from pe_core.scoring.sight import Sight
from pe_core.search import EvaluatedRig, KeyFigures, Reading, Robustness, Value, dashboard
from pe_core.search.figures import (
    BLIND_GROUND,
    BLIND_SECTOR,
    ENTROPY,
    FIGURES,
    REQUIREMENTS,
    TRAFFIC_AP,
)
from pe_core.study.condition_table import (
    ConditionTable,
    condition_table,
    is_by_ap,
    search_evaluator,
)
from pe_core.study.study import Study

from ..advice import (
    Advice,
    Consensus,
    Flatness,
    Rounding,
    curve_warnings,
    difference_error,
    gain_sentence,
    search_cost,
    warnings,
)
from .own_objective import OwnValues
from .searched_figure import IN_NATS, SearchedFigure, searched_figure, searched_on

T = TypeVar("T")
AsDrawn = Callable[[Study], RequirementChecker]
Watch = Callable[[float], bool]  # Takes the progress of a work, 0 to 1; returns whether it goes on
WAIT_S = 0.03
"""How long a job waits for its thread before it yields: a frame of a responsive window."""
EVALUATED = (
    "space",
    "prior",
    "vehicle",
    "model",
    "targets",
    "frames",
    "samples",
    "requirements",
    "reference",
)
"""Fields of a study that its evaluators depend on; the rig is none of them."""


@dataclass(frozen=True, slots=True)
class HistoryRow:
    """A placement that became the best: evaluation number, round, value, and the rig. The value is
    what the search minimised: the entropy [nats], or minus the expected AP (`searched_figure`)."""

    evaluation: int
    round: int
    value: Value
    rig: Rig


def best_so_far(*starts: Sequence[HistoryRow]) -> tuple[tuple[int, Value], ...]:
    """Return the curve of a search: (evaluation, value) of each best so far, which never rises. The
    history from each start is given, in their order. A search that goes on with more samples
    evaluates its best placement again. Values before that are shifted by as much as that
    placement's own changed: they are of the same samples then. Placements that break requirements
    are left out once one keeps them."""
    best: list[tuple[int, Value]] = []
    is_kept = any(row.value.is_feasible for rows in starts for row in rows)
    for rows in starts:
        curve: list[tuple[int, Value]] = []
        counted = [row for row in rows if row.value.is_feasible or not is_kept]
        for row, before in zip(counted, (None, *counted), strict=False):
            if before is not None and _poses(row) == _poses(before):
                shift = row.value.rise_from(before.value)
                curve = [(evaluation, value.worse_by(shift)) for evaluation, value in curve]
            elif not curve or row.value < curve[-1][1]:
                curve.append((row.evaluation, row.value))
        best += [point for point in curve if not best or point[1] < best[-1][1]]
    return tuple(best)


def _poses(row: HistoryRow) -> list[Pose]:
    return [sensor.pose for sensor in row.rig]


@dataclass(frozen=True, slots=True)
class StartEnd:
    """Where a start of a search ended: its name (empty: the given one), value (as in `HistoryRow`),
    and how many rigs were evaluated until then."""

    name: str
    value: Value
    evaluations: int


@dataclass(frozen=True, slots=True)
class Outcome(Tabular):
    """The result of a job.

    Attributes
    ----------
    kind : {"score", "optimize"}
    start, study : Study
        The given study, and the study with the best placement.
    before, after : Score
        Of the two; the same object if the job only scores, or if the search found nothing better.
    history : tuple of HistoryRow
        Every placement that became the best, the start first.
    evaluations, stopped, seconds
        Rigs evaluated by the search, whether it was stopped early, and how long the job took [s].
    warnings : tuple of Advice
        Warnings about `study`.
    inputs : dict
        Provenance at the beginning of a resumed search; file names in `start` may have changed.
    evaluated : tuple of EvaluatedRig
        Journal of the search, from which a stopped search resumes.
    robustness : Robustness or None
        How the entropy of start and result changes under mounting errors and failures; None, as all
        that is analysed after a search, where that was skipped.
    verdicts : tuple of Verdict
        On the requirements of `study`, in its order.
    conditions : ConditionTable or None
        Of `study`, where it has states or weathers.
    flatness : Flatness or None
        What steps from the result of a search cost; None where the search was too short.
    rounding : Rounding or None
        What it cost to have the result on the study's grid; None without a grid.
    consensus : Consensus or None
        Where the best placements of a search agree; None where fewer than two differ.
    starts : tuple of StartEnd
        Where each start of a search ended, if it had several.
    stop_reason : str
        Why the search ended before its budget did: "target", "seconds", "gain", or empty.
    seed_scatter : float or None
        Within what a search with another seed would probably end: `seed_scatter`.
    in_traffic : tuple of ObjectScore, or None
        Of a search by expected AP: start and result on objects in traffic.
    figures : (KeyFigures, KeyFigures), or None
        Expected AP in traffic, blind sectors and blind ground of start and result; None where the
        ground round the vehicle is not in the space.
    own : OwnValues or None
        Of a search by an objective of one's own: its figure, before and after.
    result_cache : dict or None
        `result_dict`, once it was computed: it takes long beside a window.
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
    inputs: dict[str, Any] | None = None
    evaluated: tuple[EvaluatedRig, ...] = ()
    robustness: Robustness | None = None
    verdicts: tuple[Verdict, ...] = ()
    conditions: ConditionTable | None = None
    flatness: Flatness | None = None
    rounding: Rounding | None = None
    consensus: Consensus | None = None
    starts: tuple[StartEnd, ...] = ()
    stop_reason: str = ""
    seed_scatter: float | None = None
    in_traffic: tuple[ObjectScore, ObjectScore] | None = None
    figures: tuple[KeyFigures, KeyFigures] | None = None
    own: OwnValues | None = None
    result_cache: dict[str, Any] | None = field(default=None, init=False, repr=False, compare=False)

    @property
    def figure(self) -> SearchedFigure:
        """The figure that the search improved."""
        return searched_figure(self.start) if self.own is None else self.own.figure

    @property
    def journal_name(self) -> str:
        """Name of the journal in the state of the search: empty for the study's own objective."""
        return "" if self.own is None else self.own.figure.key

    @property
    def evaluated_on(self) -> str:
        """What the search evaluated on, as text: " on 65,536 voxels"; empty for an objective of
        one's own."""
        levels, what = searched_on(self.start)
        return f" on {levels} {what}" if self.own is None else ""

    @property
    def figures_after(self) -> KeyFigures | None:
        """The key figures of the result, if they are known."""
        return None if self.figures is None else self.figures[1]

    @property
    def dashboard(self) -> tuple[Reading, ...]:
        """What the result is decided by, with what is wanted and kept."""
        met = [each.met for each in self.verdicts]
        objects = self.after.objects if self.in_traffic is None else self.in_traffic[1]
        return dashboard(
            self.figures_after,
            self.after.entropy,
            met,
            limits=self.study.limits,
            ap=None if objects is None else objects.ap,
            names=self.study.figures,
        )

    def _rows(self) -> list[dict[str, Any]]:
        told = [{}, {}] if self.figures is None else [_beside(each) for each in self.figures]
        ends = (("before", self.start, self.before), ("after", self.study, self.after))
        return [
            {"": when, "entropy [nats]": score.entropy, "coverage": score.coverage, **beside, **row}
            for (when, study, score), beside in list(zip(ends, told, strict=True))[
                self.kind == "score" :
            ]
            for row in study.rig._rows()
        ]

    @property
    def change_errors(self) -> dict[str, float]:
        """Standard errors of what a search changed, by the names of `FIGURES`; figures that
        have none are left out."""
        of_entropy = difference_error(self.before, self.after, ("rig", "", ENTROPY))
        errors = {ENTROPY: of_entropy}
        if self.figures is not None:
            errors |= self.figures[1].errors_from(self.figures[0])
        return errors

    @property
    def change_text(self) -> str:
        """The change of entropy that a search made, with its standard error: "-0.051 +- 0.010", or
        "no difference shown beyond +- 0.010". Without an error for the whole grid."""
        by = rounded(self.after.entropy - self.before.entropy)
        error = self.change_errors[ENTROPY]
        if not error:
            return f"{by:+.3f}"
        sure = f"+- {error_text(error)}"
        return f"{NO_DIFFERENCE} beyond {sure}" if is_noise(by, error) else f"{by:+.3f} {sure}"

    @property
    def gain(self) -> str:
        """What a search moved, and the expected AP in traffic that it gained; may be empty."""
        return (
            ""
            if self.figures is None
            else gain_sentence(self.start.rig, self.study.rig, *self.figures)
        )

    @property
    def cost(self) -> str:
        """What a search cost, in one sentence; empty for a score."""
        if self.kind == "score" or self.figures is None:
            return ""
        return search_cost(self.before, self.after, *self.figures)


def _beside(figures: KeyFigures) -> dict[str, Any]:
    """Return the figures beside the entropy that are known, as a table has them."""
    rows = (FIGURES[key] for key in (TRAFFIC_AP, BLIND_SECTOR, BLIND_GROUND))
    return {row.title: figures.values[row.key] for row in rows if row.key in figures.values}


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of a job.

    Attributes
    ----------
    stage : str
    fraction : float
        Completed part of the stage, 0 to 1.
    value : Value or None
        Best value so far of the search, or of a score; None before the first.
    evaluations : int
        Rigs evaluated so far.
    figure : SearchedFigure
        How people read that value.
    sample : str
        What it was evaluated on: "65,536 voxels". On another sample the same placement has another
        value, so the best so far may rise with the sample.
    """

    stage: str
    fraction: float
    value: Value | None = None
    evaluations: int = 0
    figure: SearchedFigure = IN_NATS
    sample: str = ""

    @property
    def value_text(self) -> str:
        """The best so far: "entropy 1.2345 on 65,536 voxels"; empty before the first."""
        if self.value is None:
            return ""
        is_figure = self.sample and self.value.is_feasible
        return self.figure.text(self.value) + (f" on {self.sample}" if is_figure else "")


ProgressSteps = Generator[Progress, None, T | None]
"""Yields progress while work runs; returns the result, None where the job ends before it."""


class StudyEvaluators:
    """What evaluates a study's rigs, each made once; jobs of other rigs may share it.

    A search evaluates its candidates on a sample of its own. Its result fits that sample, so all
    that is reported of it is evaluated on another one.
    """

    def __init__(self, study: Study, workers: int | None) -> None:
        self._study = study
        self._workers = workers
        self._own: dict[tuple[int, Shift], RigEvaluator] = {}
        self._in_traffic: dict[tuple[int, Shift], RigEvaluator] = {}

    @property
    def key(self) -> tuple[Any, ...]:
        """What these depend on: studies with equal keys are scored by the same evaluators."""
        study = self._study
        fields = (getattr(study, name) for name in EVALUATED)
        return (self._workers, study.search.samples, *fields)

    @cached_property
    def sight(self) -> Sight:
        """What rigs see of the ground."""
        return self._study.sight()

    def as_drawn(self, _: Study) -> RequirementChecker:
        """Return what holds rigs to the study's requirements as drawn."""
        return self._checker

    @cached_property
    def _checker(self) -> RequirementChecker:
        study = self._study
        return RequirementChecker(
            study.requirements,
            study.vehicle,
            model=study.model,
            reference=study.reference,
            space=study.space,
        )

    def on(self, samples: int, shift: Shift = CENTERED) -> RigEvaluator:
        """Return the evaluator of the study's own targets, with a number of samples."""
        count = self._study.scene_count(samples)
        has_sample = count or self._study.targets.are_objects
        key = count, shift if has_sample else CENTERED
        if key not in self._own:
            self._own[key] = self._study.evaluator(samples, self._workers, shift=shift)
        return self._own[key]

    def searching(self, samples: int, shift: Shift = SEARCHED) -> RigEvaluator:
        """Return the evaluator of the figure that a search improves: by expected AP, in traffic.
        Without another `shift` it has the sample that candidates are evaluated on."""
        if not is_by_ap(self._study):
            return self.on(samples, shift)
        key = samples, shift
        if key not in self._in_traffic:
            made = search_evaluator(self._study, samples, self._workers, shift)
            self._in_traffic[key] = made
        return self._in_traffic[key]


class Job:
    """Base class of the jobs: the outcome, a stopwatch, and requests to stop or cancel.

    A driver iterates over the job, which yields its `Progress`.

    Parameters
    ----------
    study : Study
    workers : int, optional
        Number of threads and processes; all processors by default.
    """

    parts = 1  # What stops end one by one: a search is followed by its analysis
    shown: tuple[str, ...] = ()  # Attributes that a driver looks at while the job runs
    kept: tuple[str, ...] = ()  # Attributes that a new job of the same study resumes from

    def __init__(self, study: Study, workers: int | None = None) -> None:
        require_kind("job", "study", study, Study)
        self.study = study
        self.workers = workers
        self.outcome: Outcome | None = None
        self.inputs: dict[str, Any] | None = None
        self.stopped = self.dropped = False
        self.parts_left = self.parts
        self.executor: Executor | None = None
        """Evaluates the candidates of searches; by default processes on this machine."""
        self.notes: tuple[Advice, ...] = ()
        """Warnings of the program that created the study; they precede those of the checks."""
        self.as_drawn: AsDrawn | None = None
        """Returns what holds rigs to a study's requirements as drawn, if others use it as well."""
        self.evaluators = StudyEvaluators(study, workers)
        self._started = time.monotonic()

    def __iter__(self) -> Iterator[Progress]:
        raise NotImplementedError

    def run(self) -> Outcome | None:
        """Run to the end, with a progress bar where tqdm is installed (the extra ``notebook``).

        Returns
        -------
        Outcome or None
            `outcome`: None after `drop`. A `FrontJob` has its result in `trade_off` instead.
        """
        tqdm = optional_package("tqdm.auto")
        bar = tqdm and tqdm.tqdm(total=1.0, bar_format="{desc} {percentage:3.0f} % |{bar}|")
        for progress in self:
            if bar:
                bar.n = progress.fraction
                bar.set_description(f"{progress.stage} {progress.value_text}")
        if bar:
            bar.close()
        return self.outcome

    def stop(self) -> bool:
        """End the part that runs: a search, whose best placement so far is scored, kept and
        analysed, or its analysis. Return whether there was such a part. Before the first score is
        complete there is nothing to keep: the job ends and `outcome` stays None."""
        self.stopped = True
        self.parts_left = self.parts_left - 1
        return self.parts_left >= 0

    def drop(self) -> None:
        """Cancel the job and discard its results: `outcome` stays None."""
        self.stopped = self.dropped = True

    @property
    def result(self) -> Any:
        """What the job has found; None where there is nothing to keep."""
        return self.outcome

    @property
    def seconds(self) -> float:
        """Time since the job was made [s]."""
        return time.monotonic() - self._started

    def _score(
        self, rig: Rig, waiting: Progress, *, to_the_end: bool = False
    ) -> ProgressSteps[Score]:
        """Score in a thread, yielding `waiting` until it is done. Returns None if the job is
        dropped meanwhile, or stopped without `to_the_end`. The thread then ends soon by itself;
        nothing waits for it."""

        def work(watch: Watch) -> Score:
            return self.evaluators.on(self.study.samples).score(rig, watch=watch)

        return (yield from self._beside(work, waiting, to_the_end))

    def _beside(
        self, work: Callable[[Watch], T], waiting: Progress, to_the_end: bool = False
    ) -> ProgressSteps[T]:
        """Run `work` in a thread, yielding progress; return None if the job ends before it. The
        work tells its progress, and hears whether to go on. The fraction is never below that of
        `waiting`."""
        done = waiting.fraction

        def watch(share: float) -> bool:
            nonlocal done
            done = max(waiting.fraction, share)
            return self._goes_on(to_the_end)

        def guarded() -> T | None:
            try:
                return work(watch)
            except ScoreStopped:
                return None

        yield waiting
        if not self._goes_on(to_the_end):
            return None
        running = begun(guarded)
        return (
            yield from self._awaited(running, lambda: replace(waiting, fraction=done), to_the_end)
        )

    def _awaited(
        self, future: Future[T], waiting: Callable[[], Progress], to_the_end: bool = False
    ) -> ProgressSteps[T]:
        while self._goes_on(to_the_end):
            # Not result(timeout=...): work may end between its TimeoutError and a look at done().
            wait([future], timeout=WAIT_S)
            if future.done():
                return future.result()
            yield waiting()
        return None

    def _goes_on(self, to_the_end: bool) -> bool:
        return not self.dropped and (to_the_end or not self.stopped)

    def _warnings(
        self, study: Study, score: Score, waiting: Progress
    ) -> ProgressSteps[tuple[Advice, ...]]:
        """Collect the warnings about a study in a thread, yielding `waiting` until it is done."""

        def work(_: Watch) -> tuple[Advice, ...]:
            found_warnings = warnings(
                study.rig, study.vehicle, study.space, study.prior, score=score
            )
            return (*self.notes, *curve_warnings(study), *found_warnings)

        return (yield from self._beside(work, waiting, to_the_end=True))

    def _figures(
        self, rigs: Sequence[Rig], waiting: Progress
    ) -> ProgressSteps[tuple[KeyFigures, ...]]:
        """Return the key figures of rigs on the study's vehicle that it shows; none where blind
        ground is one of them and it has no ground."""
        sight = self.evaluators.sight
        names = self.study.shown_figures

        def work(_: Watch) -> tuple[KeyFigures, ...]:
            with suppress(InputError):
                return tuple(KeyFigures.of_rig(sight, rig, names) for rig in rigs)
            return ()

        return (yield from self._beside(work, waiting, to_the_end=True))

    def _shown_verdicts(
        self, study: Study, waiting: Progress, to_the_end: bool = True
    ) -> ProgressSteps[tuple[Verdict, ...]]:
        """Return the verdicts of `_verdicts` where the study shows them, else none."""
        if REQUIREMENTS not in study.shown_figures:
            return ()
        return (yield from self._verdicts(study, waiting, to_the_end))

    def _verdicts(
        self, study: Study, waiting: Progress, to_the_end: bool = True
    ) -> ProgressSteps[tuple[Verdict, ...]]:
        """Hold a study to its requirements in a thread, yielding `waiting` until it is done."""
        if not study.requirements:
            return ()

        def work(watch: Watch) -> tuple[Verdict, ...]:
            found = []
            for step in self._check_steps(study):
                if not watch(step.fraction):  # nobody waits for this thread
                    break
                found += [] if step.verdict is None else [step.verdict]
            return tuple(found)

        return (yield from self._beside(work, replace(waiting, fraction=0.0), to_the_end))

    def _check_steps(self, study: Study, *, early: bool = False) -> Iterator[CheckStep]:
        """Yield the verdicts on a study one by one, with steps in between. `early`: as of
        `RequirementChecker.steps`."""
        checker = study.checker(self.as_drawn and self.as_drawn(study))
        yield from study.check_steps(checker, early=early)

    def _conditions(
        self, study: Study, waiting: Progress, to_the_end: bool = True
    ) -> ProgressSteps[ConditionTable]:
        """Score a study under its conditions in a thread; None without, or where it is dropped."""
        if not study.conditions:
            return None

        def work(watch: Watch) -> ConditionTable | None:
            return condition_table(study, self.workers, watch)

        return (yield from self._beside(work, replace(waiting, fraction=0.0), to_the_end))


def begun(work: Callable[[], T]) -> Future[T]:
    """Start `work` in a new thread; return the future of its result."""
    future = Future[T]()

    def fill() -> None:
        try:
            future.set_result(work())
        except BaseException as error:  # the waiting thread raises it
            future.set_exception(error)

    threads().Thread(target=fill, daemon=True).start()
    return future

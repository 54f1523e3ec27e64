"""The search for a better placement by any method, as a generator of steps."""

import math
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate
from typing import Any

from ..base.errors import InputError, shown
from ..base.notebook import ShortRepr
from ..base.values import real
from ..scene.rig import Rig
from ..scoring.score import Objective
from .dispatch import evaluate_all
from .journal import BATCH
from .methods import METHODS, Given, Question, checked_method
from .methods.method import Answered, QuestionStream
from .parametrization import Candidate, Parametrization, feasible_start
from .search_space import Schedule, SearchSpace

ExecutorSource = Callable[[], Executor | None]


@dataclass(frozen=True, slots=True)
class FunctionObjective:
    """A function of a rig that is minimised: a number for each rig, the same each time."""

    function: Callable[[Rig], float]

    def entropy(self, rig: Rig) -> float:
        """Return the value of a rig; `InputError` where it is no number."""
        value = real(found := self.function(rig))
        if math.isnan(value):
            raise InputError("objective", "value", "a number for each rig", shown(found))
        return value


def as_objective(objective: Any) -> Objective:
    """Return an objective, or a function as one; `InputError` for anything else."""
    if hasattr(objective, "entropy"):
        found: Objective = objective
        return found
    if not callable(objective):
        expected = "an Evaluator, or a function of a rig"
        raise InputError("optimize", "objective", expected, type(objective).__name__)
    return FunctionObjective(objective)


@dataclass(frozen=True, slots=True)
class Step(ShortRepr):
    """A step of a search: one candidate evaluated.

    Attributes
    ----------
    best : Rig
        The incumbent: the best placement so far.
    entropy : float
        Its perception entropy, on the voxels of the level [nats].
    evaluations : int
        Rigs evaluated so far, the start included.
    fraction : float
        Progress of the search, 0 to 1.
    round : int
        Round, from 0.
    improved : bool
        Whether this candidate became the incumbent, or the incumbent was evaluated on a new level.
    level : int
        The objective that evaluated it: methods that raise the number of voxels have several.
    ends : tuple of float
        Where independent descents of the search ended so far [nats].
    """

    best: Rig
    entropy: float
    evaluations: int
    fraction: float
    round: int
    improved: bool
    level: int = 0
    ends: tuple[float, ...] = ()


def optimize(
    objective: Objective | Callable[[Rig], float] | Sequence[Objective],
    rig: Rig,
    search_space: SearchSpace,
    seed: int = 0,
    schedule: Schedule | None = None,
    *,
    method: str | None = None,
    evaluations: int = 0,
    executor: Executor | ExecutorSource | None = None,
) -> Iterator[Step]:
    """Search for the placement of lowest perception entropy; yields one step for each candidate.

    A placement that breaks a rule of the search space is neither evaluated nor returned; if the
    start breaks one, the search starts from a feasible placement near it. The search may be stopped
    at any step: the last one holds the incumbent.

    `InputError` when there is no such method, the search space does not fit the rig, no placement
    keeps to all of its rules, or an objective is none.

    Parameters
    ----------
    objective : Objective, callable, or sequence of Objective
        What is minimised, for example an `Evaluator`, or any function of a rig that returns a
        number, the same for the same rig. Several: one for each level of the method, the cheapest
        first.
    rig : Rig
        Where the search starts.
    seed : int
        The same seed gives the same steps.
    schedule : Schedule, optional
        Of the method "random"; the paper's by default: seven rounds of 1000 candidates.
    method : str, optional
        A name of `METHODS`; needed where a schedule is given.
    evaluations : int
        How many placements are evaluated at most; 0: as many as the method takes.
    executor : concurrent.futures.Executor, or callable, optional
        Evaluates several candidates in parallel. The steps do not depend on it. A callable returns
        an executor, or None as long as there is none; it is called before every batch.
    """
    chosen = METHODS[checked_method("optimize", method, schedule is not None)]
    levels = [
        as_objective(o) for o in (objective if isinstance(objective, Sequence) else [objective])
    ]
    parametrization = Parametrization(rig, search_space)
    schedule = schedule or Schedule()
    start = feasible_start(parametrization, seed)
    first = Step(
        start.rig,
        levels[0].entropy(start.rig),
        evaluations=1,
        fraction=0.0,
        round=0,
        improved=False,
    )
    yield first
    if parametrization.variables:
        executor_source = executor if callable(executor) else lambda: executor
        batch = 1 if executor is None else BATCH
        given = Given(
            parametrization=parametrization,
            start=start,
            entropy=first.entropy,
            seed=seed,
            schedule=schedule,
            levels=len(levels),
            batch=batch,
            evaluations=evaluations,
        )
        budget = evaluations or sys.maxsize
        yield from _steps(first, chosen.ask(given), levels, budget, executor_source=executor_source)


def _steps(
    step: Step,
    questions: QuestionStream,
    levels: Sequence[Objective],
    budget: int,
    executor_source: ExecutorSource,
) -> Iterator[Step]:
    """Answer a method's questions, one step for each candidate, until it or the budget ends."""
    question = next(questions, None)
    done = 0
    while question is not None and step.evaluations < budget:
        objective = levels[question.level]
        if question.level > step.level:  # the incumbent is evaluated on the new level
            entropy = objective.entropy(step.best)
            count = step.evaluations + 1
            yield (
                step := Step(
                    step.best,
                    entropy,
                    count,
                    step.fraction,
                    round=question.round,
                    improved=True,
                    level=question.level,
                )
            )
            if step.evaluations == budget:
                return
        question = _within(question, budget - step.evaluations)
        answers: Answered = []
        evaluated = _evaluated(question, objective, executor_source())
        for candidate, answer in zip(question.candidates, evaluated, strict=True):
            answers.append(answer)
            done += 1
            fraction = max(done / question.total, (step.evaluations + 1) / budget)
            yield (step := _next_step(step, candidate, answer, question, fraction=fraction))
            if step.evaluations == budget:
                return
        try:
            question = questions.send(answers)
        except StopIteration:
            return


def _within(question: Question, left: int) -> Question:
    """Return the question without the candidates that the budget has no evaluation left for."""
    counts = accumulate(candidate is not None for candidate in question.candidates)
    inside = sum(count <= left for count in counts)
    return replace(question, candidates=question.candidates[:inside])


def _evaluated(
    question: Question, objective: Objective, executor: Executor | None
) -> Iterator[float | None]:
    """Yield the answers: all evaluated at once by an executor, or one after the other here."""
    rigs = [c.rig for c in question.candidates if c is not None]
    evaluate = partial(evaluate_all, objective, cutoff=question.cutoff, executor=executor)
    answers = iter(evaluate(rigs)) if executor else (evaluate([rig])[0] for rig in rigs)
    for candidate in question.candidates:
        yield None if candidate is None else next(answers)


def _next_step(
    step: Step,
    candidate: Candidate | None,
    answer: float | None,
    question: Question,
    fraction: float,
) -> Step:
    """Return the step after a candidate; None where no feasible candidate was sampled."""
    best = step.best
    entropy = step.entropy
    count = step.evaluations
    improved = False
    if candidate is not None and answer is not None:
        count += 1
        improved = answer < entropy and question.level == step.level
        if improved:
            best = candidate.rig
            entropy = answer
    return Step(
        best=best,
        entropy=entropy,
        evaluations=count,
        fraction=min(fraction, 1.0),
        round=question.round,
        improved=improved,
        level=step.level,
        ends=question.ends,
    )

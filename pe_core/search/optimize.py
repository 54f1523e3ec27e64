"""The search for a better placement by any method, as a generator of steps."""

import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate

from ..base.notebook import ShortRepr
from ..scene.rig import Rig
from ..scoring import RigEvaluator
from .journal import BATCH, Journal
from .methods import METHODS, Given, Question, checked_method
from .methods.method import Answered, QuestionStream
from .objective import Objective, Value
from .parametrization import Candidate, Parametrization, feasible_start
from .race import as_objective
from .search_space import Schedule, SearchSpace

ExecutorSource = Callable[[], Executor | None]
Minimised = RigEvaluator | Callable[[Rig], float] | Objective
Evaluate = Callable[[Sequence[Rig], Question], Iterator[Value]]
"""Yields the values of rigs below a question's cutoff, on its level."""


@dataclass(frozen=True, slots=True)
class Step(ShortRepr):
    """A step of a search: one candidate evaluated.

    Attributes
    ----------
    best : Rig
        The incumbent: the best placement so far.
    value : Value
        Its value, on the voxels of the level: tuples order themselves.
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
    ends : tuple of Value
        Where independent descents of the search ended so far.
    """

    best: Rig
    value: Value
    evaluations: int
    fraction: float
    round: int
    improved: bool
    level: int = 0
    ends: tuple[Value, ...] = ()

    @property
    def entropy(self) -> float:
        """What the objective is for the incumbent: its entropy [nats], if no function is given;
        inf while it breaks a constraint."""
        return self.value.objective


def optimize(
    objective: Minimised | Sequence[Minimised],
    rig: Rig,
    search_space: SearchSpace,
    seed: int = 0,
    schedule: Schedule | None = None,
    *,
    method: str | None = None,
    evaluations: int = 0,
    executor: Executor | ExecutorSource | None = None,
    journal: Journal | None = None,
) -> Iterator[Step]:
    """Search for the placement of lowest perception entropy; yields one step for each candidate.

    A placement that breaks a rule of the search space is neither evaluated nor returned; if the
    start breaks one, the search starts from a feasible placement near it. The search may be stopped
    at any step: the last one holds the incumbent.

    `InputError` when there is no such method, the search space does not fit the rig, no placement
    keeps to all of its rules, or an objective is none.

    Parameters
    ----------
    objective : Evaluator, callable, Objective, or a sequence of them
        What is minimised: the entropy of an `Evaluator`, or any function of a rig that returns a
        number, the same for the same rig; an `Objective` has constraints, too. Several: one for
        each level of the method, the cheapest first.
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
    journal : Journal, optional
        Takes all values of the search. Those of an interrupted one are taken from it.
    """
    chosen = METHODS[checked_method("optimize", method, schedule is not None)]
    levels = [
        as_objective(o) for o in (objective if isinstance(objective, Sequence) else [objective])
    ]
    parametrization = Parametrization(rig, search_space)
    schedule = schedule or Schedule()
    start = feasible_start(parametrization, seed)
    journal = journal or Journal()
    first = Step(
        start.rig,
        journal.value(levels[0], start.rig),
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
            value=first.value,
            seed=seed,
            schedule=schedule,
            levels=len(levels),
            batch=batch,
            evaluations=evaluations,
        )
        budget = evaluations or sys.maxsize
        evaluate = partial(_evaluated, levels, journal, executor_source)
        yield from _steps(first, chosen.ask(given), evaluate, budget)


def _steps(
    step: Step, questions: QuestionStream, evaluate: Evaluate, budget: int
) -> Iterator[Step]:
    """Answer a method's questions, one step for each candidate, until it or the budget ends."""
    question = next(questions, None)
    done = 0
    while question is not None and step.evaluations < budget:
        if question.level > step.level:  # the incumbent is evaluated on the new level
            [value] = evaluate([step.best], Question((), level=question.level))
            yield (
                step := replace(
                    step,
                    value=value,
                    evaluations=step.evaluations + 1,
                    round=question.round,
                    improved=True,
                    level=question.level,
                    ends=(),
                )
            )
            if step.evaluations == budget:
                return
        question = _within(question, budget - step.evaluations)
        answers: Answered = []
        rigs = [each.rig for each in question.candidates if each is not None]
        values = evaluate(rigs, question)
        for candidate in question.candidates:
            answer = None if candidate is None else next(values)
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
    levels: Sequence[Objective],
    journal: Journal,
    executor_source: ExecutorSource,
    rigs: Sequence[Rig],
    question: Question,
) -> Iterator[Value]:
    """Yield values: all evaluated at once by an executor, or one after the other here."""
    executor = executor_source()
    for batch in [rigs] if executor is not None else [[rig] for rig in rigs]:
        yield from journal.evaluate_all(
            levels[question.level],
            batch,
            question.cutoff,
            executor,
            level=question.level,
            leader=question.leader,
        )


def _next_step(
    step: Step,
    candidate: Candidate | None,
    answer: Value | None,
    question: Question,
    fraction: float,
) -> Step:
    """Return the step after a candidate; None where no feasible candidate was sampled."""
    after = replace(
        step, fraction=min(fraction, 1.0), round=question.round, improved=False, ends=question.ends
    )
    if candidate is None or answer is None:
        return after
    after = replace(after, evaluations=step.evaluations + 1)
    if answer < step.value and question.level == step.level:
        after = replace(after, best=candidate.rig, value=answer, improved=True)
    return after

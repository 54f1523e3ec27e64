"""The search for a better placement, by any method, as one generator of steps."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial

from ..scene.sensors import Rig
from .batch import judge_all
from .coding import Candidate, Coding
from .feasible import first_allowed
from .methods import METHODS, Given, Question, checked_method
from .methods.method import Answered, Asking
from .objective import Judgement, Objective
from .schedule import Schedule
from .search_space import SearchSpace

BATCH = 16
"""Candidates that a method may ask for at once where several are judged at a time."""


Hands = Callable[[], Executor | None]


@dataclass(frozen=True, slots=True)
class Step:
    """One candidate tried.

    Attributes
    ----------
    best : Rig
        The best placement so far.
    entropy : float
        Its perception entropy, on the voxels of the level [nats].
    evaluations : int
        Rigs scored so far, the start included.
    fraction : float
        How much of the search is done, 0 to 1.
    round : int
        Round, from 0.
    improved : bool
        Whether this candidate became the best, or the best was judged anew on another level.
    level : int
        Which of the objectives judged it: methods that raise the number of voxels have several.
    """

    best: Rig
    entropy: float
    evaluations: int
    fraction: float
    round: int
    improved: bool
    level: int = 0


def optimize(
    objective: Objective | Sequence[Objective],
    rig: Rig,
    search_space: SearchSpace,
    seed: int = 0,
    schedule: Schedule | None = None,
    *,
    method: str | None = None,
    evaluations: int = 0,
    executor: Executor | Hands | None = None,
) -> Iterator[Step]:
    """Search for the placement of lowest perception entropy; yields a step a candidate.

    What breaks a rule of the search space is neither scored nor returned; a start that does gives
    way to a placement near it. Stop whenever you like: the last step holds the best so far.

    Parameters
    ----------
    objective : Objective, or sequence of Objective
        What judges placements: an `Evaluator`, say. Several: those of the method's levels, the
        cheapest first.
    rig : Rig
        Where the search starts.
    search_space : SearchSpace
    seed : int
        The same seed gives the same steps.
    schedule : Schedule, optional
        Of the method "random"; the paper's by default: seven rounds of 1000 candidates.
    method : str, optional
        A name of `METHODS`; "random" for who gives a schedule and no method.
    evaluations : int
        How many placements are judged at most; 0: as many as the method takes.
    executor : concurrent.futures.Executor, or callable, optional
        Judges several candidates at once. The steps do not depend on it. A callable returns an
        executor, or None as long as there is none; it is asked again and again.

    Raises
    ------
    InputError
        When there is no such method, the search space does not fit the rig, or no placement keeps
        to all of its rules.
    """
    chosen = METHODS[checked_method("optimize", method, schedule is not None)]
    levels = list(objective) if isinstance(objective, Sequence) else [objective]
    coding, schedule = Coding(rig, search_space), schedule or Schedule()
    start = first_allowed(coding, seed)
    first = Step(start.rig, levels[0].entropy(start.rig), 1, 0.0, 0, False)
    yield first
    if coding.unknowns:
        hands = executor if callable(executor) else lambda: executor
        batch = 1 if executor is None else BATCH
        told = (seed, schedule, len(levels), batch, evaluations)
        given = Given(coding, start, first.entropy, *told)
        yield from _steps(first, chosen.ask(given), levels, evaluations or sys.maxsize, hands)


def _steps(
    step: Step, asking: Asking, levels: Sequence[Objective], most: int, hands: Hands
) -> Iterator[Step]:
    """Answer a method's questions, one step a candidate, until it or the budget ends."""
    question, done = next(asking, None), 0
    while question is not None and step.evaluations < most:
        if question.level != step.level:
            yield (step := _judged_anew(step, levels[question.level], question))
        answers: Answered = []
        judged = _judged(question, levels[question.level], hands())
        for candidate, answer in zip(question.candidates, judged, strict=True):
            answers.append(answer)
            done += 1
            fraction = max(done / question.total, (step.evaluations + 1) / most)
            yield (step := _after(step, candidate, answer, question.round, fraction))
            if step.evaluations == most:
                return
        question = _next_question(asking, answers)


def _judged(
    question: Question, objective: Objective, executor: Executor | None
) -> Iterator[Judgement | None]:
    """Yield the answers: all judged at once by an executor, or each when it is asked for."""
    rigs = [c.rig for c in question.candidates if c is not None]
    judge = partial(judge_all, objective, below=question.below, executor=executor)
    told = iter(judge(rigs)) if executor else (judge([rig])[0] for rig in rigs)
    for candidate in question.candidates:
        yield None if candidate is None else next(told)


def _judged_anew(step: Step, objective: Objective, question: Question) -> Step:
    """Return the step at which the best so far is looked at on another level."""
    entropy, count = objective.entropy(step.best), step.evaluations + 1
    number, level = question.round, question.level
    return Step(step.best, entropy, count, step.fraction, number, True, level)


def _after(
    step: Step, candidate: Candidate | None, answer: Judgement | None, number: int, fraction: float
) -> Step:
    """Return the step after a candidate was judged, or none could be drawn."""
    best, entropy, count, improved = step.best, step.entropy, step.evaluations, False
    if candidate is not None and answer is not None:
        count += 1
        improved = answer.entropy < entropy
        if improved:
            best, entropy = candidate.rig, answer.entropy
    return Step(best, entropy, count, min(fraction, 1.0), number, improved, step.level)


def _next_question(asking: Asking, answers: Answered) -> Question | None:
    try:
        return asking.send(answers)
    except StopIteration:
        return None

"""Ask and tell: the interface between a search method and the optimizer that evaluates candidates.

A method is a generator over vectors of design variables. It yields a `Question`, a batch of
candidates to evaluate, and is sent a list with one answer for each of them; when it returns, the
search is over. It knows neither where candidates are evaluated nor how long that takes, and it
draws random numbers from its seed alone: its next question follows from its input and the answers
so far. So a search resumes from a journal of answers, and no state of a method is ever stored.
A minimal method::

    def ask(given):
        for number in range(100):
            candidate = sampled_candidate(given.parametrization, sample)
            [answer] = yield Question((candidate,), given.entropy, number, 100)

Vectors are those of `Parametrization`: its method `candidate` makes a placement of a vector,
`DesignVariable.clipped` keeps a value in its range, and `sampled_candidate` samples vectors until
one breaks no rule.
"""

import math
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from ..parametrization import Candidate, Parametrization
from ..search_space import Schedule


@dataclass(frozen=True, slots=True)
class Given:
    """The problem that a method is given.

    `parametrization`: The design variables and what they mean. There is at least one variable.
    `start`: It breaks no rule.
    `entropy`: Of the start, on level 0 [nats].
    `levels`: How many objectives there are: 0 is the cheapest, `levels - 1` is what the search
        minimises.
    `batch`: How many placements are evaluated in parallel. The questions of a method may depend on
        it, its result must not.
    `evaluations`: How many placements the method may have evaluated; 0: as many as it takes.
    """

    parametrization: Parametrization
    start: Candidate
    entropy: float
    seed: int = 0
    schedule: Schedule = field(default_factory=Schedule)
    levels: int = 1
    batch: int = 1
    evaluations: int = 0


@dataclass(frozen=True, slots=True)
class Question:
    """A batch of placements to evaluate, all on one level and independently of each other.

    `candidates`: None where no feasible candidate was sampled; its answer is None.
    `cutoff`: A value that is not below the cutoff is answered by inf [nats].
    `round`: From 0, for progress reports.
    `total`: Candidates of the whole search, as far as is known, for the progress bar.
    `level`: The objective that evaluates. It never decreases in a search.
    `ends`: Where independent descents of the method ended so far, on the last level.
    """

    candidates: Sequence[Candidate | None]
    cutoff: float = math.inf
    round: int = 0
    total: int = 1
    level: int = 0
    ends: tuple[float, ...] = ()


Answered = list[float | None]
QuestionStream = Generator[Question, Answered, None]


@dataclass(frozen=True, slots=True)
class Method:
    """A method of search: a row of the table `METHODS`.

    Attributes
    ----------
    label, about : str
        For a menu: its name, and a description of one line.
    ask : callable
        Makes the generator of questions.
    samples : callable
        From the number of voxels that the search is set to: how many voxels each level evaluates;
        the last level evaluates that number.
    """

    label: str
    about: str
    ask: Callable[[Given], QuestionStream]
    samples: Callable[[int], tuple[int, ...]] = lambda samples: (samples,)


T = TypeVar("T")
Evaluated = list[tuple[Candidate, float]]
"""Placements, and their entropies [nats]."""
MethodPart = Generator[Question, Answered, T]
"""A part of a method: it yields questions, and returns its result."""


@dataclass(frozen=True, slots=True)
class Phase:
    """What all questions of a phase share. `total`: candidates of the whole search."""

    round: int
    total: int
    level: int = 0
    ends: tuple[float, ...] = ()

    def evaluate(
        self, candidates: Sequence[Candidate | None], cutoff: float = math.inf
    ) -> MethodPart[list[float]]:
        """Evaluate the candidates; return one value for each: inf for one that is missing or not
        below the cutoff."""
        shared = self.round, self.total, self.level, self.ends
        answers = yield Question(candidates, cutoff, *shared)
        return [math.inf if answer is None else answer for answer in answers]


MAX_SAMPLED = 100
"""Placements sampled for one candidate; where all of them break a rule, none is evaluated."""


def sampled_candidate(
    parametrization: Parametrization, sample: Callable[[], Sequence[float]]
) -> Candidate | None:
    """Return the first feasible placement among samples; None if `MAX_SAMPLED` are infeasible.
    Samples are vectors of design variables; their values are clipped to the variables' ranges."""
    for _ in range(MAX_SAMPLED):
        values = zip(parametrization.variables, sample(), strict=True)
        candidate = parametrization.candidate([variable.clipped(v) for variable, v in values])
        if parametrization.allowed(candidate.rig):
            return candidate
    return None


class Incumbent:
    """The best placement so far, its entropy on the level in use [nats], and what was evaluated.
    Descents are incumbents of their own."""

    def __init__(self, best: Candidate, entropy: float) -> None:
        self.best, self.entropy, self.count = best, entropy, 0

    def told(self, candidates: Iterable[tuple[Candidate, float]]) -> None:
        """Take placements and their values."""
        for candidate, value in candidates:
            self.count += 1
            self._take(candidate, value)

    def _take(self, candidate: Candidate, value: float) -> None:
        if value < self.entropy:
            self.best, self.entropy = candidate, value

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
            [answer] = yield Question((candidate,), given.value, number, 100)

Vectors are those of `Parametrization`: its method `candidate` makes a placement of a vector,
`DesignVariable.clipped` keeps a value in its range, and `sampled_candidate` samples vectors until
one breaks no rule.
"""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from ..objective import NO_VALUE, Leader, Value
from ..parametrization import Candidate, Parametrization
from ..search_space import Schedule

Answered = list[Value | None]
T = TypeVar("T")
MAX_SAMPLED = 100
"""Placements sampled for one candidate; where all of them break a rule, none is evaluated."""
SCREENED_WITHIN = 0.003
"""A candidate passes the screening up to so much above the incumbent [nats]."""


@dataclass(frozen=True, slots=True)
class Given:
    """The problem that a method is given.

    `parametrization`: The design variables and what they mean. There is at least one variable.
    `start`: It breaks no rule.
    `value`: That of the start, on level 0.
    `levels`: How many objectives there are: 0 is the cheapest, `levels - 1` is what the search
        minimises.
    `batch`: How many placements are evaluated in parallel. The questions of a method may depend on
        it, its result must not.
    `evaluations`: How many placements the method may have evaluated; 0: as many as it takes.
    """

    parametrization: Parametrization
    start: Candidate
    value: Value
    seed: int = 0
    schedule: Schedule = field(default_factory=Schedule)
    levels: int = 1
    batch: int = 1
    evaluations: int = 0


@dataclass(frozen=True, slots=True)
class Question:
    """A batch of placements to evaluate, all on one level and independently of each other.

    `candidates`: None where no feasible candidate was sampled; its answer is None.
    `cutoff`: A value that is not below the cutoff is answered by `NO_VALUE`.
    `leader`: The placement that the cutoff comes from, with its value on this level: objectives may
        race candidates against it.
    `round`: From 0, for progress reports.
    `total`: Candidates of the whole search, as far as is known, for the progress bar.
    `level`: The objective that evaluates. After a question on a higher level, answers on a lower
        one screen candidates: they make none the incumbent.
    `ends`: Where independent descents of the method ended so far, on the last level.
    """

    candidates: Sequence[Candidate | None]
    cutoff: Value = NO_VALUE
    round: int = 0
    total: int = 1
    level: int = 0
    ends: tuple[Value, ...] = ()
    leader: Leader | None = None


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
        From the number of voxels that the search is set to, of its placements (0: as many as the
        method takes) and of the sensors that move: how many voxels each level evaluates.
    """

    label: str
    about: str
    ask: Callable[[Given], QuestionStream]
    samples: Callable[[int, int, int], tuple[int, ...]] = lambda samples, *_: (samples,)


MethodPart = Generator[Question, Answered, T]
"""A part of a method: it yields questions, and returns its result."""


@dataclass(frozen=True, slots=True)
class Phase:
    """What all questions of a phase share. `total`: candidates of the whole search."""

    round: int
    total: int
    level: int = 0
    ends: tuple[Value, ...] = ()

    def evaluate(
        self,
        candidates: Sequence[Candidate | None],
        cutoff: Value = NO_VALUE,
        below: int = 0,
        leader: Leader | None = None,
    ) -> MethodPart[list[Value]]:
        """Evaluate the candidates, `below` levels lower; return one value for each: `NO_VALUE` for
        one that is missing or not below the cutoff."""
        answers = yield Question(
            candidates,
            cutoff,
            self.round,
            self.total,
            level=self.level - below,
            ends=self.ends,
            leader=leader,
        )
        return [NO_VALUE if answer is None else answer for answer in answers]


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
    """The best placement so far, its value on the level in use, and what was evaluated.
    Descents are incumbents of their own.

    `screened` is its value on the level below, where candidates are screened; None: they are not.
    A step found on few voxels is often better on those alone. So only a candidate that comes near
    the incumbent there is evaluated on the level in use, which decides.
    """

    def __init__(self, best: Candidate, value: Value) -> None:
        self.best = best
        self.value = value
        self.count = 0
        self.screened: Value | None = None

    def raised(self, phase: Phase, screening: bool = False) -> MethodPart[None]:
        """Evaluate the best on the next level, that of a phase; screen candidates on this one."""
        self.screened = self.value if screening else None
        [self.value] = yield from phase.evaluate([self.best])

    def tried(self, candidates: Sequence[Candidate], phase: Phase) -> MethodPart[list[Value]]:
        """Evaluate placements, and take the best; `NO_VALUE` where one is no better."""
        passed: dict[int, Value | None] = dict.fromkeys(range(len(candidates)))
        if self.screened is not None:
            cutoff = self.screened.worse_by(SCREENED_WITHIN)
            screened = Leader(self.best.rig, self.screened)
            coarse = yield from phase.evaluate(candidates, cutoff, below=1, leader=screened)
            passed = {k: value for k, value in enumerate(coarse) if value < NO_VALUE}
            self.count += len(candidates)
        values = [NO_VALUE] * len(candidates)
        if passed:
            # Those that passed are so near that a race would tell nothing.
            leader = Leader(self.best.rig, self.value) if self.screened is None else None
            chosen = [candidates[k] for k in passed]
            found = yield from phase.evaluate(chosen, self.value, leader=leader)
            self.count += len(passed)
            for (k, of_candidate), value in zip(passed.items(), found, strict=True):
                values[k] = value
                if value < self.value:
                    self.best = candidates[k]
                    self.value = value
                    self.screened = of_candidate
        return values

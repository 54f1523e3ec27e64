"""Ask and tell: how a method of search and the one who judges its placements talk.

A method is a generator over vectors of unknowns. It yields a `Question`, placements that it wants
judged, and is sent a list with an answer to each of them; when it returns, the search is over. It
knows neither who judges nor how long that takes, and draws from its seed alone: what it asks next
follows from what it is given and the answers so far. So a search goes on from a journal of answers,
and nothing of a method is ever stored. A minimal one::

    def ask(given):
        for number in range(100):
            candidate = drawn(given.coding, sample)
            [answer] = yield Question((candidate,), given.entropy, number, 100)

Vectors are those of `Coding`: `Coding.candidate` makes a placement of one, `Unknown.brought` keeps
its numbers in their ranges, and `drawing.drawn` draws until no rule is broken.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field

from ..coding import Candidate, Coding
from ..objective import Judgement
from ..schedule import Schedule


@dataclass(frozen=True, slots=True)
class Given:
    """What a method has to solve.

    Attributes
    ----------
    coding : Coding
        The unknowns and what they mean. There is at least one.
    start : Candidate
        Keeps to all rules.
    entropy : float
        Of the start, on level 0 [nats].
    seed : int
    schedule : Schedule
    levels : int
        How many objectives there are: 0 is the cheapest, `levels - 1` the one that counts.
    batch : int
        How many placements are judged at once. What a method asks may depend on it, what it finds
        must not.
    evaluations : int
        How many placements it may have judged; 0: as many as it takes.
    """

    coding: Coding
    start: Candidate
    entropy: float
    seed: int = 0
    schedule: Schedule = field(default_factory=Schedule)
    levels: int = 1
    batch: int = 1
    evaluations: int = 0


@dataclass(frozen=True, slots=True)
class Question:
    """Placements to be judged, all on one level and independently of each other.

    Attributes
    ----------
    candidates : sequence of Candidate or None
        None where none could be drawn that keeps to the rules; its answer is None.
    below : float
        What is not below this may be answered by a lower bound [nats]. inf: only entropies will do.
    round : int
        From 0: for those who watch.
    total : int
        Candidates that the whole search asks for, as far as is known: for the bar of progress.
    level : int
        The objective to judge on. It never goes down in a search.
    """

    candidates: Sequence[Candidate | None]
    below: float = math.inf
    round: int = 0
    total: int = 1
    level: int = 0


Answered = list[Judgement | None]
Asking = Generator[Question, Answered, None]


@dataclass(frozen=True, slots=True)
class Method:
    """A method of search: a row of the table `METHODS`.

    Attributes
    ----------
    label, about : str
        For a menu: its name, and what it is in a line.
    ask : callable
        Makes the generator of questions.
    samples : callable
        How many voxels each level looks at, the last being the given number: those of the search.
    """

    label: str
    about: str
    ask: Callable[[Given], Asking]
    samples: Callable[[int], tuple[int, ...]] = lambda samples: (samples,)

"""Where a search is: what every question of a part of it has in common."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from ..coding import Candidate
from .method import Answered, Question

T = TypeVar("T")
Tried = list[tuple[Candidate, float]]
"""Placements, and their entropies or lower bounds [nats]."""
Asks = Generator[Question, Answered, T]
"""A part of a method: it asks, and returns what it found."""


@dataclass(frozen=True, slots=True)
class Phase:
    """A round, the number of candidates that the whole search asks for, and the level."""

    round: int
    total: int
    level: int = 0

    def asks(
        self, candidates: Sequence[Candidate | None], below: float = math.inf
    ) -> Asks[list[float]]:
        """Ask; return entropies. What is not below is told as that, what cannot be as inf."""
        told = yield Question(candidates, below, self.round, self.total, self.level)
        return [math.inf if answer is None else min(answer.entropy, below) for answer in told]

"""Algorithm 1 of the paper: random search in a shrinking neighbourhood."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..coding import Candidate
from ..unknown import METRE, RADIAN, SHARE
from .drawing import drawn
from .method import Answered, Asking, Given, Question

SHARE_REACH = 0.5
"""Half width of the first neighbourhood in a list: all of it, which is taken as a ring."""


def ask(given: Given) -> Asking:
    """Ask round by round, in the neighbourhood of the best placement found before the round.

    Candidates are drawn uniformly in it, each coordinate clipped to its bounds; the neighbourhood
    then shrinks.
    """
    schedule, rng = given.schedule, np.random.default_rng(given.seed)
    best, entropy = given.start, given.entropy
    total = len(schedule.scales) * schedule.candidates
    for number, scale in enumerate(schedule.scales):
        center = best
        for count in _batches(schedule.candidates, given.batch):
            some = [_neighbour(center, given, scale, rng) for _ in range(count)]
            answers = yield Question(some, entropy, number, total)
            best, entropy = _better(best, entropy, some, answers)


def _neighbour(
    center: Candidate, given: Given, scale: float, rng: np.random.Generator
) -> Candidate | None:
    """Return a candidate that all rules allow; None when none is drawn."""
    schedule = given.schedule
    reach = {METRE: schedule.reach_m, RADIAN: schedule.reach_rad, SHARE: SHARE_REACH}

    def sample() -> list[float]:
        known = zip(given.coding.unknowns, center.vector, strict=True)
        return [v + scale * reach[u.unit] * rng.uniform(-1.0, 1.0) for u, v in known]

    return drawn(given.coding, sample)


def _better(
    best: Candidate, entropy: float, some: list[Candidate | None], answers: Answered
) -> tuple[Candidate, float]:
    """Return the first of the lowest, and its entropy."""
    for candidate, answer in zip(some, answers, strict=True):
        if candidate is not None and answer is not None and answer.entropy < entropy:
            best, entropy = candidate, answer.entropy
    return best, entropy


def _batches(count: int, most: int) -> Iterator[int]:
    """Yield a number in parts that are at most as large."""
    for done in range(0, count, most):
        yield min(most, count - done)

"""Algorithm 1 of the paper: random search in a shrinking neighbourhood."""

import numpy as np

from ..domains import METRE, RADIAN, SHARE
from ..objective import Leader
from ..parametrization import Candidate
from ..search_space import REACH_M, REACH_RAD
from .method import Given, Question, QuestionStream, sampled_candidate

SHARE_REACH = 0.5
"""Half width of the first neighbourhood in a list: all of it, because a list is cyclic."""


def ask(given: Given) -> QuestionStream:
    """Sample round by round, in the neighbourhood of the incumbent at the start of the round.
    Candidates are sampled uniformly in it, each coordinate clipped to its bounds; then the
    neighbourhood shrinks."""
    schedule = given.schedule
    rng = np.random.default_rng(given.seed)
    best = given.start
    value = given.value
    total = len(schedule.scales) * schedule.candidates
    for number, scale in enumerate(schedule.scales):
        center = best
        for asked in range(0, schedule.candidates, given.batch):
            count = min(given.batch, schedule.candidates - asked)
            candidates = [_neighbour(center, given, scale, rng) for _ in range(count)]
            leader = Leader(best.rig, value)
            answers = yield Question(candidates, value, number, total, leader=leader)
            for candidate, answer in zip(candidates, answers, strict=True):
                if candidate is not None and answer is not None and answer < value:
                    best = candidate
                    value = answer


def _neighbour(
    center: Candidate, given: Given, scale: float, rng: np.random.Generator
) -> Candidate | None:
    """Return a feasible candidate in the neighbourhood; None when none was sampled."""
    reach = {METRE: REACH_M, RADIAN: REACH_RAD, SHARE: SHARE_REACH}

    def sample() -> list[float]:
        values = zip(given.parametrization.variables, center.vector, strict=True)
        return [v + scale * reach[u.unit] * rng.uniform(-1.0, 1.0) for u, v in values]

    return sampled_candidate(given.parametrization, sample)

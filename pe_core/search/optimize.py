"""Algorithm 1 of the paper: random search in a shrinking neighbourhood, as a generator of steps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..scene.sensors import Rig
from ..scoring.evaluator import Evaluator
from .coding import Candidate, Coding
from .feasible import first_allowed
from .schedule import Schedule
from .search_space import SearchSpace
from .unknown import METRE, RADIAN, SHARE

SHARE_REACH = 0.5
"""Half width of the first neighbourhood in a list: all of it, which is taken as a ring."""
MOST_DRAWN = 100
"""Placements drawn for one candidate; where none of them is allowed, none is scored."""


@dataclass(frozen=True, slots=True)
class Step:
    """One candidate tried.

    Attributes
    ----------
    best : Rig
        The best placement so far.
    entropy : float
        Its perception entropy [nats].
    evaluations : int
        Rigs scored so far, the start included.
    fraction : float
        How much of the search is done, 0 to 1.
    round : int
        Round, from 0.
    improved : bool
        Whether this candidate became the best.
    """

    best: Rig
    entropy: float
    evaluations: int
    fraction: float
    round: int
    improved: bool


def optimize(
    evaluator: Evaluator,
    rig: Rig,
    search_space: SearchSpace,
    seed: int = 0,
    schedule: Schedule | None = None,
) -> Iterator[Step]:
    """Search for the placement of lowest perception entropy; yields a step a candidate.

    Round by round, candidates are drawn uniformly in the neighbourhood of the best placement found
    before the round, each coordinate clipped to its bounds; the neighbourhood then shrinks. What
    breaks a rule of the search space is drawn anew, and neither scored nor returned; a start that
    does gives way to a placement near it. Stop whenever you like: the last step holds the best so
    far.

    Parameters
    ----------
    evaluator : Evaluator
    rig : Rig
        Where the search starts.
    search_space : SearchSpace
    seed : int
        The same seed gives the same steps.
    schedule : Schedule, optional
        The paper's by default: seven rounds of 1000 candidates.

    Raises
    ------
    InputError
        When the search space does not fit the rig, or no placement keeps to all of its rules.
    """
    coding, schedule = Coding(rig, search_space), schedule or Schedule()
    rng, best = np.random.default_rng(seed), first_allowed(coding, seed)
    entropy, count = evaluator.entropy(best.rig), 1
    yield Step(best.rig, entropy, count, 0.0, 0, False)
    if not coding.unknowns:
        return
    total, done = len(schedule.scales) * schedule.candidates, 0
    for number, scale in enumerate(schedule.scales):
        center = best
        for _ in range(schedule.candidates):
            candidate = _neighbour(center, coding, schedule, scale, rng)
            improved, done = False, done + 1
            if candidate is not None:
                found = evaluator.judge(candidate.rig, below=entropy)
                improved = found.entropy < entropy
                count += 1
                if improved:
                    best, entropy = candidate, found.entropy
            yield Step(best.rig, entropy, count, done / total, number, improved)


def _neighbour(
    center: Candidate,
    coding: Coding,
    schedule: Schedule,
    scale: float,
    rng: np.random.Generator,
) -> Candidate | None:
    """Return a candidate that all rules allow; None when none is drawn."""
    reach = {METRE: schedule.reach_m, RADIAN: schedule.reach_rad, SHARE: SHARE_REACH}
    for _ in range(MOST_DRAWN):
        known = zip(coding.unknowns, center.vector, strict=True)
        vector = [u.brought(v + scale * reach[u.unit] * rng.uniform(-1.0, 1.0)) for u, v in known]
        candidate = coding.candidate(vector)
        if coding.allowed(candidate.rig):
            return candidate
    return None

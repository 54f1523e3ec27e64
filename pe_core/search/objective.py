"""What a search minimises.

Anything with these two methods is an objective: an `Evaluator`, or what wraps one (a mean over
mounting errors, a record of what was judged).
"""

from __future__ import annotations

import math
from typing import Protocol

from ..scene.sensors import Rig
from ..scoring import Judgement


class Objective(Protocol):
    """Tells what placements are worth; less is better, and the same placement has one value."""

    def entropy(self, rig: Rig) -> float:
        """Return what a rig is worth [nats]."""

    def judge(self, rig: Rig, below: float = math.inf) -> Judgement:
        """Return what a rig is worth; where that is not below `below`, perhaps a lower bound.

        `is_lower_bound` says so. A lower bound is itself not below `below`; it is no number to
        rank by.
        """


__all__ = ["Judgement", "Objective"]

"""The interfaces of scoring: evaluators of rigs, and objectives of a search."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import NamedTuple, Protocol

from ..scene.rig import Rig
from .score import Score, SummaryScore, Watch


class Evaluation(NamedTuple):
    """The value of a rig: its entropy, or a lower bound of it [nats]."""

    entropy: float
    is_lower_bound: bool


class Objective(Protocol):
    """What a search minimises: an `Evaluator`, or something that wraps one.

    The same rig always has the same value.
    """

    def entropy(self, rig: Rig) -> float:
        """Return the value of a rig; lower is better [nats]."""

    def evaluate(self, rig: Rig, cutoff: float = inf) -> Evaluation:
        """Return the value of a rig; where it is not below `cutoff`, perhaps a lower bound.

        `is_lower_bound` tells the two apart. A lower bound is itself not below `cutoff`, and must
        not be ranked.
        """


class RigEvaluator(Protocol):
    """Scores rigs in one space, under one prior, on one vehicle; methods are as `Evaluator`'s.

    `samples` is how many voxels or objects are evaluated; 0: all voxels.
    """

    samples: int

    def score(self, rig: Rig, *, preview: bool = False, watch: Watch | None = None) -> Score:
        """Score a rig in full."""

    def summary(self, rig: Rig, *, preview: bool = False) -> SummaryScore:
        """Score a rig as a whole, without the part by sensor."""

    def entropy(self, rig: Rig, *, preview: bool = False) -> float:
        """Return a rig's entropy [nats]."""

    def evaluate(self, rig: Rig, cutoff: float = inf) -> Evaluation:
        """Return a rig's entropy, or a lower bound that is not below `cutoff`."""

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the entropy of each of several rigs [nats]."""

    def evaluate_together(
        self, rigs: Sequence[Rig], cutoff: float, worst: bool = False
    ) -> Evaluation:
        """Evaluate the mean of several rigs' entropies, or the highest, with a cutoff."""

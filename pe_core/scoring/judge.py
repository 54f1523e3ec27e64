"""What jobs and searches ask of whatever scores rigs: voxels' `Evaluator`, or that of objects."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Protocol

from ..scene.sensors import Rig
from .sampled import Judgement
from .score import Glance, Score, Watch


class RigJudge(Protocol):
    """Scores rigs in one space, under one prior, on one vehicle; methods are as `Evaluator`'s.

    `samples` is what is looked at, 0: all voxels.
    """

    samples: int

    def score(self, rig: Rig, *, draft: bool = False, watch: Watch | None = None) -> Score:
        """Score a rig in full."""

    def glance(self, rig: Rig, *, draft: bool = False) -> Glance:
        """Score a rig as a whole."""

    def entropy(self, rig: Rig, *, draft: bool = False) -> float:
        """Return a rig's entropy [nats]."""

    def judge(self, rig: Rig, below: float = inf) -> Judgement:
        """Return a rig's entropy, or a lower bound that is not below `below`."""

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the entropy of each of several rigs [nats]."""

    def judge_together(self, rigs: Sequence[Rig], below: float, worst: bool = False) -> Judgement:
        """Judge several rigs by their mean, or by the worst."""

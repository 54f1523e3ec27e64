"""A sensor on a list of slots: each of them is tried."""

from __future__ import annotations

import numpy as np

from ..coding import Candidate
from .method import Given
from .phase import Asks, Phase, Tried

MOST_SLOTS = 16
"""Slots tried in one turn; of a longer list, as many are drawn."""


class SlotTurn:
    """All slots of one sensor, the others where they are: a turn as `Evolution` has."""

    def __init__(self, given: Given, at: int, seed: list[int]) -> None:
        self._coding, self._at = given.coding, at
        self._rng = np.random.default_rng(seed)
        first = self._in(given.start, 0.0).vector[at]  # the middle of the first slot's share
        self._count = round(0.5 / first)

    @property
    def spread(self) -> float:
        """0 where a turn tries all slots: another one then finds nothing else."""
        return 0.0 if self._count <= MOST_SLOTS else 1.0

    def asks(self, base: Candidate, phase: Phase) -> Asks[Tried]:
        """Ask for the slots that are free."""
        others = [self._in(base, share) for share in self._shares()]
        candidates = [c for c in others if c.vector != base.vector and self._coding.allowed(c.rig)]
        if not candidates:
            return []
        values = yield from phase.asks(candidates)
        return list(zip(candidates, values, strict=True))

    def _shares(self) -> list[float]:
        """Return the middles of the shares of the slots to try."""
        numbers = np.arange(self._count)
        if self._count > MOST_SLOTS:
            numbers = np.sort(self._rng.choice(self._count, MOST_SLOTS, replace=False))
        return [(number + 0.5) / self._count for number in numbers.tolist()]

    def _in(self, base: Candidate, share: float) -> Candidate:
        vector = list(base.vector)
        vector[self._at] = share
        return self._coding.candidate(vector)

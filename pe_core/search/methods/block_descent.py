"""Block descent, a part of the portfolio: CMA-ES on one sensor at a time.

While one sensor moves, the others stay at the incumbent. A sensor that does not move need not be
measured again, and a few design variables at a time take few candidates.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from ..domains import METRE, SHARE
from ..parametrization import Candidate
from .cma_es import STEP, Evolution
from .method import Evaluated, Given, Incumbent, MethodPart, Phase

MAX_SLOTS = 16
"""Slots evaluated in one turn; of a longer list, so many are sampled."""


class SlotTurn:
    """A turn of a sensor on a list of slots: all slots, the other sensors fixed.

    It has the interface of `Evolution`.
    """

    def __init__(self, given: Given, index: int, seed: list[int]) -> None:
        self._parametrization, self._index = given.parametrization, index
        self._rng = np.random.default_rng(seed)
        first = self._at_share(given.start, 0.0).vector[index]  # middle of the first slot's share
        self._count = round(0.5 / first)

    @property
    def spread(self) -> float:
        """Spread of the candidates: 0 if a turn evaluates all slots; repeating it is useless."""
        return 0.0 if self._count <= MAX_SLOTS else 1.0

    def evaluate(self, base: Candidate, phase: Phase) -> MethodPart[Evaluated]:
        """Evaluate the slots that are free."""
        moved = [self._at_share(base, share) for share in self._shares()]
        candidates = [
            c for c in moved if c.vector != base.vector and self._parametrization.allowed(c.rig)
        ]
        if not candidates:
            return []
        values = yield from phase.evaluate(candidates)
        return list(zip(candidates, values, strict=True))

    def _shares(self) -> list[float]:
        """Return the middles of the shares of the slots to evaluate."""
        numbers = np.arange(self._count)
        if self._count > MAX_SLOTS:
            numbers = np.sort(self._rng.choice(self._count, MAX_SLOTS, replace=False))
        return [(number + 0.5) / self._count for number in numbers.tolist()]

    def _at_share(self, base: Candidate, share: float) -> Candidate:
        """Return a candidate in which the sensor takes the slot at a share."""
        vector = list(base.vector)
        vector[self._index] = share
        return self._parametrization.candidate(vector)


def to_best_corners(given: Given, incumbent: Incumbent, phase: Phase) -> MethodPart[None]:
    """Try each sensor in all corners of its bounds."""
    for block in given.parametrization.blocks:
        corners = _corners(given, incumbent.best, block)
        allowed = [c for c in corners if given.parametrization.allowed(c.rig)]
        if allowed:
            values = yield from phase.evaluate(allowed, incumbent.entropy)
            incumbent.told(zip(allowed, values, strict=True))


def _corners(given: Given, base: Candidate, block: range) -> Iterator[Candidate]:
    """Yield the corners of one sensor's bounds, the other sensors as in the base."""
    variables = given.parametrization.variables
    ends = [
        (variables[k].low, variables[k].high) if variables[k].unit == METRE else (base.vector[k],)
        for k in block
    ]
    for values in product(*ends):
        vector = list(base.vector)
        vector[block.start : block.stop] = values
        yield given.parametrization.candidate(vector)


GENERATIONS = 3
"""Generations of one sensor, before it is the next one's turn."""


class Descent(Incumbent):
    """A block coordinate descent from one start, with its best placement and that one's entropy.

    The entropy is that on the level that was used last [nats]; `count` placements were evaluated.
    """

    def __init__(
        self,
        given: Given,
        start: Candidate,
        entropy: float,
        seed: Sequence[int],
        step: float = STEP,
    ) -> None:
        super().__init__(start, entropy)
        self._turns = [
            _turn(given, block, start, [*seed, k], step)
            for k, block in enumerate(given.parametrization.blocks)
        ]

    @property
    def spread(self) -> float:
        """Largest standard deviation of the samples: 1 is 1 m and 30 deg."""
        return max(turn.spread for turn in self._turns)

    def descend(self, phase: Phase, count: float, finest: float = 0.0) -> MethodPart[None]:
        """Descend for about `count` placements, until the spread is small or nothing improves."""
        first, last, goes_on = self.count, 0, True
        while goes_on and self.count < first + count - last / 2:
            before = self.count, self.entropy
            yield from self.cycle(phase)
            last = self.count - before[0]
            better = self.entropy < before[1] or self.spread > 0.0
            goes_on = last > 0 and better and self.spread >= finest

    def cycle(self, phase: Phase) -> MethodPart[None]:
        """Give each sensor its turn."""
        for turn in self._turns:
            base = self.best
            for _ in range(GENERATIONS if isinstance(turn, Evolution) else 1):
                self.told((yield from turn.evaluate(base, phase)))


def _turn(
    given: Given, block: range, start: Candidate, seed: list[int], step: float
) -> Evolution | SlotTurn:
    if given.parametrization.variables[block[0]].unit == SHARE:
        return SlotTurn(given, block[0], seed)
    return Evolution(given, block, start, seed, step)


RESTART_STEP, FINEST = 0.25, 0.02
"""A descent ends when its spread is below `FINEST`: 2 cm and 0.6 deg. The next one begins where it
ended, with steps of 25 cm and 7.5 deg."""

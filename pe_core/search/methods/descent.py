"""Block coordinate descent: one sensor at a time moves, the others stay where they are best.

What does not move is not measured again, and few unknowns at a time take few candidates.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..coding import Candidate
from ..unknown import SHARE
from .evolution import STEP, Evolution
from .method import Given
from .phase import Asks, Phase
from .slot_turn import SlotTurn

GENERATIONS = 3
"""Of one sensor, before it is the next one's turn."""


class Descent:
    """A descent from one start.

    Attributes
    ----------
    best : Candidate
    entropy : float
        Of the best, on the level that was asked last [nats].
    count : int
        Placements that were judged.
    """

    def __init__(
        self,
        given: Given,
        start: Candidate,
        entropy: float,
        seed: Sequence[int],
        step: float = STEP,
    ) -> None:
        self.best, self.entropy, self.count = start, entropy, 0
        self._turns = [
            _turn(given, block, start, [*seed, k], step)
            for k, block in enumerate(given.coding.blocks)
        ]

    @property
    def spread(self) -> float:
        """How wide it still looks: 1 is 1 m and 30 deg."""
        return max(turn.spread for turn in self._turns)

    def down(self, phase: Phase, count: float, finest: float = 0.0) -> Asks[None]:
        """Go on for about so many placements, until it is narrow or nothing can become better."""
        first, last, fell = self.count, 0, True
        while fell and self.count < first + count - last / 2:
            before = self.count, self.entropy
            yield from self.cycle(phase)
            last = self.count - before[0]
            better = self.entropy < before[1] or self.spread > 0.0
            fell = last > 0 and better and self.spread >= finest

    def cycle(self, phase: Phase) -> Asks[None]:
        """Give each sensor its turn."""
        for turn in self._turns:
            base = self.best
            for _ in range(GENERATIONS if isinstance(turn, Evolution) else 1):
                for candidate, value in (yield from turn.asks(base, phase)):
                    self.count += 1
                    if value < self.entropy:
                        self.best, self.entropy = candidate, value

    def again(self, phase: Phase) -> Asks[None]:
        """Have the best judged on another level."""
        [self.entropy] = yield from phase.asks([self.best])


def _turn(
    given: Given, block: range, start: Candidate, seed: list[int], step: float
) -> Evolution | SlotTurn:
    if given.coding.unknowns[block[0]].unit == SHARE:
        return SlotTurn(given, block[0], seed)
    return Evolution(given, block, start, seed, step)

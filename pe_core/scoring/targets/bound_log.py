"""Whether lower bounds pay: how often they have lately settled a candidate."""

from __future__ import annotations

MIN_RATE = 0.3
"""A bound takes about 0.3 of the time of a measurement."""
MEMORY = 0.9
"""Weight of the past at each further bound."""
AGAIN = 10
"""While bounds do not pay, one of so many candidates is bounded all the same."""


class BoundLog:
    """Counts how often bounds settle candidates: often far from the optimum, seldom near it.

    What a search finds does not depend on it, only its time.
    """

    def __init__(self) -> None:
        self._rate, self._left_out = 1.0, 0

    def pay(self) -> bool:
        """Whether the next candidate is worth a bound."""
        if self._rate >= MIN_RATE or self._left_out == AGAIN - 1:
            self._left_out = 0
            return True
        self._left_out += 1
        return False

    def note(self, settled: bool) -> None:
        """Note whether a bound settled its candidate."""
        self._rate = MEMORY * self._rate + (1.0 - MEMORY) * settled

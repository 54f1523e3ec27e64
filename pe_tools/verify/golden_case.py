"""A golden case: what the engine finds, beside what is right by hand or by a plain oracle."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

CaseValues = Sequence[float] | str
"""Numbers, or a text that has to be the same to the letter."""
BY_HAND = "by hand"
ORACLE = "oracle"
STORED = "stored"
BASES = {
    BY_HAND: "worked out on paper from the definition",
    ORACLE: "by brute force in pe_tools/verify, which shares no code with the engine",
    STORED: "as an earlier run gave it: says that bits have not changed, not that they are right",
}
"""Where right values are from."""


class GoldenCase(NamedTuple):
    """A row of the table `GOLDEN`.

    `area`: What of the engine it is about. `basis`: A key of `BASES`.
    `about`: Why the right values are right.
    `right`: The right values, or a function that computes them.
    `found`: Has the engine compute them.
    `tolerance`: Largest difference of a number.
    """

    name: str
    area: str
    basis: str
    about: str
    right: CaseValues | Callable[[], CaseValues]
    found: Callable[[], CaseValues]
    tolerance: float = 1e-9

    @property
    def right_values(self) -> CaseValues:
        """The right values."""
        return self.right() if callable(self.right) else self.right

    def is_right(self, found: CaseValues, right: CaseValues) -> bool:
        """Whether values are the right ones, within the tolerance; NaN never is."""
        if isinstance(found, str) or isinstance(right, str):
            return found == right
        if len(found) != len(right):
            return False
        pairs = zip(found, right, strict=True)
        return all(a == b or math.fabs(a - b) <= self.tolerance for a, b in pairs)

"""Other places to start from than the given one: nobody has to know in which corner it is best."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from ..coding import Candidate
from ..unknown import METRE, RADIAN
from .drawing import drawn
from .method import Given
from .phase import Asks, Phase


def as_given(given: Given, _phase: Phase) -> Asks[tuple[Candidate, float]]:
    """Return the start of the search, which is judged already."""
    yield from ()
    return given.start, given.entropy


def by_corners(given: Given, phase: Phase) -> Asks[tuple[Candidate, float]]:
    """Put one sensor after the other into the best corner of where it may be.

    Its angles stay. Returns the placement and its entropy.
    """
    best, entropy = given.start, given.entropy
    for block in given.coding.blocks:
        corners = [c for c in _corners(given, best, block) if given.coding.allowed(c.rig)]
        if corners:
            values = yield from phase.asks(corners, entropy)
            lowest = int(np.argmin(values))
            if values[lowest] < entropy:
                best, entropy = corners[lowest], values[lowest]
    return best, entropy


def anywhere(given: Given, phase: Phase) -> Asks[tuple[Candidate, float]]:
    """Return a placement anywhere, its angles those of the start, and its entropy."""
    rng = np.random.default_rng([given.seed, len(given.coding.unknowns)])

    def sample() -> list[float]:
        known = zip(given.coding.unknowns, given.start.vector, strict=True)
        return [v if u.unit == RADIAN else rng.uniform(u.low, u.high) for u, v in known]

    candidate = drawn(given.coding, sample) or given.start
    [entropy] = yield from phase.asks([candidate])
    return candidate, entropy


def _corners(given: Given, base: Candidate, block: range) -> Iterator[Candidate]:
    """Yield the corners of one sensor's box, the others as in a base."""
    unknowns = given.coding.unknowns
    ends = [
        (unknowns[k].low, unknowns[k].high) if unknowns[k].unit == METRE else (base.vector[k],)
        for k in block
    ]
    for values in product(*ends):
        vector = list(base.vector)
        vector[block.start : block.stop] = values
        yield given.coding.candidate(vector)


STARTS = (as_given, by_corners, as_given, anywhere)
"""The given one twice: descents with other numbers drawn may end elsewhere."""

"""The default: one sensor at a time by CMA-ES, from several starts, on ever more voxels.

Most of the budget goes where it counts: a few rounds on few voxels tell which start leads on, and
the last ones are judged on as many as the study says. A search on a sample flatters itself, the
more the fewer voxels it looks at.
"""

from __future__ import annotations

from .descent import Descent
from .method import Asking, Given
from .phase import Asks, Phase
from .starts import STARTS

COARSER = 4
"""The first level looks at a fourth of the voxels,"""
LEAST = 2048
"""but at this many at least."""
BELOW_GRID = 65_536
"""Where the last level is the grid, the first is as if that were so many voxels."""
RACES = (0.05, 0.05)
"""Shares of the budget for each start; after each race, the better half of them goes on."""
START_EACH = 80
"""Placements for each sensor that a start takes: where there are fewer, there are fewer starts."""
COARSE = 0.4
"""Share of the budget after which the first level is over."""
EACH, EACH_OTHER = 110, 100
"""Placements for each sensor that moves, and as many more for each that there is, where no budget
is given: the more sensors, the more often each has to give way to the others."""
WIDE, NARROW = 0.25, 0.02
"""A descent that is narrower than this is over: 2 cm and 0.6 deg. Another one begins where it
ended, with steps of 25 cm and 7.5 deg."""


def samples(last: int) -> tuple[int, ...]:
    """Return how many voxels each level looks at."""
    most = last or BELOW_GRID
    return max(most // COARSER, min(LEAST, most)), last


def ask(given: Given) -> Asking:
    """Ask of several starts, then of the best of them, level by level."""
    count = len(given.coding.blocks)
    total = given.evaluations or (EACH + EACH_OTHER * count) * count
    best, done = yield from _raced(given, total)
    if given.levels > 1:
        yield from best.down(Phase(1, total), COARSE * total - done)
        yield from best.again(Phase(2, total, 1))
        done = max(done, COARSE * total)
    yield from _repeated(given, best, total, total - done)


def _repeated(given: Given, best: Descent, total: int, left: float) -> Asks[None]:
    """Descend on the last level, again and again, until the budget is spent."""
    number = len(STARTS)
    while left > 0.0:
        best = Descent(given, best.best, best.entropy, [given.seed, number], WIDE)
        yield from best.down(Phase(2, total, given.levels - 1), left, NARROW)
        if best.count == 0 or best.spread == 0.0:
            return  # nothing can move, or all there is was tried
        left, number = left - best.count, number + 1


def _raced(given: Given, total: int) -> Asks[tuple[Descent, float]]:
    """Begin from several starts; return the one that came lowest, and what all of them took."""
    race, count = Phase(0, total), total // (START_EACH * len(given.coding.blocks))
    starts = []
    for number in range(min(len(STARTS), count) or 1):
        start, entropy = yield from STARTS[number](given, race)
        starts.append(Descent(given, start, entropy, [given.seed, number]))
    left = starts
    for share in RACES:
        for descent in left:
            yield from descent.down(race, share * total)
        left = sorted(left, key=lambda descent: descent.entropy)[: max(1, len(left) // 2)]
    return left[0], float(sum(descent.count for descent in starts))

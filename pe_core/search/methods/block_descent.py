"""Block descent: CMA-ES on one sensor at a time, from several starts, multi-level.

While one sensor moves, the others stay at the incumbent. A sensor that does not move need not be
measured again, and a few design variables at a time take few candidates. A few rounds on few voxels
choose the start to continue from, and the last rounds are evaluated on as many voxels as the study
sets: a search on a sample overestimates its own result, more so with fewer voxels.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from ..domains import METRE, RADIAN, SHARE
from ..parametrization import Candidate
from .cma_es import STEP, Evolution
from .method import (
    Evaluated,
    Given,
    Incumbent,
    MethodPart,
    Phase,
    QuestionStream,
    sampled_candidate,
)

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


def given_start(given: Given, _phase: Phase) -> MethodPart[tuple[Candidate, float]]:
    """Return the start of the search, which is evaluated already."""
    yield from ()
    return given.start, given.entropy


def corner_start(given: Given, phase: Phase) -> MethodPart[tuple[Candidate, float]]:
    """Move each sensor to the best corner of its bounds; return the placement and its entropy."""
    best, entropy = given.start, given.entropy
    for block in given.parametrization.blocks:
        corners = [c for c in _corners(given, best, block) if given.parametrization.allowed(c.rig)]
        if corners:
            values = yield from phase.evaluate(corners, entropy)
            lowest = int(np.argmin(values))
            if values[lowest] < entropy:
                best, entropy = corners[lowest], values[lowest]
    return best, entropy


def random_start(given: Given, phase: Phase) -> MethodPart[tuple[Candidate, float]]:
    """Return a random placement with the angles of the start, and its entropy."""
    rng = np.random.default_rng([given.seed, len(given.parametrization.variables)])

    def sample() -> list[float]:
        values = zip(given.parametrization.variables, given.start.vector, strict=True)
        return [v if u.unit == RADIAN else rng.uniform(u.low, u.high) for u, v in values]

    candidate = sampled_candidate(given.parametrization, sample) or given.start
    [entropy] = yield from phase.evaluate([candidate])
    return candidate, entropy


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


STARTS = (given_start, corner_start, given_start, random_start)
"""The given start twice: descents with other random numbers may end elsewhere."""
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

    def reevaluate(self, phase: Phase) -> MethodPart[None]:
        """Evaluate the incumbent on another level."""
        [self.entropy] = yield from phase.evaluate([self.best])


def _turn(
    given: Given, block: range, start: Candidate, seed: list[int], step: float
) -> Evolution | SlotTurn:
    if given.parametrization.variables[block[0]].unit == SHARE:
        return SlotTurn(given, block[0], seed)
    return Evolution(given, block, start, seed, step)


COARSENING, MIN_SAMPLES = 4, 2048
"""The first level evaluates a fourth of the voxels, but at least so many."""
BELOW_GRID = 65_536
"""Where the last level is the grid, the first level is as if the last had so many voxels."""
RACES, RACE_SHARE = 2, 0.05
"""Races, and the share of the budget for each start in each race."""
PLACEMENTS_PER_START = 80
"""Placements for each sensor that a start takes: a smaller budget means fewer starts."""
FIRST_LEVEL = 0.4
"""Share of the budget after which the first level ends."""
PER_SENSOR, PER_PAIR = 110, 100
"""Placements without a given budget: so many for each sensor that moves, and so many more for each
ordered pair of them: the more sensors, the more often each has to give way to the others."""
RESTART_STEP, FINEST = 0.25, 0.02
"""A descent ends when its spread is below `FINEST`: 2 cm and 0.6 deg. The next one begins where it
ended, with steps of 25 cm and 7.5 deg."""


def samples(last: int) -> tuple[int, ...]:
    """Return how many voxels each level evaluates."""
    count = last or BELOW_GRID
    return max(count // COARSENING, min(MIN_SAMPLES, count)), last


def ask(given: Given) -> QuestionStream:
    """Search from several starts, then from the best of them, level by level."""
    count = len(given.parametrization.blocks)
    total = given.evaluations or (PER_SENSOR + PER_PAIR * count) * count
    best, done = yield from _raced(given, total)
    if given.levels > 1:
        yield from best.descend(Phase(1, total), FIRST_LEVEL * total - done)
        yield from best.reevaluate(Phase(2, total, 1))
        done = max(done, FIRST_LEVEL * total)
    yield from _repeated(given, best, total, total - done)


def _repeated(given: Given, best: Descent, total: int, left: float) -> MethodPart[None]:
    """Descend on the last level, with restarts, until the budget is spent."""
    number = len(STARTS)
    while left > 0.0:
        best = Descent(given, best.best, best.entropy, [given.seed, number], RESTART_STEP)
        yield from best.descend(Phase(2, total, given.levels - 1), left, FINEST)
        if best.count == 0 or best.spread == 0.0:
            return  # nothing can move, or all placements were evaluated
        left, number = left - best.count, number + 1


def _raced(given: Given, total: int) -> MethodPart[tuple[Descent, float]]:
    """Race several starts; return the best descent, and how many placements all of them took."""
    phase, starts = Phase(0, total), []
    count = total // (PLACEMENTS_PER_START * len(given.parametrization.blocks))
    for number in range(min(len(STARTS), count) or 1):
        start = yield from STARTS[number](given, phase)
        starts.append(Descent(given, *start, [given.seed, number]))
    return (yield from race(starts, phase, RACE_SHARE * total)), float(sum(d.count for d in starts))


def race(racing: list[Descent], phase: Phase, count: float) -> MethodPart[Descent]:
    """Race descents, each for about `count` placements; after each race the better half goes on."""
    for _ in range(RACES):
        for descent in racing:
            yield from descent.descend(phase, count)
        racing = sorted(racing, key=lambda descent: descent.entropy)[: max(1, len(racing) // 2)]
    return racing[0]
